"""One environment, as `gymnasium.make` gives it: a batch of one."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any, ClassVar

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from fo_gym.checks import choice
from fo_gym.envs.actions import checked_action
from fo_gym.envs.drawn import Drawn
from fo_gym.generators import check_random_state, seed_number
from fo_gym.parameters import JointInfo
from fo_gym.robots import Robot, RobotLike
from fo_gym.simulation.settings import Settings
from fo_gym.simulation.simulation import Simulation
from fo_gym.simulation.state import SimulationState, parts_of
from fo_gym.tasks.task import Task

Array = NDArray[np.float64]

__all__ = ["JointEnv"]

_ONE = np.zeros(1, dtype=np.intp)


class JointEnv(Drawn, gym.Env[Array, Array]):
    """Flexible joints with friction under a task's controller; the agent supplies the friction estimate.

    Subclasses name robot and task. Keyword arguments are those of `Settings`, and `render_mode`.

    `info` is privileged truth, (dof,) each: theta, theta_dot, q, q_dot, z at the new tick; over the past step tau_m,
    tau_ext and tau_f_hat as they were applied (clipped; zeros for tau_f_hat in the "torque" mode), and the means of the
    friction tau_f and of tau_dist, which is tau_f and what else disturbs the motors: gear ripple, torques of effects.

    Raises:
        ValueError: an argument is not allowed; the message names the value and the remedy.
    """

    robot: ClassVar[RobotLike | None] = None
    task: ClassVar[staticmethod[[Robot], Task] | None] = None
    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": 1000}  # noqa: RUF012

    def __init__(self, *, render_mode: str | None = None, **settings: Any) -> None:
        chosen = Settings.of(settings)
        choice("render_mode", render_mode, self.metadata["render_modes"], none=True)
        self.simulation = Simulation(self.robot, self.task, 1, chosen)
        self.render_mode = render_mode
        self.metadata = {**self.metadata, "render_fps": max(1, round(1.0 / chosen.step_dt))}
        self._started = False
        size = self.simulation.memory.size
        limit = self.simulation.torque_limit
        self.observation_space = Box(-np.inf, np.inf, (size,), np.float64)
        self.action_space = Box(-limit, limit, dtype=np.float64)

    @property
    def joint_info(self) -> JointInfo:
        """What a compensator may know of the current episode's joints; arrays are (dof,)."""
        info = self.simulation.joint_info
        first = {name: getattr(info, name)[0] for name in ("motor_inertia", "stiffness", "torque_limit")}
        return replace(info, **first)

    def _info(self) -> dict[str, Any]:
        return self.simulation.truth(0)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Start an episode: the joints in static equilibrium, the nominal motor on the motor, bristles at rest.

        Args:
            seed: seeds the environment's generator; None continues it.
            options: {"target": (dof,), "push": {"time": s, "duration": s, "torque": (dof,)}}, each key optional. The
                target is within the joints' ranges, and the push ends before the episode does.

        Returns:
            Observation (see `fo_gym.Signals`) and info, the privileged truth.

        Raises:
            ValueError: the seed or an option is not allowed; nothing has changed then.
        """
        chosen = self.simulation.limits.read(options)
        super().reset(seed=None if seed is None else seed_number("seed", seed))
        self.simulation.reset(_ONE, [self.np_random], chosen)
        self._started = True
        if self._renderer is not None:
            self._renderer.clear_trace()
        if self.render_mode == "human":
            self.render()
        return self.simulation.observation()[0], self._info()

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Apply tau_f_hat (or tau_m, in the "torque" mode), (dof,), clipped to +-torque_limit, for one step.

        Raises:
            ValueError: the action has the wrong shape, or is not of finite real numbers.
        """
        if not self._started:
            raise gym.error.ResetNeeded("step() was called before the first reset(); call reset() first")
        batch = checked_action(action, (self.simulation.dof,))[None]
        reward, terminated, truncated, reasons = self.simulation.step(batch)
        info = self._info()
        if reasons:
            info["termination"] = reasons[0]
        if self.render_mode is not None:
            self._renderer_now().watch(self.simulation, draw=self.render_mode == "human")
        return self.simulation.observation()[0], float(reward[0]), bool(terminated[0]), bool(truncated[0]), info

    def render(self) -> Any:
        """An image (height, width, 3) of uint8 in the "rgb_array" mode; None, and a window, in the "human" mode."""
        if self.render_mode is None:
            gym.logger.warn(
                "render() needs a render_mode; make the environment with render_mode='rgb_array' or 'human'"
            )
            return None
        return self._renderer_now().frame(self.simulation)

    def close(self) -> None:
        """Close the window, if there is one."""
        self._close_renderer()

    def get_state(self) -> tuple[SimulationState, Mapping[str, Any]]:
        """A copy of the full state: simulation (bristles included) and random generator."""
        if not self._started:
            raise gym.error.ResetNeeded("get_state() was called before the first reset(); call reset() first")
        return self.simulation.get_state(), self.np_random.bit_generator.state

    def set_state(self, state: tuple[SimulationState, Mapping[str, Any]]) -> None:
        """Continue from what `get_state` returned, exactly.

        Raises:
            ValueError: it is no state, or one of another environment; nothing has changed then.
        """
        simulation, generator = parts_of(state, 2)
        check_random_state("state of the random generator", generator, deepcopy(self.np_random))
        self.simulation.set_state(simulation)
        self.np_random.bit_generator.state = generator
        self._started = True
