"""Sets of episodes that everybody meets, and the rows that come of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import pandas as pd

from fo_gym.compensators import Compensator, Ideal, NoCompensation, has_learned, is_privileged
from fo_gym.envs.registry import ENVIRONMENTS, environment_of
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.evaluation.competitors.competitor import REFERENCE
from fo_gym.evaluation.episode.recorder import record
from fo_gym.evaluation.episode.recording import Recording, References
from fo_gym.evaluation.metrics import METRICS, score
from fo_gym.evaluation.runs.cloud import spread_out
from fo_gym.evaluation.runs.provenance import provenance
from fo_gym.robots import Robot, robot_of
from fo_gym.specs import BUILT_IN
from fo_gym.tasks.variants import NOMINAL

OK, TERMINATED, FAILED = "ok", "terminated", "failed"

SET = ["env", "robot", "variant"]
"""Columns that name a set of episodes."""
KEY = [*SET, "compensator"]
"""Columns that name a run: a competitor on a set of episodes."""

__all__ = [
    "FAILED",
    "KEY",
    "OK",
    "SET",
    "TERMINATED",
    "EpisodeSet",
    "failed_rows",
    "label_of",
    "place_of",
    "references_of",
    "rows",
]


@dataclass(frozen=True)
class EpisodeSet:
    """Episodes that every competitor meets: the same environment, variant, seeds and arguments.

    Attributes:
        env_id: registered environment, by its id, however it was named: "module:ID" and "file.py:ID" become that.
        variant: variant of it.
        seeds: one per episode; of the nominal variant 0 is the episode itself, and others move its start by next to
            nothing.
        env_kwargs: further arguments of the environment.
        traced: whether the worst, the median and the best are kept tick by tick; the nominal one is, in any case.

    Raises:
        ValueError: there is no such environment.
    """

    env_id: str
    variant: str
    seeds: tuple[int, ...]
    env_kwargs: Mapping[str, Any]
    traced: bool = False

    def __post_init__(self) -> None:
        # Gains, columns and keys of the store go by the id.
        object.__setattr__(self, "env_id", environment_of(self.env_id).id)

    @cached_property
    def robot(self) -> Robot:
        """The robot of these episodes: the one that is named, or the environment's own."""
        return robot_of(self.env_kwargs.get("robot") or environment_of(self.env_id).robot)

    @property
    def label(self) -> str:
        """What to call them."""
        return label_of(self.env_id, self.robot.name, self.variant)

    def record(self, compensator: Compensator, name: str) -> Recording:
        """Run `compensator` on these episodes."""
        return record(compensator, name, self.env_id, self.variant, self.seeds, self.env_kwargs, self.start)

    def start(self, env: JointVectorEnv) -> None:
        """Change what is drawn, before anything moves: nominal episodes start from a cloud, see `spread_out`."""
        if self.variant == NOMINAL:
            spread_out(env, self.seeds)


def place_of(env_id: object, robot: object) -> str:
    """Where episodes are, for a reader: the environment, and the robot where it is not the environment's own."""
    known = ENVIRONMENTS.get(str(env_id))
    return str(env_id) if robot in ("", known.robot_name if known is not None else "") else f"{env_id} on {robot}"


def label_of(env_id: object, robot: object, variant: object) -> str:
    """A set of episodes, for a reader."""
    return f"{place_of(env_id, robot)}, {variant}"


def references_of(episodes: EpisodeSet) -> tuple[Recording, Recording]:
    """The two runs that every score of these episodes is relative to: `none`, then `ideal`."""
    return episodes.record(NoCompensation(), "none"), episodes.record(Ideal(), "ideal")


def rows(
    episodes: EpisodeSet, name: str, recording: Recording, references: References, compensator: Compensator
) -> pd.DataFrame:
    """The scores of a recording of `compensator`, one row per episode.

    `competitor_hash` and `protocol` are "" in it, and so is `origin` but of a reference.
    """
    reference = name in BUILT_IN or is_privileged(compensator)
    told = provenance(origin=REFERENCE if reference else "", learned=has_learned(compensator))
    table = []
    for i, seed in enumerate(episodes.seeds):
        episode = recording.episode(i, references)
        reason = recording.terminations[i]
        error = f"{reason} at {recording.ended[i] * recording.dt:.3f} s" if reason else ""
        table.append(
            {
                "env": episodes.env_id,
                "robot": episodes.robot.name,
                "variant": episodes.variant,
                "compensator": name,
                "seed": seed,
                "status": TERMINATED if reason else OK,
                "error": error,
                **score(episode),
                "joint_unit": episode.joint_unit,
                **told,
            }
        )
    return pd.DataFrame(table)


def failed_rows(episodes: EpisodeSet, name: str, error: str) -> pd.DataFrame:
    """Rows of a competitor that could not be run: no scores, and why."""
    row = {"env": episodes.env_id, "robot": episodes.robot.name, "variant": episodes.variant, "compensator": name}
    scores = dict.fromkeys(METRICS, float("nan"))
    return pd.DataFrame(
        {**row, "seed": seed, "status": FAILED, "error": error, **scores, "joint_unit": "", **provenance()}
        for seed in episodes.seeds
    )
