"""The paper's experiments on many arms at once, of which only the motion is kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import ARM
from fo_gym.compensators import Compensator
from fo_gym.evaluation.competitors.team import Team, alike
from fo_gym.friction import LuGre
from fo_gym.plant.links import Links
from fo_gym.signals import Signals
from fo_gym.simulation.settings import Settings
from fo_gym.simulation.simulation import Simulation
from fo_gym.tasks.task import TaskLike

Array = NDArray[np.float64]

assert isinstance(ARM.friction, LuGre)
FRICTION: LuGre = ARM.friction
_SAMPLE = 10
"""Every which tick is kept."""

__all__ = ["ARM", "FRICTION", "Arm", "run_arms"]


@dataclass(frozen=True, eq=False)
class Arm:
    """What an arm did. Arrays are (samples, dof), but for `time`.

    Attributes:
        time: of the samples, (samples,) [s].
        error, error_n: of the motor and of the nominal motor, theta - theta_d and theta_n - theta_d [rad].
        q: links [rad].
    """

    time: Array
    error: Array
    error_n: Array
    q: Array

    def errors(self, start: float, end: float, joint: int) -> Array:
        """The error of a joint's motor from `start` to `end` [s], (samples,) [mrad]."""
        inside = (self.time >= start - 1e-9) & (self.time <= end + 1e-9)
        return np.asarray(1e3 * self.error[inside, joint])

    def tool(self) -> Array:
        """The tool's path, (samples, 3) [m]."""
        return Links(ARM.link_side).tool_position(self.q)


def run_arms(
    members: Mapping[str, Compensator],
    task: TaskLike,
    settings: Settings,
    *,
    seeds: Sequence[int] = (0,),
    frictions: Sequence[LuGre] = (),
) -> dict[str, list[Arm]]:
    """Run every member on the same episodes of the MIRO-like arm.

    Args:
        members: who they are.
        task: what is asked of the arm.
        settings: how it is run; the members choose the feedback.
        seeds: of the episodes.
        frictions: in place of seeds: the same episode, once under each of these.

    Raises:
        ValueError: the micro-step is too long for a joint.
        RuntimeError: an episode ended early.
    """
    episodes = [seeds[0]] * len(frictions) if frictions else list(seeds)
    found: dict[str, list[Arm]] = {}
    for names in alike(members):
        team = Team([members[name] for name in names], len(episodes))
        simulation = _begun(
            task, replace(settings, feedback=team.feedback), episodes * len(names), [*frictions] * len(names)
        )
        arms = _run(team, simulation)
        found |= {name: arms[team.rows(place)] for place, name in enumerate(names)}
    return {name: found[name] for name in members}


def _begun(task: TaskLike, settings: Settings, seeds: Sequence[int], frictions: Sequence[LuGre]) -> Simulation:
    """The batch at its start; a seed for each arm, and a friction where they are to differ."""
    simulation = Simulation(ARM, task, len(seeds), settings, num_threads=1)
    everyone, plant = np.arange(len(seeds)), simulation.plant
    simulation.reset(everyone, [np.random.default_rng(seed) for seed in seeds])
    for i, friction in enumerate(frictions):
        plant.configure(everyone[i : i + 1], joints=simulation.robot.flexible, friction=friction)
    plant.reset(everyone, plant.q.copy())  # at rest friction has no part in where they are; it checks the micro-step
    return simulation


def _run(team: Team, simulation: Simulation) -> list[Arm]:
    """The motion of every arm of the batch."""
    team.reset(simulation.joint_info, simulation.num_envs)
    plant, control, nominal = simulation.plant, simulation.control, simulation.nominal_motor
    samples = simulation.last_tick // _SAMPLE
    error, error_n, q = np.empty((3, samples, simulation.num_envs, simulation.dof))
    for tick in range(samples * _SAMPLE):
        if tick % _SAMPLE == 0:
            sample = tick // _SAMPLE
            error[sample], error_n[sample] = plant.theta - control.theta_d, nominal.theta - control.theta_d
            q[sample] = plant.q
        signals = Signals.from_observation(simulation.observation(), simulation.dof, simulation.available)
        _, _, _, ended = simulation.step(team.estimate(signals))
        if ended:
            raise RuntimeError(f"episodes of the arm ended early: {ended}")
    time = np.asarray(simulation.settings.control_dt * _SAMPLE * np.arange(samples), dtype=np.float64)
    return [Arm(time, error[:, i], error_n[:, i], q[:, i]) for i in range(simulation.num_envs)]
