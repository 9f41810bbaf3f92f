"""Measure statements and draw figures, in parallel; one row per statement."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pinocchio
from joblib import Parallel, delayed

from fo_gym.certificate.fidelity import CHECKS
from fo_gym.certificate.statement import Finding, Statement
from fo_gym.certificate.subject import Subject
from fo_gym.evaluation.runs.provenance import versions
from fo_gym.reproduction.claims import CLAIMS
from fo_gym.reproduction.figures import FIGURES, draw
from fo_gym.reproduction.wording import FAILS, HOLDS, NOT_MEASURED

TABLES = {"claims": CLAIMS, "fidelity": CHECKS}
"""The two tables by name."""

PARTS = ("claims", "fidelity", "figures")
"""What a reproduction consists of."""

# What shares simulations is run in one process: the long runs of the simulation, and those of the arm.
_SHARED = {
    "panels": ("panels", "rest", "stiction", "simulation", "motivating"),
    "arm": ("arm_rest", "regulation", "square"),
}

_Result = Finding | list[Path] | str
"""What an item yields: a finding, the files of a figure, or the error that kept it from either."""

__all__ = ["PARTS", "TABLES", "Reproduction", "reproduce", "size", "surprises"]


@dataclass(frozen=True)
class Reproduction:
    """What was found.

    Attributes:
        tables: by name ("claims", "fidelity"), one row per statement.
        figures: by name, the files that were drawn.
        errors: by name, why a figure was not drawn.
        quick: whether fewer random cases were run than are published.
    """

    tables: dict[str, pd.DataFrame]
    figures: dict[str, list[Path]]
    errors: dict[str, str]
    quick: bool


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

    def do(self, subject: Subject, folder: Path) -> _Result:
        """Measure, or draw into `folder`; what goes wrong comes back as its error."""
        try:
            if self.part == "figures":
                return draw(self.name, subject, folder)
            return TABLES[self.part][self.name].measure(subject)
        except Exception as error:
            return f"{type(error).__name__}: {error}"


def _do_unit(items: list[_Item], subject: Subject, folder: Path) -> list[_Result]:
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


def _row(statement: Statement, result: _Result) -> dict[str, object]:
    assert not isinstance(result, list)
    found = Finding(np.nan, "", -np.inf, np.inf, result) if isinstance(result, str) else result
    verdict = NOT_MEASURED if isinstance(result, str) else HOLDS if found.holds else FAILS
    return {
        "id": statement.id,
        "source": statement.source,
        "statement": statement.text,
        "measured": found.measured,
        "number": found.number,
        "unit": found.unit,
        "low": found.low if np.isfinite(found.low) else np.nan,
        "high": found.high if np.isfinite(found.high) else np.nan,
        "verdict": verdict,
        "explanation": statement.fails if verdict == FAILS else "",
        **versions(),
        "version_pin": pinocchio.__version__,
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

    Raises:
        ValueError: there is no such part.
    """
    parts = tuple(parts)
    if unknown := set(parts) - set(PARTS):
        raise ValueError(f"unknown parts {sorted(unknown)}; allowed are {', '.join(map(repr, PARTS))}")
    units = _units(parts)
    found: dict[_Item, _Result] = {}
    for (unit, items), results in zip(units.items(), _results(units, subject, folder, jobs), strict=True):
        found |= dict(zip(items, results, strict=True))
        on_unit(unit, len(items))
    tables = {
        part: pd.DataFrame([_row(statement, found[_Item(part, name)]) for name, statement in table.items()])
        for part, table in TABLES.items()
        if part in parts
    }
    drawn = {name: found[_Item("figures", name)] for name in FIGURES if "figures" in parts}
    return Reproduction(
        tables,
        figures={name: paths for name, paths in drawn.items() if isinstance(paths, list)},
        errors={name: error for name, error in drawn.items() if isinstance(error, str)},
        quick=subject.quick,
    )


def _results(units: dict[str, list[_Item]], subject: Subject, folder: Path, jobs: int) -> Iterator[list[_Result]]:
    # Threads inside a worker would fight the other workers for the cores.
    parallel = Parallel(n_jobs=jobs, return_as="generator", inner_max_num_threads=1 if jobs != 1 else None)
    yield from parallel(delayed(_do_unit)(items, subject, folder) for items in units.values())


def size(parts: Iterable[str]) -> int:
    """How many items the named parts consist of."""
    return sum(len(items) for items in _units(tuple(parts)).values())


def surprises(reproduction: Reproduction) -> list[str]:
    """What is not as it is known to be: statements with another verdict, by id, and figures that were not drawn.

    It is the alarm of a release that changes something.
    """
    changed = [
        str(row.id)
        for name, table in reproduction.tables.items()
        for row in table.itertuples()
        if row.verdict != (FAILS if TABLES[name][str(row.id)].fails else HOLDS)
    ]
    return [*changed, *reproduction.errors]
