"""A published row beside the same row computed now: which cells differ, by how much, and what follows from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.runs.provenance import is_provenance
from fo_gym.evaluation.runs.twins import spread

Verdict = Literal["same to the byte", "within tolerance", "chaotic", "of other versions", "mismatch"]

SAME: Verdict = "same to the byte"
WITHIN: Verdict = "within tolerance"
"""Computed on another kind of processor, and no metric differs by more than its tolerance."""
CHAOTIC: Verdict = "chaotic"
"""The same, but for metrics in which perturbed twins of the episode differ as much."""
OTHER: Verdict = "of other versions"
"""It differs, and other versions or another competitor computed it."""
MISMATCH: Verdict = "mismatch"
VERDICTS = (SAME, WITHIN, CHAOTIC, OTHER, MISMATCH)

_MADE_OF = ("competitor_hash", "version_")

Row = Mapping[str, str]

__all__ = ["CHAOTIC", "MISMATCH", "OTHER", "SAME", "VERDICTS", "WITHIN", "Comparison", "Difference", "Row", "compared"]


@dataclass(frozen=True)
class Difference:
    """A cell that is not the same text.

    Attributes:
        column: its column.
        published, now: its two texts; None where there is no such column.
    """

    column: str
    published: str | None
    now: str | None

    def __str__(self) -> str:
        return f"{self.column}: {_shown(self.published)} published, {_shown(self.now)} now"

    @property
    def size(self) -> float:
        """How far the two numbers are apart; NaN where one of them is none."""
        return abs(_number(self.published or "") - _number(self.now or ""))

    def tolerable(self, variant: str) -> bool:
        """Whether it is within the tolerance of its metric; what is no metric has none."""
        if self.column not in METRICS or self.published is None or self.now is None:
            return False
        return METRICS[self.column].tolerance.holds(_number(self.published), _number(self.now), variant)

    def of_twins(self, twins: Sequence[Row], variant: str) -> bool:
        """Whether the published value may be that of one more twin of the episode."""
        if self.published is None or self.now is None or not twins:
            return False
        if self.column not in METRICS:
            return _kind(self.published) in {_kind(twin[self.column]) for twin in twins}
        value = _number(self.published)
        around = spread([_number(self.now), *(_number(twin[self.column]) for twin in twins)])
        return around.holds(value, METRICS[self.column].tolerance.of(value, variant))


@dataclass(frozen=True)
class Comparison:
    """A published row beside the same row computed now.

    Attributes:
        row: env, robot, variant, compensator and seed.
        differences: the cells that differ.
        versions: the same for the versions and the competitor's hash.
        processors: that of the published row, "" where it is not known, and that of here.
        twins: the row of every perturbed twin of the episode, where they were run.
    """

    row: tuple[str, ...]
    differences: tuple[Difference, ...]
    versions: tuple[Difference, ...] = ()
    processors: tuple[str, str] = ("", "")
    twins: tuple[Row, ...] = field(default=(), repr=False)

    @property
    def variant(self) -> str:
        """The variant that the row is of."""
        return self.row[2]

    @property
    def elsewhere(self) -> bool:
        """Whether the row was published on another kind of processor, or it is not known on which."""
        published, here = self.processors
        return published != here or not published

    @property
    def beyond(self) -> tuple[Difference, ...]:
        """The differences that are too large: all of them on the same kind of processor."""
        return tuple(each for each in self.differences if not (self.elsewhere and each.tolerable(self.variant)))

    @property
    def verdict(self) -> Verdict:
        """One of `VERDICTS`. Other versions or processors that give the same text are the same."""
        if not self.differences:
            return SAME
        if self.versions:
            return OTHER
        if not self.beyond:
            return WITHIN
        explained = self.elsewhere and all(each.of_twins(self.twins, self.variant) for each in self.beyond)
        return CHAOTIC if explained else MISMATCH

    @property
    def asks_for_twins(self) -> bool:
        """Whether perturbed twins of the episode may explain what is beyond tolerance."""
        return self.elsewhere and self.verdict == MISMATCH and not self.twins

    def beside(self, twins: Sequence[Row]) -> Comparison:
        """The same beside twins of the episode."""
        return replace(self, twins=tuple(twins))


def compared(row: tuple[str, ...], published: Row, now: Row) -> Comparison:
    """Compare a row cell by cell."""
    columns = dict.fromkeys([*published, *now])
    told = [Difference(name, published.get(name), now.get(name)) for name in columns]
    told = [each for each in told if each.published != each.now]
    return Comparison(
        row=row,
        differences=tuple(each for each in told if not is_provenance(each.column)),
        versions=tuple(each for each in told if each.column.startswith(_MADE_OF)),
        processors=(published.get("processor", ""), now.get("processor", "")),
    )


def _number(text: str) -> float:
    """The number in a cell; what is none, as an empty cell is, counts as NaN."""
    try:
        return float(text)
    except ValueError:
        return float("nan")


def _kind(text: str) -> str:
    """A status, or the kind of an early end without its time."""
    return text.partition(" at ")[0]


def _shown(text: str | None) -> str:
    return "no such column" if text is None else text or "empty"
