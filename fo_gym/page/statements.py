"""The paper's claims and the certificate of the physics, as the page shows them: what does not hold comes first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from fo_gym.files import read_csv
from fo_gym.reproduction.wording import HOLDS, number, tolerance

_TITLES = {
    "claims": (
        "paper/claims.csv",
        "What the paper says, measured",
        "Statements of arXiv:1907.00553 (Kim, Beck, Ott, Albu-Schäffer) in our words, and what each comes to on our "
        "plant.",
    ),
    "certificate": (
        "fidelity.csv",
        "Certificate of the physics",
        "The plant held against what is not the plant: stiff solvers on the written-out equations, another rigid-body "
        "library, MuJoCo's own friction, published experiments, the balance of energy.",
    ),
}

__all__ = ["Statement", "Statements", "statements_in"]


@dataclass(frozen=True)
class Statement:
    """One statement, all as text: what is said, by how much, what was asked, what the number is, and why it fails."""

    statement: str
    verdict: str
    number: str
    tolerance: str
    measured: str
    explanation: str


@dataclass(frozen=True)
class Statements:
    """A section of statements.

    Attributes:
        id, title, introduction: of the section.
        rows: all of them.
        parts: heading, rows, and whether it is open at first.
    """

    id: str
    title: str
    introduction: str
    rows: tuple[Statement, ...]
    parts: tuple[tuple[str, tuple[Statement, ...], bool], ...]

    @property
    def held(self) -> int:
        """How many hold."""
        return sum(row.verdict == HOLDS for row in self.rows)

    @property
    def percent(self) -> float:
        """How many that is of a hundred."""
        return round(100.0 * self.held / len(self.rows), 1)


def statements_in(folder: Path) -> Iterator[Statements]:
    """The sections whose tables a folder of results has."""
    for name, (file, title, introduction) in _TITLES.items():
        path = folder / file
        if path.is_file():
            yield _section(name, title, introduction, read_csv(path.read_text(encoding="utf-8")))


def _section(name: str, title: str, introduction: str, table: pd.DataFrame) -> Statements:
    rows = tuple(
        Statement(
            statement=str(row["statement"]),
            verdict=str(row["verdict"]),
            number=number(row["number"], _text(row["unit"])),
            tolerance=tolerance(row["low"], row["high"]),
            measured=_text(row["measured"]),
            explanation=_text(row["explanation"]),
        )
        for row in table.to_dict("records")
    )
    failed = tuple(row for row in rows if row.verdict != HOLDS)
    held = tuple(row for row in rows if row.verdict == HOLDS)
    parts = [("What does not hold", failed, True), ("What holds", held, False)]
    return Statements(name, title, introduction, rows, tuple(part for part in parts if part[1]))


def _text(value: Any) -> str:
    return "" if pd.isna(value) else str(value)
