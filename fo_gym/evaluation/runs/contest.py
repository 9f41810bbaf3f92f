"""What has to be run: sets of episodes with everybody who meets them; and what comes of it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import pandas as pd

from fo_gym.envs.registry import Environment, environment_of
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.competitors.entry import check_names, competitor_of
from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.evaluation.runs.trial import REFERENCES
from fo_gym.friction import LAWS, LuGre, law_class
from fo_gym.robots import Robot, RobotLike, robot_of
from fo_gym.specs import BUILT_IN

_WITH = " with "
"""Between the name of a robot and that of the law that it was given."""

__all__ = [
    "Contest",
    "Results",
    "competitors_of",
    "contests_in",
    "episodes_in",
    "law_of_robot",
    "laws_by_name",
    "under_law",
]


@dataclass(frozen=True)
class Contest:
    """A set of episodes, and who meets them besides the references.

    Attributes:
        episodes: what they meet.
        competitors: who.
    """

    episodes: EpisodeSet
    competitors: tuple[Competitor, ...]

    @property
    def everybody(self) -> tuple[Competitor, ...]:
        """The references first."""
        return *REFERENCES, *self.competitors

    @property
    def runs(self) -> int:
        """How many runs there are, the references counted as one."""
        return 1 + len(self.competitors)


@dataclass(frozen=True)
class Results:
    """What a protocol yields.

    Attributes:
        episodes: one row per episode, in the protocol's order.
        timing: one row per run: time per call of `estimate`, for the whole batch, when it was computed.
        traces: the nominal episodes, and where asked for (or kept in the store) those of the other variants.
        competitors: who took part, besides the references.
        runs: number of runs, the references of a set counted as one.
        stored: how many of them were taken from the store.
    """

    episodes: pd.DataFrame
    timing: pd.DataFrame
    traces: list[Trace]
    competitors: tuple[Competitor, ...] = field(default=())
    runs: int = 0
    stored: int = 0


def competitors_of(protocol: Protocol, submissions: Sequence[Competitor] = ()) -> tuple[Competitor, ...]:
    """Who takes part besides the references: those that the protocol names, then the submissions.

    Raises:
        ValueError: an entry is not allowed, or two have the same name.
    """
    named = tuple(competitor_of(name) for name in protocol.compensators if name not in BUILT_IN)
    check_names((*named, *submissions))
    return (*named, *submissions)


def contests_in(protocol: Protocol, submissions: Sequence[Competitor] = (), *, traced: bool = False) -> list[Contest]:
    """Every set of episodes of a protocol, with everybody who meets it. Raises as `competitors_of` does."""
    competitors = competitors_of(protocol, submissions)
    if not competitors:
        raise ValueError(
            f"protocol {protocol.name!r}: compensators is {list(protocol.compensators)}; name one besides references"
        )
    return [Contest(episodes, competitors) for episodes in episodes_in(protocol, traced=traced)]


def under_law(robot: RobotLike, law: str) -> Robot:
    """The robot under a friction law, as like its own friction as can be, with the law in its name.

    One of LuGre keeps its name under that, unless the name ends as if it were of another law.

    Raises:
        FileNotFoundError, ValueError: the robot or the law cannot be had, or the robot's friction is neither of that
            law nor LuGre.
    """
    own = robot_of(robot)
    kind = law_class(law)
    friction = own.friction
    if not isinstance(friction, kind):
        if not isinstance(friction, LuGre):
            raise ValueError(f"robot {own.name!r} has friction {type(friction).__name__}; laws are made like a LuGre")
        try:
            friction = kind.like(friction)
        except NotImplementedError as error:
            raise ValueError(f"law {law!r}: {error}") from error
    if kind is LuGre and law_of_robot(own.name)[0] == own.name:
        return own
    return replace(own, friction=friction, name=f"{own.name}{_WITH}{kind.__name__}")


def laws_by_name(protocol: Protocol) -> dict[str, str]:
    """The laws of a protocol by the names that tables call them: their classes', in the protocol's order."""
    return {law_class(law).__name__: law for law in protocol.laws}


def law_of_robot(name: str, laws: Collection[str] = LAWS) -> tuple[str, str]:
    """Whose the name of a robot in a table is, and under which law it runs there: "LuGre" where it names none.

    Args:
        name: as `under_law` makes it.
        laws: names of those that may stand in it; other words belong to the robot.
    """
    own, _, law = name.rpartition(_WITH)
    return (own, law) if own and law in laws else (name, LuGre.__name__)


def _under(kind: dict[str, Any], env: Environment, law: str) -> dict[str, Any]:
    """Arguments of an environment under a law; the same, where that is its own."""
    own = robot_of(kind.get("robot", env.robot))
    robot = under_law(own, law)
    return kind if robot is own else {"robot": robot}


def episodes_in(protocol: Protocol, *, traced: bool = False) -> list[EpisodeSet]:
    """Every set of episodes of a protocol: each environment on its robots (for arms), under its laws, in each variant.

    Raises:
        FileNotFoundError, ValueError: a robot or a law cannot be had.
    """
    robots = [replace(robot_of(value), name=name) for name, value in protocol.robots.items()]
    sets = []
    for env in map(environment_of, protocol.environments):
        kinds: list[dict[str, Any]] = [{"robot": robot} for robot in robots if "arm" in env.tags] or [{}]
        if protocol.laws:
            kinds = [_under(kind, env, law) for kind in kinds for law in protocol.laws]
        sets += [
            EpisodeSet(env.id, variant, protocol.seeds_of(variant), kind, traced)
            for kind in kinds
            for variant in protocol.variants
        ]
    return sets
