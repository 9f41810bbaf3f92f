"""Write what a reproduction found: two tables, as CSV and as pages."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from fo_gym.files import atomic, csv
from fo_gym.reproduction.figures import FIGURES
from fo_gym.reproduction.run import Reproduction
from fo_gym.reproduction.wording import FAILS, HOLDS, number, tolerance
from fo_gym.text import markdown_code, markdown_table, markdown_text

PLACES = {"claims": "paper/claims", "fidelity": "fidelity"}
"""Where each table goes, without its ending."""

_INTRODUCTION = {
    "claims": "# What the paper says, measured\n\n"
    "Every row is a statement of arXiv:1907.00553 (Kim, Beck, Ott, Albu-Schäffer) in our words, and what it comes to "
    "on our plant. It holds where the number lies within the tolerance. Where one does not hold, the reason stands "
    "below the table. The arm's rows are about our arm, not about the paper's robot.\n",
    "fidelity": "# Certificate of the physics\n\n"
    "Every row holds the plant against something that is not the plant: a stiff solver on the written-out equations, "
    "Pinocchio's rigid body, MuJoCo's own LuGre friction, known experiments, the balance of energy. It holds where "
    "the number lies within the tolerance.\n",
}

__all__ = ["PLACES", "counts", "page", "write_reproduction"]


def counts(table: pd.DataFrame) -> str:
    """How many rows hold, in words."""
    held = int((table["verdict"] == HOLDS).sum())
    rest = len(table) - held
    return f"{len(table)} statements: {held} hold, {rest} {'does' if rest == 1 else 'do'} not"


def page(name: str, table: pd.DataFrame, figures: Iterable[str] = (), *, quick: bool = False) -> str:
    """One table as a Markdown page, with the reasons of what does not hold; on the claims' page the named figures."""
    cells = [
        [
            markdown_code(row["id"]),
            *(markdown_text(row[column]) for column in ("source", "statement", "measured")),
            markdown_text(number(row["number"], row["unit"])),
            tolerance(row["low"], row["high"]),
            row["verdict"] if row["verdict"] == HOLDS else f"**{row['verdict']}**",
        ]
        for row in table.to_dict("records")
    ]
    headings = ["id", "source", "statement", "what the number is", "number", "tolerance", "verdict"]
    failed = table[(table["verdict"] == FAILS) & (table["explanation"] != "")]
    reasons = [f"* `{row['id']}`: {row['explanation']}" for row in failed.to_dict("records")]
    stamps = [column for column in map(str, table) if column.startswith("version_")]
    parts = [
        _INTRODUCTION[name],
        f"{counts(table)}. Made by `fo-gym reproduce{' --quick' if quick else ''}` with "
        + ", ".join(f"{stamp.removeprefix('version_')} {table[stamp].iloc[0]}" for stamp in stamps)
        + ".\n",
        markdown_table(headings, cells),
    ]
    if reasons:
        parts += ["## Why these do not hold\n", "\n".join(reasons) + "\n"]
    if name == "claims":
        shown = {stem: FIGURES[stem] for stem in figures}
        parts += [
            f"## {spec.title}\n\n![{stem}](figures/{stem}.png)\n\n{spec.caption}\n" for stem, spec in shown.items()
        ]
    return "\n".join(parts)


def write_reproduction(reproduction: Reproduction, out: Path) -> list[Path]:
    """Write the tables into `out` as leaderboard/paper/claims and leaderboard/fidelity are; returns all files."""
    paths = []
    # Those of an earlier run, too, where this one draws none.
    shown = [name for name in FIGURES if (out / "paper" / "figures" / f"{name}.png").is_file()]
    for name, table in reproduction.tables.items():
        stem = out / PLACES[name]
        stem.parent.mkdir(parents=True, exist_ok=True)
        for ending, text in (
            (".csv", csv(table)),
            (".md", page(name, table, shown, quick=reproduction.quick)),
        ):
            paths.append(stem.with_name(stem.name + ending))
            atomic(paths[-1], text)
    return [*paths, *(path for drawn in reproduction.figures.values() for path in drawn)]
