"""Measure statements and draw figures, in parallel; one row per statement."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pandas as pd
from joblib import Parallel, delayed

from fo_gym.evaluation.provenance import versions
from fo_gym.reproduction.claims import CLAIMS
from fo_gym.reproduction.fidelity import CHECKS
from fo_gym.reproduction.figures import FIGURES, draw
from fo_gym.reproduction.statement import Finding, Statement
from fo_gym.reproduction.subject import Subject

TABLES = {"claims": CLAIMS, "fidelity": CHECKS}
"""The two tables by name."""

PARTS = ("claims", "fidelity", "figures")
"""What a reproduction consists of."""

HOLDS, FAILS = "holds", "fails"

# What shares simulations is run in one process: the long runs of the simulation, and those of the arm.
_SHARED = {
    "panels": ("panels", "rest", "stiction", "simulation", "motivating"),
    "arm": ("experiments", "regulation", "square"),
}

__all__ = ["FAILS", "HOLDS", "PARTS", "TABLES", "Reproduction", "reproduce", "size", "surprises"]


@dataclass(frozen=True)
class Reproduction:
    """What was found.

    Attributes:
        tables: by name ("claims", "fidelity"), one row per statement.
        figures: the files that were drawn.
    """

    tables: dict[str, pd.DataFrame]
    figures: list[Path]


@dataclass(frozen=True)
class _Item:
    """Something to do: a statement of a table, or a figure."""

    part: str
    name: str

    @property
    def unit(self) -> str:
        """Items of a unit run one after the other in one process."""
        stem = self.name if self.part == "figures" else TABLES[self.part][self.name].group.rpartition(".")[2]
        if self.part == "fidelity":
            return f"fidelity {stem}"
        return next((unit for unit, stems in _SHARED.items() if stem in stems), stem)

    def do(self, subject: Subject, folder: Path) -> Finding | list[Path]:
        """Measure, or draw into `folder`. What goes wrong in a measurement becomes a finding that does not hold."""
        if self.part == "figures":
            return draw(self.name, subject, folder)
        try:
            return TABLES[self.part][self.name].measure(subject)
        except Exception as error:
            return Finding(np.nan, "", -np.inf, np.inf, f"not measured: {type(error).__name__}: {error}")


def _do_unit(items: list[_Item], subject: Subject, folder: Path) -> list[Finding | list[Path]]:
    return [item.do(subject, folder) for item in items]


def _units(parts: Iterable[str]) -> dict[str, list[_Item]]:
    """Everything that the parts consist of, by unit; the long units first."""
    items = [_Item(part, name) for part in parts if part in TABLES for name in TABLES[part]]
    items += [_Item("figures", name) for name in FIGURES if "figures" in parts]
    units: dict[str, list[_Item]] = {}
    for item in items:
        units.setdefault(item.unit, []).append(item)
    first = ("panels", "lowpass", "passivity")
    order = [name for name in first if name in units] + [name for name in units if name not in first]
    return {name: units[name] for name in order}


def _row(statement: Statement, finding: Finding) -> dict[str, object]:
    return {
        "id": statement.id,
        "source": statement.source,
        "statement": statement.text,
        "measured": finding.measured,
        "number": finding.number,
        "unit": finding.unit,
        "low": finding.low if np.isfinite(finding.low) else np.nan,
        "high": finding.high if np.isfinite(finding.high) else np.nan,
        "verdict": HOLDS if finding.holds else FAILS,
        "explanation": "" if finding.holds else statement.fails,
        **versions(),
        "version_pin": version("pin"),
    }


def reproduce(
    parts: Iterable[str], subject: Subject, folder: Path, *, jobs: int = 1, on_unit: Callable[[str, int], None]
) -> Reproduction:
    """Do everything that the named parts consist of.

    Args:
        parts: of PARTS.
        subject: what is put to the test.
        folder: where figures go.
        jobs: worker processes; -1 = one per core. The numbers do not depend on it.
        on_unit: called with a name and the number of items done whenever some are.
    """
    units = _units(tuple(parts))
    found: dict[_Item, Finding | list[Path]] = {}
    for (unit, items), results in zip(units.items(), _results(units, subject, folder, jobs), strict=True):
        found |= dict(zip(items, results, strict=True))
        on_unit(unit, len(items))
    tables = {
        part: pd.DataFrame([_row(statement, _finding(found[_Item(part, name)])) for name, statement in table.items()])
        for part, table in TABLES.items()
        if any(item.part == part for item in found)
    }
    drawn = [found[_Item("figures", name)] for name in FIGURES if _Item("figures", name) in found]
    return Reproduction(tables, [path for paths in drawn if isinstance(paths, list) for path in paths])


def _results(
    units: dict[str, list[_Item]], subject: Subject, folder: Path, jobs: int
) -> Iterator[list[Finding | list[Path]]]:
    # Threads inside a worker would fight the other workers for the cores.
    parallel = Parallel(n_jobs=jobs, return_as="generator", inner_max_num_threads=1 if jobs != 1 else None)
    yield from parallel(delayed(_do_unit)(items, subject, folder) for items in units.values())


def _finding(result: Finding | list[Path]) -> Finding:
    assert isinstance(result, Finding)
    return result


def size(parts: Iterable[str]) -> int:
    """How many items the named parts consist of."""
    return sum(len(items) for items in _units(tuple(parts)).values())


def surprises(reproduction: Reproduction) -> list[str]:
    """Statements, by id, whose verdict is not the one that is known: the alarm of a release that changes something."""
    return [
        str(row.id)
        for name, table in reproduction.tables.items()
        for row in table.itertuples()
        if (row.verdict == FAILS) != bool(TABLES[name][str(row.id)].fails)
    ]
