"""Statements that a run can judge: claims of the paper, and checks of the physics.

A statement is a function from what is under test to a `Finding`: a number, and the interval in which it must lie.
The verdict follows from these two; nobody writes it down.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from fo_gym.certificate.subject import Subject

Measure = Callable[[Subject], "Finding"]

__all__ = ["CHECKS", "Finding", "Measure", "Statement", "at_least", "at_most", "check", "near", "register"]


@dataclass(frozen=True)
class Finding:
    """What was measured.

    Attributes:
        number: the quantity that decides.
        unit: its unit, "" for a ratio.
        low, high: the statement holds where low <= number <= high.
        measured: what the number is, in words, with what else was seen.
    """

    number: float
    unit: str
    low: float
    high: float
    measured: str

    @property
    def holds(self) -> bool:
        """Whether the number lies in its interval; what is not finite does not."""
        return math.isfinite(self.number) and self.low <= self.number <= self.high


def at_most(number: float, limit: float, unit: str, measured: str) -> Finding:
    """It holds where number <= limit."""
    return Finding(float(number), unit, -math.inf, limit, measured)


def at_least(number: float, limit: float, unit: str, measured: str) -> Finding:
    """It holds where number >= limit."""
    return Finding(float(number), unit, limit, math.inf, measured)


def near(number: float, expected: float, relative: float, unit: str, measured: str) -> Finding:
    """It holds where the number is within a share `relative` of what is expected."""
    margin = relative * abs(expected)
    return Finding(float(number), unit, expected - margin, expected + margin, measured)


@dataclass(frozen=True)
class Statement:
    """Something that is said, and how it is measured.

    Attributes:
        id: its name in the table.
        source: who says so: a place in the paper, or what the plant is held against.
        text: the statement in our words.
        fails: why it does not hold, with a reference, where it is known not to; "" where it should hold.
        measure: from what is under test to what was found.
    """

    id: str
    source: str
    text: str
    fails: str
    measure: Measure

    @property
    def group(self) -> str:
        """Statements of a group share simulations and are measured in one process."""
        return self.measure.__module__


CHECKS: dict[str, Statement] = {}
"""Checks of the physics by id."""


def register(table: dict[str, Statement], id: str, source: str, text: str, fails: str) -> Callable[[Measure], Measure]:
    """Add the decorated measurement to a table. Raises ValueError where the id is taken."""

    def add(measure: Measure) -> Measure:
        if id in table:
            raise ValueError(f"two statements are called {id!r}")
        table[id] = Statement(id, source, text, fails, measure)
        return measure

    return add


def check(id: str, *, source: str, text: str) -> Callable[[Measure], Measure]:
    """Register a check of the physics; see `Statement`."""
    return register(CHECKS, id, source, text, "")
