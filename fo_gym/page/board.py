"""What the page tells, out of the published tables: a ranking per environment, robot and variant, ready to be drawn."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from fo_gym.evaluation.competitors.competitor import YOURS
from fo_gym.evaluation.results.tables import MARKS, frr_everywhere, second_headlines
from fo_gym.evaluation.runs.episodes import OK, SET, place_of
from fo_gym.evaluation.runs.provenance import is_reference
from fo_gym.page.who import Who
from fo_gym.text import MESSAGE_LIMIT, one_line

_SPAN = (-1.0, 4.0)
"""What the axis of 1 - FRR may show at most, as digits: from 10 to 0.0001."""
_IN_NUMBERS = {"limit_cycle_period_s", "estimate_lag_ms", "passivity_violation_ratio"}
"""Columns for which the table of the page has no room; its comparison of all numbers has them."""
_TICKS = 3
"""Decades that are labelled, at most; of more every other one is."""

__all__ = ["Cell", "Overview", "Ranking", "Row", "digits", "key_of", "overview", "rankings", "shown_columns", "slug"]


@dataclass(frozen=True)
class Cell:
    """A number of a table.

    Attributes:
        column: of leaderboard.csv.
        value: as it stands there; NaN where it does not apply.
        text: as the page shows it, in the unit of the heading.
    """

    column: str
    value: float
    text: str


@dataclass(frozen=True)
class Row:
    """A competitor in a ranking.

    Attributes:
        who: its name, family and a line about it.
        mark: that of its origin.
        own: whether it is the reader's.
        standing: "best", "tied" (with the best), "behind", "reference" or "failed".
        note: what went wrong, or "".
        rank, ranks, group: its rank, the interval of it, and the letters of its tied groups; "" of references.
        left: 1 - FRR, with both ends of its interval.
        places: of these three on the logarithmic axis, percent from its left end; empty without a score.
        outside: "worse" or "better" where it lies beyond the axis, or "".
        cells: the second headlines.
    """

    who: Who
    mark: str
    own: bool
    standing: str
    note: str
    rank: str
    ranks: str
    group: str
    left: tuple[Cell, Cell, Cell]
    places: tuple[float, ...]
    outside: str
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Ranking:
    """The ranking of one set of episodes, best first, references last.

    Attributes:
        key: names it in addresses, such as "FJRStiction-v0/nominal".
        env, robot, variant: the set.
        place: environment and robot, for a reader.
        unit: "m" or "rad".
        episodes: how many.
        headings: of the second headlines: column, name, unit.
        ticks: of the axis of 1 - FRR: text, and percent from its left end.
        rows: everybody.
    """

    key: str
    env: str
    robot: str
    variant: str
    place: str
    unit: str
    episodes: int
    headings: tuple[tuple[str, str, str], ...]
    ticks: tuple[tuple[str, float], ...]
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Overview:
    """FRR of everybody everywhere.

    Attributes:
        keys: of the rankings, one per column.
        rows: who, mark, whether it is the reader's, and for each column the cell of 1 - FRR and its shade: 0 (more than
            0.3 left) to 5 (less than 0.001), or -1.
    """

    keys: tuple[str, ...]
    rows: tuple[tuple[Who, str, bool, tuple[tuple[Cell, int], ...]], ...]


def shown_columns(rows: pd.DataFrame) -> list[tuple[str, str, float]]:
    """The second headlines that the page has room for beside FRR, as `second_headlines` gives them."""
    return [entry for entry in second_headlines(rows) if entry[0] not in _IN_NUMBERS]


def slug(text: str) -> str:
    """A text as part of an address."""
    return re.sub(r"[^\w.+-]+", "-", text).strip("-")


def key_of(env: str, robot: str, variant: str) -> str:
    """What names a ranking in addresses."""
    return f"{slug(place_of(env, robot))}/{variant}"


def digits(left: float) -> float:
    """The place of a 1 - FRR on the axis: 0 at 1, 1 at 0.1, 2 at 0.01; infinite at 0."""
    return -math.log10(left) if left > 0.0 else math.inf


def rankings(table: pd.DataFrame, who: Mapping[str, Who]) -> Iterator[Ranking]:
    """The rankings of leaderboard.csv, in its order.

    Args:
        table: rows as `leaderboard` gives them, read from there.
        who: everybody by name.
    """
    for key, rows in table.groupby(SET, sort=False):
        env, robot, variant = (str(part) for part in key)
        limits = _limits(rows)
        shown = shown_columns(rows)
        ordered = rows.assign(reference=is_reference(rows)).sort_values(
            ["reference", "rank"], kind="stable", na_position="last"
        )
        yield Ranking(
            key=key_of(env, robot, variant),
            env=env,
            robot=robot,
            variant=variant,
            place=place_of(env, robot),
            unit=next((unit for unit in rows["joint_unit"] if unit), ""),
            episodes=int(rows["episodes"].max()),
            headings=tuple((column, *_heading(heading)) for column, heading, _ in shown),
            ticks=_ticks(limits),
            rows=tuple(_row(row, shown, limits, who[str(row["compensator"])]) for _, row in ordered.iterrows()),
        )


def overview(table: pd.DataFrame, who: Mapping[str, Who]) -> Overview:
    """FRR of everybody everywhere, best on average first."""
    frr = frr_everywhere(table)
    origins = table.drop_duplicates("compensator").set_index("compensator")["origin"]
    rows = []
    for name, values in zip(map(str, frr.index), frr.to_numpy(), strict=True):
        cells = tuple((_left(value), _shade(1.0 - value)) for value in values)
        rows.append((who[name], MARKS.get(origins[name], ""), origins[name] == YOURS, cells))
    return Overview(tuple(key_of(*each) for each in frr.columns.to_list()), tuple(rows))


def _shade(left: float) -> int:
    return -1 if math.isnan(left) else int(np.searchsorted([0.5, 1.0, 1.5, 2.0, 2.5], digits(left), side="right"))


def _limits(table: pd.DataFrame) -> tuple[float, float]:
    """The part of the axis that holds every ranked row, but no more than `_SPAN`."""
    places = [digits(1.0 - frr) for frr in table.loc[~is_reference(table), "frr"].dropna()]
    low, high = np.clip([min(places, default=0.0), max(places, default=1.0)], *_SPAN)
    return float(np.floor(low)), max(float(np.ceil(high)), float(np.floor(low)) + 1.0)


def _percent(left: float, limits: tuple[float, float]) -> float:
    low, high = limits
    return round(100.0 * (float(np.clip(digits(left), low, high)) - low) / (high - low), 2)


def _ticks(limits: tuple[float, float]) -> tuple[tuple[str, float], ...]:
    decades = range(int(limits[0]), int(limits[1]) + 1)
    decades = decades if len(decades) <= _TICKS else decades[::2]
    return tuple((f"{10.0**-decade:g}", _percent(10.0**-decade, limits)) for decade in decades)


def _heading(heading: str) -> tuple[str, str]:
    """Name and unit of a heading such as "limit cycle [mm]"."""
    name, _, unit = heading.partition(" [")
    return name, unit.removesuffix("]")


def _cell(column: str, value: Any, factor: float = 1.0) -> Cell:
    number = float(value)
    return Cell(column, number, "" if math.isnan(number) else f"{number * factor:.3g}")


def _left(frr: Any) -> Cell:
    """1 - FRR, in the table's own digits."""
    return Cell("frr", float(frr), "" if math.isnan(frr) else f"{1.0 - frr:.3g}")


def _row(row: pd.Series[Any], shown: Sequence[tuple[str, str, float]], limits: tuple[float, float], who: Who) -> Row:
    left = (_left(row["frr"]), _left(row["frr_ci_low"]), _left(row["frr_ci_high"]))
    place = digits(1.0 - left[0].value)
    scored = not math.isnan(left[0].value)
    return Row(
        who=who,
        mark=MARKS.get(row["origin"], ""),
        own=row["origin"] == YOURS,
        standing="reference" if row["reference"] else str(row["verdict"]) if scored else "failed",
        note="" if row["status"] == OK else one_line(f"{row['status']}: {row['error']}", MESSAGE_LIMIT),
        rank="" if pd.isna(row["rank"]) else f"{row['rank']:.0f}",
        ranks="" if pd.isna(row["rank"]) else f"{row['rank_ci_low']:.0f} to {row['rank_ci_high']:.0f}",
        group="" if pd.isna(row["tied_group"]) else str(row["tied_group"]),
        left=left,
        places=tuple(_percent(1.0 - each.value, limits) for each in left) if scored else (),
        outside="worse" if place < limits[0] else "better" if place > limits[1] else "",
        cells=tuple(_cell(column, row[column], factor) for column, _, factor in shown),
    )
