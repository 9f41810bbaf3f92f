"""What is filmed: an episode of one competitor, as states for pictures and as a curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.envs.vector import JointVectorEnv
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.episode.recorder import record
from fo_gym.evaluation.episode.recording import Recording
from fo_gym.evaluation.results.trace_figure import SHOWN_JOINT
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.simulation.simulation import Simulation
from fo_gym.simulation.state import SimulationState

Array = NDArray[np.float64]

_MILLI = 1e3

__all__ = ["Take", "curves_of", "take"]


@dataclass(frozen=True, eq=False)
class Take:
    """An episode of one competitor.

    Attributes:
        name: of the competitor.
        simulation: in which its states can be drawn.
        states: of the simulation, one per frame; fewer where the episode ended early.
        frame_dt: simulated time from state to state, whole steps [s].
        recording: tick by tick.
    """

    name: str
    simulation: Simulation
    states: tuple[SimulationState, ...]
    frame_dt: float
    recording: Recording

    @property
    def time(self) -> Array:
        """Of the ticks [s]."""
        return np.asarray(self.recording.dt * np.arange(len(self.recording.ticks["theta"])))


def take(competitor: Competitor, episode: EpisodeSet, frame_dt: float) -> Take:
    """Run a competitor on an episode.

    Args:
        competitor: who.
        episode: one.
        frame_dt: simulated time from frame to frame that is asked for [s]; the take has it in whole steps.

    Raises:
        CompensatorError, ValueError, TypeError: the competitor cannot be made, or fails.
    """
    kept: list[SimulationState] = []
    envs: list[JointVectorEnv] = []

    def stride(step_dt: float) -> int:
        return max(1, round(frame_dt / step_dt))

    def start(env: JointVectorEnv) -> None:
        episode.start(env)
        envs.append(env)
        kept.append(env.simulation.get_state())

    def look(env: JointVectorEnv, steps: int) -> None:
        if steps % stride(env.simulation.settings.step_dt) == 0:
            kept.append(env.simulation.get_state())

    with competitor.playing(episode.env_id, episode.variant) as compensator:
        where = episode.env_id, episode.variant, episode.seeds, episode.env_kwargs
        recording = record(compensator, competitor.name, *where, start, look)
    whole = stride(recording.dt) * recording.dt
    return Take(competitor.name, envs[0].simulation, tuple(kept), whole, recording)


def curves_of(takes: Sequence[Take], ideal: Take) -> tuple[list[Array], str, bool]:
    """What is drawn below the pictures: a curve (ticks,) for each, what it is, and whether its axis is logarithmic.

    On a tool path that is the tool's distance from the friction-free one, elsewhere a joint's distance from its target.
    """
    if "tool" in ideal.recording.ticks:
        apart = (each.recording.ticks["tool"] - ideal.recording.ticks["tool"] for each in takes)
        what = "from the friction-free tool [mm]"
        return [_MILLI * np.linalg.norm(each[:, 0], axis=-1) for each in apart], what, True
    dof = ideal.recording.robot.dof
    joint = min(SHOWN_JOINT, dof - 1)
    ticks = [each.recording.ticks for each in takes]
    what = f"{f'joint {joint + 1} ' if dof > 1 else ''}from its target [m{ideal.recording.robot.joint_unit}]"
    return [_MILLI * (each["theta"] - each["theta_d"])[:, 0, joint] for each in ticks], what, False
