"""Run one compensator on a batch of episodes and keep what happens."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, cast

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from fo_gym.compensators import Compensator, Ideal, is_privileged
from fo_gym.envs.registry import environment_of
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.evaluation.episode.calls import checked_diagnostics, checked_estimate, checked_reset
from fo_gym.evaluation.episode.recording import Recording
from fo_gym.evaluation.episode.stored import stored_energy
from fo_gym.signals import Signals
from fo_gym.simulation.past_step import PastStep

Array = NDArray[np.float64]

_TICK_SIGNALS = ("theta_n", "theta_n_dot", "theta_d", "reference")
_TICK_TRUTH = ("theta", "theta_dot", "q", "q_dot")
_JOINT_TICKS = ("theta", "theta_dot", "q", "q_dot", "theta_n", "theta_n_dot", "theta_d")
_PERIOD_TRUTH = tuple(each.name for each in fields(PastStep))

__all__ = ["record"]


def record(
    compensator: Compensator,
    name: str,
    env_id: str,
    variant: str,
    seeds: Sequence[int],
    env_kwargs: Mapping[str, Any],
    at_start: Callable[[JointVectorEnv], None] | None = None,
    at_step: Callable[[JointVectorEnv, int], None] | None = None,
) -> Recording:
    """Run `compensator` on one batch, an episode per seed, each to its end.

    Args:
        compensator: who is scored; of `Ideal` nothing disturbs the motors.
        name: what to call it in errors.
        env_id: registered environment.
        variant: variant of it.
        seeds: one per episode.
        env_kwargs: further arguments of the environment.
        at_start: called with the environment when its episodes are drawn and nothing has moved yet; it may change them.
        at_step: called with the environment after each step, and how many there were; it may look.

    Raises:
        CompensatorError: it raised, or returned what is not a finite (num_envs, dof) array.
    """
    kwargs = {**env_kwargs, "feedback": compensator.feedback}
    if type(compensator) is Ideal:
        kwargs["disturbed"] = False
    env_id = environment_of(env_id).id
    # An evaluation's jobs share the processor, not the threads of its batches.
    made = gym.make_vec(env_id, num_envs=len(seeds), variant=variant, num_threads=1, **kwargs)
    env = cast("JointVectorEnv", made.unwrapped)
    env.reset(seed=list(seeds))
    if at_start is not None:
        at_start(env)
    checked_reset(compensator, name, env)
    return _Recorder(env, at_step).run(compensator, name)


class _Recorder:
    """The arrays of a recording while it is made."""

    def __init__(self, env: JointVectorEnv, at_step: Callable[[JointVectorEnv, int], None] | None) -> None:
        self.env = env
        self.at_step = at_step
        self.simulation = env.simulation
        self.dof = self.simulation.dof
        self.steps = self.simulation.last_tick // self.simulation.settings.decimation
        self.signals = Signals.from_observation(self.simulation.observation(), self.dof, env.available)
        sizes = {name: getattr(self.signals, name).shape[-1] for name in _TICK_SIGNALS}
        sizes |= dict.fromkeys(_TICK_TRUTH, self.dof)
        self.ticks = {name: np.empty((self.steps + 1, env.num_envs, size)) for name, size in sizes.items()}
        shape = (self.steps, env.num_envs, self.dof)
        self.periods = {name: np.empty(shape) for name in _PERIOD_TRUTH}
        self.diagnostics: dict[str, Array] = {}
        self.guided: dict[str, Array] = {}
        if self.simulation.hands is not None:
            self.guided = {name: np.empty((self.steps + 1, env.num_envs, self.dof)) for name in ("held", "free")}
            self.periods["f_hand"] = np.empty((self.steps, env.num_envs, 3))
        self.scenarios = tuple(self.simulation.scenarios)
        self.alive = np.ones(env.num_envs, dtype=bool)
        self.ended = np.full(env.num_envs, self.steps)
        self.terminations = [""] * env.num_envs
        self.seconds = np.empty(self.steps)
        self._keep_tick(0, self.simulation.truth())

    def _keep_tick(self, tick: int, info: Mapping[str, Any]) -> None:
        for name in _TICK_TRUTH:
            self.ticks[name][tick] = info[name]
        for name in _TICK_SIGNALS:
            self.ticks[name][tick] = getattr(self.signals, name)
        if self.simulation.hands is not None:
            theta, theta_dot, torque = info["theta"], info["theta_dot"], self.simulation.control.torque
            self.guided["held"][tick], self.guided["free"][tick] = torque(theta, 0.0 * theta), torque(theta, theta_dot)

    def _keep_diagnostics(self, step: int, told: Mapping[str, Array]) -> None:
        for part, values in told.items():
            if part not in self.diagnostics:
                self.diagnostics[part] = np.full_like(self.periods["tau_f_hat"], np.nan)
            self.diagnostics[part][step] = values

    def run(self, compensator: Compensator, name: str) -> Recording:
        """All episodes, tick by tick."""
        privileged = is_privileged(compensator)
        for step in range(self.steps):
            signals = replace(self.signals, truth=self.simulation.truth()) if privileged else self.signals
            start = time.perf_counter()
            estimate = checked_estimate(compensator, name, signals, self.alive, step)
            self.seconds[step] = time.perf_counter() - start
            self._keep_diagnostics(step, checked_diagnostics(compensator, name, estimate.shape, step))
            obs, _, terminated, _, info = self.env.step(estimate)
            self.signals = Signals.from_observation(obs, self.dof, self.env.available)
            for part, kept in self.periods.items():
                kept[step] = info[part]
            self._keep_tick(step + 1, info)
            if self.at_step is not None:
                self.at_step(self.env, step + 1)
            if terminated.any():
                self._end(step + 1, terminated, info)
                if not self.alive.any():
                    self.seconds = self.seconds[: step + 1]
                    break
        self._hold_ends()
        return self._recording()

    def _end(self, tick: int, terminated: NDArray[np.bool_], info: Mapping[str, Any]) -> None:
        for i in np.flatnonzero(terminated & self.alive):
            self.ended[i] = tick
            self.terminations[i] = str(info["termination"][i])
        self.alive &= ~terminated

    def _hold_ends(self) -> None:
        """After an early end every array holds its last value: the joint stays where it was lost."""
        for i in np.flatnonzero(~self.alive):
            end = self.ended[i]
            for array in (*self.ticks.values(), *self.guided.values()):
                array[end:, i] = array[end, i]
            for array in (*self.periods.values(), *self.diagnostics.values()):
                array[end:, i] = array[end - 1, i]

    def _recording(self) -> Recording:
        simulation = self.simulation
        stored = stored_energy(simulation, self.ticks)
        if simulation.task.reference.of_tool:
            links = simulation.plant.body.links
            tool = [links.tool_position(self.ticks["q"][:, i]) for i in range(self.env.num_envs)]
            self.ticks["tool"] = np.stack(tool, axis=1)
        if simulation.hands is not None:
            self._add_works()
        levers = simulation.robot.levers
        if np.any(levers != 1.0):
            self._tell_in_one_unit(levers)
        return Recording(
            robot=simulation.robot,
            task=simulation.task,
            dt=simulation.settings.step_dt,
            ticks=self.ticks,
            periods=self.periods,
            diagnostics=self.diagnostics,
            scenarios=self.scenarios,
            stored=stored,
            torque_limit=np.asarray(simulation.torque_limit) * levers,
            terminations=self.terminations,
            ended=self.ended,
            seconds=self.seconds,
        )

    def _add_works(self) -> None:
        """What friction and damping take, see Motion.lost and Episode.damped: (periods, num_envs) [J]."""
        step, held, free = np.diff(self.ticks["theta"], axis=0), self.guided["held"], self.guided["free"]
        acting = self.periods["tau_m"] + self.periods["tau_dist"]
        self.periods["lost"] = np.sum((free[:-1] - acting) * step, axis=-1)
        self.periods["damped"] = np.sum((0.5 * (held[:-1] + held[1:]) - free[:-1]) * step, axis=-1)

    def _tell_in_one_unit(self, levers: Array) -> None:
        """Joints of a robot with hinges and slides in the same unit, see `Robot.levers`."""
        self.ticks |= {name: self.ticks[name] / levers for name in _JOINT_TICKS}
        self.periods |= {name: self.periods[name] * levers for name in _PERIOD_TRUTH}
        self.diagnostics = {name: told * levers for name, told in self.diagnostics.items()}
