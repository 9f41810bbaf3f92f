"""What was measured as a person reads it: tables for the terminal, and the files: CSV, a page and a figure."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fo_gym.bench.bars import (
    ACCURACY,
    BATCH,
    COMPENSATOR,
    GROWTH,
    HOLDS,
    MISSES,
    MORE_IS_BETTER,
    SINGLE,
    THREADS,
    THROUGHPUT,
    YARDSTICK,
)
from fo_gym.bench.figure import draw_growth
from fo_gym.bench.measurement import GROWTHS, JOB, MEMORY, PRECISION, RATIOS
from fo_gym.evaluation.results.tables import Ranking, markdown
from fo_gym.files import atomic, csv, read_csv

Results = Mapping[str, pd.DataFrame]
"""Tables by their names; those in which nothing was measured have no rows."""

EXPLANATION = (
    "Speed is told as ratios to named peers that are timed by turns in the same run: medians over the rounds, with "
    "their quartiles. us is microseconds per environment and control period. Ours is the whole step of the environment "
    "on one thread, unless it says otherwise. Bars are for a machine of two cores."
)
"""How to read all tables."""

KINDS = {
    BATCH: (
        "Batches beside MuJoCo",
        "Our time over the peer's, less is better. The MuJoCo twin is the same plant's bare physics, wholly in MuJoCo "
        "at steps of 100 us, without geoms, contacts and joint limits, in a batch of as many on one thread; it has no "
        "controller, no sensors and no scenario. MuJoCo forward is what our plant has MuJoCo compute in a period: "
        "inertia and bias of the links, once.",
    ),
    SINGLE: (
        "One environment",
        "The step of one environment as gymnasium.make gives it over the twin's bare physics; less is better.",
    ),
    ACCURACY: (
        "At equal accuracy",
        "How many times cheaper than a peer that errs as little as we do; more is better. Errors are largest distances "
        "of links and motors from SciPy's LSODA at rtol 1e-10 (rigid body by Pinocchio) over a few motions under "
        "sampled control at 1 kHz: the paper's observers on the link, random joints, gains and pushes on the arm. The "
        "twin's steps are those at which its error, tried at 1, 2, 4, ... steps a period and followed between them by "
        "its power, falls to ours; where none was fine enough, the row says so. Each of MuJoCo's integrators is a peer "
        "of its own: none of them is best everywhere. LSODA, on one environment beside one of ours, has the loosest "
        "of the tolerances 1e-3, 1e-4, ... whose error is at most ours. precision.csv has all errors.",
    ),
    THREADS: ("Threads", "How many times faster a batch is on more threads (two) than on one; more is better."),
    GROWTH: (
        "Growth",
        "The power with which a time grows from the first size to the last, by least squares over all sizes measured "
        "there: 1 is linear. Over environments: one batch's step. Over joints: the step of a batch of chains, links of "
        "0.2 m one on the other. Over threads: one batch's step, -1 is perfect. Over seconds: an evaluation of an "
        "observer on one episode of that length, with its references and metrics. ours and peer are the times at the "
        "last and at the first size. growth.csv has the points of the figure; dashed is linear.",
    ),
    THROUGHPUT: (
        "Throughput beside other vectors",
        "Our steps per second over the peer's, on the same randomized episodes; more is better. A process for each "
        "environment has Gymnasium's async and Stable-Baselines3's SubprocVecEnv; sync steps one after the other.",
    ),
    COMPENSATOR: (
        "A compensator's tick",
        "Time of the PID-type observer's `estimate` over that of the step of its environments: what it adds.",
    ),
    YARDSTICK: (
        "A yardstick",
        "One control period (1 ms) of one arm of seven joints over one physics step (10 ms) of Gymnasium's Pusher-v5, "
        "a rigid arm of seven joints with two things on a table: a fifth of its step.",
    ),
}
"""What the kinds of measurements are, in the order of the page: heading, and how to read it."""

_MEMORY = (
    "Memory",
    "By how much a fresh process grows per 1000 further environments, resident, and per 1000 twins in a batch of "
    "MuJoCo's [MB].",
)
_JOB = (
    "A whole job",
    "The small leaderboard (`fo-gym leaderboard --quick`) in one process, nothing from the store, and its parts: the "
    "references with their simulation and metrics; then of the competitors the simulation, their own calls, and their "
    "metrics; then the statistics (bootstrap) and what is drawn and written.",
)

__all__ = ["EXPLANATION", "KINDS", "Results", "counts", "page", "read_bench", "views", "write_bench", "write_page"]


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
        row["note"],
    ]


def _ratios(title: str, table: pd.DataFrame) -> Ranking:
    headings = ["env", "measured", "beside", "envs", "ratio", "quartiles", "bar", "verdict", "ours [us]", "peer [us]"]
    cells = [_cells(row) for row in table.to_dict("records")]
    if (table["note"] == "").all():
        return Ranking(title, headings, [row[:-1] for row in cells])
    return Ranking(title, [*headings, "note"], cells)


def _memory(table: pd.DataFrame) -> Ranking:
    cells = [
        [row["env"], _number(row["ours_mb"]), _number(row["twin_mb"]), row["note"]] for row in table.to_dict("records")
    ]
    return Ranking(_MEMORY[0], ["env", "ours [MB]", "twin [MB]", "note"], cells)


def _job(table: pd.DataFrame) -> Ranking:
    cells = [[row["part"], f"{row['seconds']:.1f}", f"{100 * row['share']:.0f} %"] for row in table.to_dict("records")]
    cells.append(["all", f"{table['seconds'].sum():.1f}", ""])
    return Ranking(_JOB[0], ["part", "time [s]", "share"], cells)


def views(results: Results) -> list[tuple[Ranking, str]]:
    """Every table that has rows, with how to read it, in the order of the page."""
    ratios = results[RATIOS]
    found = []
    for kind, (title, text) in KINDS.items():
        rows = ratios[ratios["measured"] == kind]
        if len(rows):
            found.append((_ratios(title, rows), text))
    others = ((MEMORY, _memory, _MEMORY[1]), (JOB, _job, _JOB[1]))
    return found + [(make(results[name]), text) for name, make, text in others if len(results[name])]


def page(results: Results) -> str:
    """The tables as a Markdown page with the versions of what was measured."""
    ratios = results[RATIOS]
    stamps = [name for name in map(str, ratios) if name.startswith("version_") and ratios[name].iloc[0]]
    named = ", ".join(f"{stamp.removeprefix('version_')} {ratios[stamp].iloc[0]}" for stamp in stamps)
    parts = ["# Speed\n", f"{EXPLANATION}\n", f"{counts(ratios)}. Made by `fo-gym bench` with {named}.\n"]
    for ranking, text in views(results):
        parts += [f"## {ranking.title}\n", f"{text}\n", markdown(ranking)]
        if ranking.title == KINDS[GROWTH][0]:
            parts.append("![times over what they grow with](growth.png)\n")
    return "\n".join(parts)


def read_bench(folder: Path) -> dict[str, pd.DataFrame]:
    """The tables that `write_bench` wrote; one that is not there has no rows."""
    found = {}
    for name in (RATIOS, GROWTHS, PRECISION, MEMORY, JOB):
        path = folder / f"{name}.csv"
        table = read_csv(path.read_text(encoding="utf-8")) if path.exists() else pd.DataFrame()
        words = [column for column in map(str, table) if column in ("verdict", "note") or column.startswith("version_")]
        found[name] = table.assign(**{each: table[each].astype(object).fillna("") for each in words})
    return found


def write_bench(results: Results, out: Path) -> list[Path]:
    """Write a CSV of every table that has rows, growth.png, and bench.md made of these files, into `out`.

    Returns:
        What was written.
    """
    out.mkdir(parents=True, exist_ok=True)
    paths = []
    for name, table in results.items():
        path = out / f"{name}.csv"
        path.unlink(missing_ok=True)  # of a run before, that measured more
        if len(table):
            atomic(path, csv(table))
            paths.append(path)
    if len(results[GROWTHS]):
        draw_growth(results[GROWTHS], out / "growth.png")
        paths.append(out / "growth.png")
    return [*paths, write_page(out)]


def write_page(folder: Path) -> Path:
    """Write bench.md of the tables in `folder`; returns it."""
    atomic(folder / "bench.md", page(read_bench(folder)))
    return folder / "bench.md"
