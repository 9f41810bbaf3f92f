"""The ranking as a person reads it: headings and cells, for the terminal and for Markdown alike."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import pandas as pd

from fo_gym.compensators import BUILT_IN
from fo_gym.evaluation.evaluate import OK
from fo_gym.evaluation.leaderboard import KEY, SET, leaderboard, standings

# Beside frr: column, heading, and the factor from the column's unit to the heading's.
_SHOWN = (
    ("rest_error_ju", "rest error [m{unit}]", 1e3),
    ("limit_cycle_amplitude_ju", "limit cycle [m{unit}]", 1e3),
    ("tool_rms_error_mm", "tool RMS [mm]", 1.0),
    ("contour_error_mm", "contour RMS [mm]", 1.0),
    ("estimate_lag_ms", "lag [ms]", 1.0),
)

__all__ = ["Ranking", "markdown", "rankings", "summary"]


class Ranking(NamedTuple):
    """One environment and variant, best competitor first, the references last."""

    title: str
    headings: list[str]
    cells: list[list[str]]


def _number(value: Any, form: str, factor: float = 1.0) -> str:
    return "" if pd.isna(value) else format(value * factor, form)


def _verdict(row: pd.Series[Any]) -> str:
    words = "reference" if row["compensator"] in BUILT_IN else row["verdict"]
    note = "" if row["status"] == OK else f"{row['status']}: {row['error']}"
    return "; ".join(str(part) for part in (words, note) if part and not pd.isna(part))


def _cells(row: pd.Series[Any], shown: list[tuple[str, str, float]]) -> list[str]:
    interval = "" if pd.isna(row["frr"]) else f"{row['frr_ci_low']:.4f} ... {row['frr_ci_high']:.4f}"
    scores = [_number(row[column], ".3g", factor) for column, _, factor in shown]
    return [
        _number(row["rank"], ".0f"),
        row["compensator"],
        _number(row["frr"], ".4f"),
        interval,
        *scores,
        _verdict(row),
    ]


def rankings(episodes: pd.DataFrame) -> Iterator[Ranking]:
    """One ranking per environment and variant of the episodes (rows as `evaluate` gives them)."""
    table = leaderboard(episodes).merge(standings(episodes), on=KEY, how="left")
    for key, group in table.groupby(SET, sort=False):
        ordered = group.sort_values("rank", kind="stable", na_position="last")
        unit = next((unit for unit in ordered["joint_unit"] if unit), "")
        shown = [entry for entry in _SHOWN if ordered[entry[0]].notna().any()]
        if any(column.endswith("_mm") for column, _, _ in shown):
            # Where the tool's path is the task, joints may rest anywhere that puts the tool right.
            shown = [entry for entry in shown if not entry[0].endswith("_ju")]
        headings = [
            "rank",
            "compensator",
            "FRR",
            "95 % interval",
            *(h.format(unit=unit) for _, h, _ in shown),
            "verdict",
        ]
        cells = [_cells(row, shown) for _, row in ordered.iterrows()]
        yield Ranking(f"{key[0]}, {key[1]}", headings, cells)


def summary(table: pd.DataFrame) -> Ranking:
    """FRR of every competitor in every environment and variant, best on average first, failed ones last.

    Args:
        table: rows as `leaderboard` gives them.
    """
    competitors = table[~table["compensator"].isin(BUILT_IN)]
    frr = competitors.pivot(index="compensator", columns=SET, values="frr")
    sets = list(table[SET].drop_duplicates().itertuples(index=False, name=None))
    mean = frr.mean(axis=1, skipna=False).sort_values(ascending=False, kind="stable", na_position="last")
    frr = frr.loc[mean.index, sets]
    headings = ["compensator", *(f"{env}, {variant}" for env, variant in sets)]
    cells = [
        [str(name), *(_number(value, ".3f") for value in values)]
        for name, values in zip(frr.index, frr.to_numpy(), strict=True)
    ]
    return Ranking("Friction rejection ratio", headings, cells)


def markdown(ranking: Ranking) -> str:
    """The ranking as a Markdown table."""
    rows = [ranking.headings, ["---"] * len(ranking.headings), *ranking.cells]
    return "\n".join("| " + " | ".join(_escaped(cell) for cell in row) + " |" for row in rows) + "\n"


def _escaped(cell: str) -> str:
    return cell.replace("|", "\\|").replace("\n", " ")
