"""Verify published results: run some of them again with what is installed, and compare them row by row.

On the kind of processor that they were computed on the text of every cell must be the same; on another one every metric
must be within its tolerance. What is not within it is computed again as perturbed twins: a chaotic episode has no value
that another processor could repeat, but its twins tell how far apart its values may be.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import pandas as pd

from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.runs.backends import Backend
from fo_gym.evaluation.runs.comparison import Comparison, Row, compared
from fo_gym.evaluation.runs.contest import Contest
from fo_gym.evaluation.runs.episodes import KEY, EpisodeSet
from fo_gym.evaluation.runs.run import OnRun, run_contests
from fo_gym.evaluation.runs.twins import TWINS, TwinSet
from fo_gym.files import csv, read_csv

__all__ = ["key_of_row", "rows_of", "twin_contests", "verify", "with_twins"]


def verify(
    table: pd.DataFrame, contests: Sequence[Contest], *, backend: Backend, on_run: OnRun | None = None
) -> list[Comparison]:
    """Compute rows again and compare them.

    Args:
        table: whole runs, as `sampled` gives them.
        contests: `contests_of` these.
        backend: who does the work.
        on_run: called with a label after every run, the references counted as one.

    Returns:
        One comparison per row of the table, in its order.
    """
    now = {key_of_row(row): row for row in _again(contests, backend, on_run)}
    return [compared(key_of_row(row), row, now[key_of_row(row)]) for row in rows_of(table)]


def twin_contests(found: Iterable[Comparison], contests: Sequence[Contest]) -> list[list[Contest]]:
    """What has to be run to know the perturbed twins of the episodes that ask for them, a list per twin.

    Args:
        found: what `verify` returned.
        contests: what it ran.
    """
    asking = [comparison.row for comparison in found if comparison.asks_for_twins]
    needed: list[tuple[EpisodeSet, tuple[Competitor, ...]]] = []
    for contest in contests:
        episodes = contest.episodes
        rows = [row for row in asking if row[:3] == (episodes.env_id, episodes.robot.name, episodes.variant)]
        names, seeds = {row[3] for row in rows}, {int(row[4]) for row in rows}
        if rows:
            some = replace(episodes, seeds=tuple(seed for seed in episodes.seeds if seed in seeds))
            needed.append((some, tuple(each for each in contest.competitors if each.name in names)))
    numbers = range(1, TWINS + 1) if needed else ()
    return [[Contest(TwinSet(**vars(some), number=number), who) for some, who in needed] for number in numbers]


def with_twins(
    found: Iterable[Comparison], contests: Iterable[Sequence[Contest]], *, backend: Backend, on_run: OnRun | None = None
) -> list[Comparison]:
    """Run perturbed twins and put them beside the rows that ask for them.

    Args:
        found: what `verify` returned.
        contests: `twin_contests` of it; one twin is run after the other, as all their motions at once need much memory.
        backend: who does the work.
        on_run: as for `verify`.
    """
    twins: dict[tuple[str, ...], list[Row]] = {}
    for some in contests:
        for row in _again(some, backend, on_run):
            twins.setdefault(key_of_row(row), []).append(row)
    return [each.beside(twins[each.row]) if each.asks_for_twins else each for each in found]


def _again(contests: Sequence[Contest], backend: Backend, on_run: OnRun | None) -> list[Row]:
    """The rows of these contests as they would be published now."""
    episodes = run_contests(contests, "", backend=backend, on_run=on_run).episodes
    return rows_of(read_csv(csv(episodes), numbers=False))


def rows_of(table: pd.DataFrame) -> list[Row]:
    """The rows of a table of texts."""
    return [{str(column): str(cell) for column, cell in row.items()} for row in table.to_dict("records")]


def key_of_row(row: Row) -> tuple[str, ...]:
    """Env, robot, variant, compensator and seed of a row."""
    return tuple(row[name] for name in (*KEY, "seed"))
