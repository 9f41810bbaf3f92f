"""What was measured as a person reads it: a table for the terminal and for Markdown, and the files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fo_gym.bench.bars import HOLDS, MISSES, MORE_IS_BETTER
from fo_gym.evaluation.results.tables import Ranking, markdown
from fo_gym.files import atomic, csv

EXPLANATION = (
    "batch and single: our time over the peer's, less is better. threads: how many times faster a batch is on more "
    "threads (two) than on one; throughput: our steps per second over the peer's; more is better. growth: the power of "
    "the number of environments with which the time of a batch grows between the two numbers, 1 is linear. Ratios are "
    "medians over rounds in which everybody is timed in turn, with their quartiles; us is microseconds per environment "
    "and control period. Ours is the whole step of the environment, on one thread; the MuJoCo twin is the same plant's "
    "bare physics, wholly in MuJoCo at steps of 100 us, without geoms, contacts and joint limits; MuJoCo forward is "
    "what our plant has MuJoCo compute, inertia and bias of the links. Bars are for a machine of two cores."
)
"""How to read the table."""

__all__ = ["EXPLANATION", "counts", "page", "view", "write_bench"]


def counts(table: pd.DataFrame) -> str:
    """How many bars are kept, in words."""
    held, missed = (int((table["verdict"] == word).sum()) for word in (HOLDS, MISSES))
    return f"{held + missed} bars measured: {held} {'holds' if held == 1 else 'hold'}, {missed} missed"


def _number(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.3g}"


def _cells(row: dict[Any, Any]) -> list[str]:
    sign = "≥" if row["measured"] in MORE_IS_BETTER else "≤"
    return [
        row["env"],
        row["measured"],
        row["beside"],
        str(row["num_envs"]),
        _number(row["ratio"]),
        f"{_number(row['q1'])} ... {_number(row['q3'])}",
        "-" if np.isnan(row["bar"]) else f"{sign} {row['bar']:g}",
        row["verdict"],
        _number(row["ours_us"]),
        _number(row["peer_us"]),
    ]


def view(table: pd.DataFrame) -> Ranking:
    """Headings and cells of the rows as `bench` gives them."""
    headings = ["env", "measured", "beside", "envs", "ratio", "quartiles", "bar", "verdict", "ours [us]", "peer [us]"]
    return Ranking("Speed", headings, [_cells(row) for row in table.to_dict("records")])


def page(table: pd.DataFrame) -> str:
    """The table as a Markdown page with the versions of what was measured."""
    stamps = [name for name in map(str, table) if name.startswith("version_") and table[name].iloc[0]]
    named = ", ".join(f"{stamp.removeprefix('version_')} {table[stamp].iloc[0]}" for stamp in stamps)
    parts = ["# Speed\n", f"{EXPLANATION}\n", f"{counts(table)}. Made by `fo-gym bench` with {named}.\n"]
    return "\n".join([*parts, markdown(view(table))])


def write_bench(table: pd.DataFrame, out: Path) -> list[Path]:
    """Write bench.csv and bench.md into `out`; returns both."""
    out.mkdir(parents=True, exist_ok=True)
    texts = {"bench.csv": csv(table), "bench.md": page(table)}
    for name, text in texts.items():
        atomic(out / name, text)
    return [out / name for name in texts]
