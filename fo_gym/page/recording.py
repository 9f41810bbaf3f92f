"""Record again what the traces of the page need: everybody on the same episode of every set."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import pandas as pd

from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.runs.backends import Backend
from fo_gym.evaluation.runs.contest import Contest
from fo_gym.evaluation.runs.episodes import SET
from fo_gym.evaluation.runs.provenance import is_reference
from fo_gym.evaluation.runs.run import run_contests
from fo_gym.evaluation.runs.store import Store
from fo_gym.tasks.variants import NOMINAL

SetKey = tuple[str, str, str]
"""Environment, robot and variant."""

__all__ = ["SetKey", "everybodys", "single_episodes", "telling_seed", "telling_seeds"]


def telling_seed(rows: pd.DataFrame) -> int:
    """The episode that stands for a set: of the nominal one seed 0, else the one that was of middling difficulty.

    Args:
        rows: of episodes.csv, of one set.

    Returns:
        The seed at which the median FRR of the ranked rows is the (lower) median of all seeds.
    """
    if (rows["variant"] == NOMINAL).all():
        return int(rows["seed"].min())
    typical = rows[~is_reference(rows)].groupby("seed")["frr"].median().sort_values(kind="stable")
    return int(typical.index[(len(typical) - 1) // 2])


def telling_seeds(episodes: pd.DataFrame) -> dict[SetKey, list[int]]:
    """`telling_seed` of every set."""
    groups = episodes.groupby(SET, sort=False)
    return {(str(env), str(robot), str(variant)): [telling_seed(rows)] for (env, robot, variant), rows in groups}


def single_episodes(contests: Sequence[Contest], seeds: Mapping[SetKey, Sequence[int]]) -> list[Contest]:
    """Contests of one episode each, in which everybody is traced.

    Args:
        contests: whole sets.
        seeds: which episodes of each.
    """
    found = []
    for contest in contests:
        episodes = contest.episodes
        for seed in seeds[episodes.env_id, episodes.robot.name, episodes.variant]:
            found.append(replace(contest, episodes=replace(episodes, seeds=(seed,), traced=True)))
    return found


def everybodys(
    contests: Sequence[Contest], backend: Backend, store: Store | None, on_run: Callable[[str], None] | None = None
) -> list[Trace]:
    """The traces of everybody in contests of one episode each; of who failed, none.

    Args:
        contests: as `single_episodes` gives them.
        backend: who does the work.
        store: where finished runs are kept and looked for.
        on_run: who is told of every run.
    """
    return run_contests(contests, "page", backend=backend, store=store, on_run=on_run).traces
