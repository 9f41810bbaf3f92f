"""Verify published results: run some of them again with what is installed, and compare them cell by cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from fo_gym.checks import choice
from fo_gym.compensators import BUILT_IN
from fo_gym.evaluation.backends import Backend
from fo_gym.evaluation.competitor import Competitor
from fo_gym.evaluation.entry import check_names, competitor_of
from fo_gym.evaluation.evaluate import EpisodeSet
from fo_gym.evaluation.leaderboard import KEY, SET
from fo_gym.evaluation.protocol import known_environments, load_protocol, shipped_protocols
from fo_gym.evaluation.provenance import is_provenance
from fo_gym.evaluation.run import Contest, OnRun, run_contests
from fo_gym.files import csv, read_csv
from fo_gym.tasks.variants import VARIANTS

SAME, MISMATCH, OTHER = "same", "mismatch", "of other versions"
"""Verdicts on a row: the same text; another one, under the same versions; another one, under other versions."""

_MADE_OF = ("competitor_hash", "version_")
_ROW = [*KEY, "seed"]

__all__ = ["MISMATCH", "OTHER", "SAME", "Comparison", "contests_of", "published", "sampled", "verify"]


@dataclass(frozen=True)
class Comparison:
    """A published row beside the same row computed now.

    Attributes:
        row: env, variant, compensator and seed.
        differences: the cells that differ, as "column: published, now".
        versions: the same for the versions and the competitor's hash.
    """

    row: tuple[str, ...]
    differences: tuple[str, ...]
    versions: tuple[str, ...]

    @property
    def verdict(self) -> str:
        """`SAME`, `MISMATCH` or `OTHER`. Other versions that give the same text are the same."""
        if not self.differences:
            return SAME
        return OTHER if self.versions else MISMATCH


def published(folder: Path) -> pd.DataFrame:
    """The rows of episodes.csv, every cell as its text.

    Raises:
        ValueError: there is no such file, or it does not hold such rows.
    """
    file = folder / "episodes.csv"
    if not file.is_file():
        raise ValueError(f"there is no {file}; write one with `fo-gym leaderboard --out {folder}`")
    try:
        table = read_csv(file.read_text(encoding="utf-8"), numbers=False)
    except (ValueError, OSError) as error:  # pandas' own errors are ValueErrors
        raise ValueError(
            f"{file} cannot be read ({' '.join(str(error).split())}); run `fo-gym leaderboard` again"
        ) from error
    missing = [column for column in (*_ROW, "protocol", "competitor_hash") if column not in table]
    if missing or not len(table):
        raise ValueError(
            f"{file} has {len(table)} rows and lacks the columns {missing}; run `fo-gym leaderboard` again"
        )
    for column, allowed in (("env", known_environments()), ("variant", VARIANTS)):
        for value in table[column].unique():
            choice(f"{file}: {column}", value, allowed)
    for value in table["seed"][~table["seed"].str.fullmatch(r"\d{1,38}")]:
        raise ValueError(f"{file}: seed is {value!r}; it must be a whole number of at least 0")
    return table


def sampled(table: pd.DataFrame, sample: int, seed: int) -> pd.DataFrame:
    """The runs that a random sample of rows belongs to, whole: a run is what can be run again.

    Args:
        table: as `published` gives it.
        sample: number of rows that are drawn; all where there are not so many.
        seed: of the draw.
    """
    chosen = np.random.default_rng(seed).choice(len(table), size=min(sample, len(table)), replace=False)
    runs = table.iloc[chosen][KEY].drop_duplicates()
    return table.merge(runs, on=KEY)


def _known(
    table: pd.DataFrame, submissions: Sequence[Competitor], protocol: str | Path | None
) -> dict[str, Competitor]:
    """Competitors by the names that the rows give them: submissions, and entries that the protocol names by path."""
    stamp = str(table["protocol"].iloc[0]).partition("@")[0]
    file = protocol or (stamp if stamp in shipped_protocols() else None)
    named = [] if file is None else [competitor_of(name) for name in load_protocol(file).compensators]
    everybody = [*(each for each in named if each.name not in BUILT_IN), *submissions]
    check_names(everybody)
    return {each.name: each for each in everybody}


def _hash_of(rows: pd.DataFrame, name: str) -> str:
    return str(rows.loc[rows["compensator"] == name, "competitor_hash"].iloc[0])


def contests_of(
    table: pd.DataFrame, submissions: Sequence[Competitor] = (), protocol: str | Path | None = None
) -> list[Contest]:
    """What has to be run to compute these rows again.

    Args:
        table: whole runs, as `sampled` gives them.
        submissions: competitors that are not known by their name.
        protocol: that of the rows; by default the shipped one of their name.

    Raises:
        ValueError: the protocol or an entry cannot be read, or a competitor is nowhere.
    """
    known = _known(table, submissions, protocol)
    contests = []
    for key, rows in table.groupby(SET, sort=False):
        env_id, variant = (str(part) for part in key)
        seeds = tuple(int(seed) for seed in rows["seed"].unique())
        names = [str(name) for name in rows["compensator"].unique() if name not in BUILT_IN]
        competitors = tuple(known.get(name) or competitor_of(name) for name in names)
        for each, content in zip(competitors, (_hash_of(rows, name) for name in names), strict=True):
            if content and not each.content.files:
                raise ValueError(
                    f"competitor {each.name!r} is not known here; install its package, run this where its file is, or "
                    "name its entry: the folder of submissions, or the protocol that lists it"
                )
        contests.append(Contest(EpisodeSet(env_id, variant, seeds, {}), competitors))
    return contests


def verify(
    table: pd.DataFrame, contests: Sequence[Contest], *, backend: Backend, on_run: OnRun | None = None
) -> list[Comparison]:
    """Compute rows again and compare them.

    Args:
        table: whole runs, as `sampled` gives them.
        contests: `contests_of` these.
        backend: who does the work.
        on_run: called with a label after every run, `none` and `ideal` counted as one.

    Returns:
        One comparison per row of the table, in its order.
    """
    now = read_csv(csv(run_contests(contests, "", backend=backend, on_run=on_run).episodes), numbers=False)
    rows = {_key(row): row for row in _cells(now)}
    return [_compared(row, rows[_key(row)]) for row in _cells(table)]


def _cells(table: pd.DataFrame) -> list[dict[str, str]]:
    return [{str(column): str(cell) for column, cell in row.items()} for row in table.to_dict("records")]


def _key(row: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(row[name] for name in _ROW)


def _compared(before: Mapping[str, str], now: Mapping[str, str]) -> Comparison:
    columns = dict.fromkeys([*before, *now])
    different = [column for column in columns if before.get(column) != now.get(column)]
    told = {column: f"{column}: {_shown(before, column)} published, {_shown(now, column)} now" for column in different}
    return Comparison(
        row=_key(before),
        differences=tuple(text for column, text in told.items() if not is_provenance(column)),
        versions=tuple(text for column, text in told.items() if column.startswith(_MADE_OF)),
    )


def _shown(row: Mapping[str, str], column: str) -> str:
    return (row[column] or "empty") if column in row else "no such column"
