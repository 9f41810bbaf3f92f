"""Many environments in one batch, as `gymnasium.make_vec` gives them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from fo_gym.checks import choice, instance, shown
from fo_gym.envs.actions import checked_action
from fo_gym.envs.drawn import Drawn
from fo_gym.generators import check_random_states, restored, seed_number, states_of
from fo_gym.parameters import JointInfo
from fo_gym.robots import Robot, RobotLike
from fo_gym.simulation.settings import Settings
from fo_gym.simulation.simulation import Simulation
from fo_gym.simulation.state import SimulationState, parts_of
from fo_gym.tasks.task import Task

Array = NDArray[np.float64]

__all__ = ["JointVectorEnv"]


class JointVectorEnv(Drawn, VectorEnv[Array, Array, NDArray[Any]]):
    """`num_envs` environments advanced together; each one behaves, to the bit, as `JointEnv` does alone.

    Subclasses name robot and task. With the autoreset mode NEXT_STEP (the default) the step after an episode's end
    ignores the action, resets that environment and returns its first observation with reward 0. With DISABLED whoever
    steps also resets: `reset(options={"reset_mask": mask})` starts new episodes in the masked environments alone.

    `num_threads` share the work, fewer that of a small batch; what comes out is the same, to the bit, for any
    number. None stands for the environment variable FO_GYM_NUM_THREADS, and where that is not set for one.

    Raises:
        ValueError: an argument is not allowed; the message names the value and the remedy.
    """

    robot: ClassVar[RobotLike | None] = None
    task: ClassVar[staticmethod[[Robot], Task] | None] = None
    metadata: dict[str, Any] = {  # noqa: RUF012
        "render_modes": ["rgb_array"],
        "render_fps": 1000,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        *,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode = AutoresetMode.NEXT_STEP,
        num_threads: int | None = None,
        **settings: Any,
    ) -> None:
        chosen = Settings.of(settings)
        choice("render_mode", render_mode, ("rgb_array",), none=True)
        if autoreset_mode is not AutoresetMode.NEXT_STEP and autoreset_mode is not AutoresetMode.DISABLED:
            raise ValueError(
                f"autoreset_mode is {shown(autoreset_mode)}; allowed are AutoresetMode.NEXT_STEP and DISABLED"
            )
        self._autoreset = autoreset_mode is AutoresetMode.NEXT_STEP
        self.simulation = Simulation(self.robot, self.task, num_envs, chosen, num_threads)
        self.num_envs = num_envs = self.simulation.num_envs
        self.render_mode = render_mode
        fps = max(1, round(1.0 / chosen.step_dt))
        self.metadata = {**self.metadata, "render_fps": fps, "autoreset_mode": autoreset_mode}
        size = self.simulation.memory.size
        limit = self.simulation.torque_limit
        self.single_observation_space = Box(-np.inf, np.inf, (size,), np.float64)
        self.single_action_space = Box(-limit, limit, dtype=np.float64)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._generators: list[np.random.Generator] = []
        self._ended = np.zeros(num_envs, dtype=bool)
        # Every environment has every entry of info: one mask serves all, and nobody may write into it.
        self._everyone = np.ones(num_envs, dtype=bool)
        self._everyone.flags.writeable = False

    @property
    def joint_info(self) -> JointInfo:
        """What a compensator may know of the current episodes' joints; arrays are (num_envs, dof)."""
        return self.simulation.joint_info

    def _checked_seeds(self, seed: Any) -> list[int | None]:
        """One for each environment; None continues its generator."""
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, str | bytes) or not (isinstance(seed, Sequence) or np.ndim(seed) == 1):
            first = seed_number("seed", seed)
            return [first + i for i in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise ValueError(f"seed has {len(seed)} values; give one number, or one for each of {self.num_envs}")
        return [None if each is None else seed_number(f"seed[{i}]", each) for i, each in enumerate(seed)]

    def _seed(self, seed: list[int | None]) -> None:
        old: Sequence[np.random.Generator | None] = self._generators or [None] * self.num_envs
        self._generators = [
            seeding.np_random(new)[0] if new is not None or generator is None else generator
            for new, generator in zip(seed, old, strict=True)
        ]

    def _check_open(self) -> None:
        if self.closed:
            raise gym.error.ClosedEnvironmentError("the environment was closed; make a new one")

    def _checked_mask(self, mask: Any) -> NDArray[np.bool_]:
        if not (isinstance(mask, np.ndarray) and mask.shape == (self.num_envs,) and mask.dtype == np.bool_):
            raise ValueError(f"reset_mask is {shown(mask)}; it must be a NumPy array of {self.num_envs} bools")
        if not mask.any():
            raise ValueError(f"reset_mask is {shown(mask)}; give True for at least one environment")
        if not self._generators and not mask.all():
            raise gym.error.ResetNeeded("the first reset() must be of all environments, without a reset_mask")
        return mask

    def _info(self) -> dict[str, Any]:
        info: dict[str, Any] = {}
        for name, value in self.simulation.truth().items():
            info[name] = value
            info[f"_{name}"] = self._everyone
        return info

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Start an episode in every environment.

        Args:
            seed: s gives environment i the seed s + i; a sequence gives each its own; None continues the generators.
                Of environments that are not reset the generators stay as they are.
            options: as in `JointEnv.reset`, for all environments that are reset; "reset_mask", (num_envs,) of bool,
                says which these are.

        Returns:
            Observations (num_envs, size) and info, the privileged truth, (num_envs, dof) each.

        Raises:
            ValueError: a seed is not allowed, `options` are not those of `JointEnv.reset`, or the mask has another
                shape or dtype; nothing has changed then.
        """
        self._check_open()
        instance("options", options, Mapping, none="no changes")
        rest = {key: value for key, value in (options or {}).items() if key != "reset_mask"}
        chosen = self.simulation.limits.read(rest)
        mask = self._checked_mask((options or {}).get("reset_mask", self._everyone))
        seeds = self._checked_seeds(seed)
        self._seed([new if again else None for new, again in zip(seeds, mask, strict=True)])
        again = np.flatnonzero(mask)
        self.simulation.reset(again, [self._generators[i] for i in again], chosen)
        self._ended[again] = False
        if self._renderer is not None:
            self._renderer.clear_trace()
        return self.simulation.observation(), self._info()

    def step(self, actions: Array) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Apply tau_f_hat (or tau_m), (num_envs, dof), clipped to +-torque_limit, for one step.

        Raises:
            ValueError: the actions have the wrong shape, or are not of finite real numbers.
        """
        self._check_open()
        if not self._generators:
            raise gym.error.ResetNeeded("step() was called before the first reset()")
        if self._ended.any() and not self._autoreset:
            ended = np.flatnonzero(self._ended)
            raise gym.error.ResetNeeded(
                f"environments {ended} have ended; reset them with options={{'reset_mask': ...}}"
            )
        batch = checked_action(actions, (self.num_envs, self.simulation.dof), self._ended)
        reward, terminated, truncated, reasons = self.simulation.step(batch)
        if self._ended.any():
            again = np.flatnonzero(self._ended)
            self.simulation.reset(again, [self._generators[i] for i in again])
            reward[again], terminated[again], truncated[again] = 0.0, False, False
            reasons = {i: reason for i, reason in reasons.items() if not self._ended[i]}
        self._ended = terminated | truncated
        info = self._info()
        if reasons:
            info["termination"] = np.full(self.num_envs, None, dtype=object)
            info["termination"][list(reasons)] = list(reasons.values())
            info["_termination"] = terminated.copy()
        if self.render_mode is not None:
            self._renderer_now().watch(self.simulation)
        return self.simulation.observation(), reward, terminated, truncated, info

    def render(self) -> tuple[Any, ...] | None:
        """One image (height, width, 3) of uint8 per environment. Raises ClosedEnvironmentError after `close`."""
        self._check_open()
        if self.render_mode is None:
            gym.logger.warn("render() draws nothing: make the environment with render_mode='rgb_array'")
            return None
        renderer = self._renderer_now()
        return tuple(renderer.frame(self.simulation, i) for i in range(self.num_envs))

    def close_extras(self, **kwargs: Any) -> None:
        """Release the renderer."""
        self._close_renderer()

    def get_state(self) -> tuple[SimulationState, list[dict[str, Any]], NDArray[np.bool_]]:
        """A copy of the full state: simulation, random generators, and who resets at the next step."""
        if not self._generators:
            raise gym.error.ResetNeeded("get_state() was called before the first reset()")
        return self.simulation.get_state(), states_of(self._generators), self._ended.copy()

    def set_state(self, state: tuple[SimulationState, list[dict[str, Any]], NDArray[np.bool_]]) -> None:
        """Continue from what `get_state` returned, exactly.

        Raises:
            ValueError: it is no state, or one of another environment; nothing has changed then.
        """
        simulation, generators, ended = parts_of(state, 3)
        check_random_states("state of the random generators", generators, self.num_envs)
        if not (isinstance(ended, np.ndarray) and ended.shape == (self.num_envs,) and ended.dtype == np.bool_):
            raise ValueError(f"state of who has ended is {shown(ended)}; it must be {self.num_envs} bools")
        self.simulation.set_state(simulation)
        self._generators = restored(generators)
        self._ended = ended.copy()

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._everyone.flags.writeable = False  # copies of an array are writeable
