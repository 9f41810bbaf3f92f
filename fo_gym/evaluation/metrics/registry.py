"""How a function from an episode to a number becomes a metric, that is a column of the results."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from fo_gym.evaluation.episode.record import Episode

Better = Literal["lower", "higher"]

UNIT_ENDINGS = {
    "ju": "_ju",
    "mm": "_mm",
    "s": "_s",
    "ms": "_ms",
    "%": "_percent",
    "J": "_j",
    "N": "_n",
    "Hz": "_hz",
    "events": "_count",
    "1": "_ratio",
}
"""Units that a metric may have, with the ending of its column name: "ju" = joint unit, m or rad; "1" = none."""

HEADLINE = "frr"
"""The one name without a unit's ending: the friction rejection ratio."""


ROUNDING = 2e-5
"""Share of a value by which its text may differ: two units in the last of six digits."""


@dataclass(frozen=True)
class Tolerance:
    """How far the value of an episode that is not chaotic may differ between processors.

    |one - other| <= a + ROUNDING |one|, where a has two values: with exact sensors a last bit stays one, but where they
    quantise it may turn an encoder's step into the next one. See docs/processors.md, where the numbers are from.

    Attributes:
        exact: a in the variants with exact sensors, in the metric's unit.
        hardware: a in the variant "hardware".
    """

    exact: float
    hardware: float

    def of(self, published: float, variant: str) -> float:
        """The difference that is allowed from a value."""
        return (self.hardware if variant == "hardware" else self.exact) + ROUNDING * abs(published)

    def holds(self, published: float, now: float, variant: str) -> bool:
        """Whether two values of an episode are the same within this; NaN is the same as NaN alone."""
        if math.isnan(published) or math.isnan(now):
            return math.isnan(published) and math.isnan(now)
        return abs(published - now) <= self.of(published, variant)


@dataclass(frozen=True)
class Metric:
    """One column of the results.

    Attributes:
        name: column name; it ends with its unit (`UNIT_ENDINGS`).
        unit: a key of `UNIT_ENDINGS`.
        better: whether "lower" or "higher" values are better.
        description: one line, the first of the function's docstring.
        tolerance: how far the value of an episode may differ between processors.
        function: the metric itself; NaN where it does not apply.
        share: whether it is 1 or 0 in an episode, so that a row says the share of its episodes, their mean; of other
            metrics a row says the interquartile mean.
        where: name of a metric of the former kind; a row counts only the episodes in which that one is 1. "" for all.
    """

    name: str
    unit: str
    better: Better
    description: str
    tolerance: Tolerance
    function: Callable[[Episode], float]
    share: bool = False
    where: str = ""

    def __post_init__(self) -> None:
        if self.unit not in UNIT_ENDINGS:
            raise ValueError(f"metric {self.name!r} has unit {self.unit!r}; use one of {sorted(UNIT_ENDINGS)}")
        if self.better not in ("lower", "higher"):
            raise ValueError(f"metric {self.name!r} has better={self.better!r}; use 'lower' or 'higher'")
        ending = UNIT_ENDINGS[self.unit]
        if self.name != HEADLINE and not self.name.endswith(ending):
            raise ValueError(f"metric {self.name!r} is in {self.unit!r}; its name must end in {ending!r}")

    @property
    def unit_text(self) -> str:
        """The unit for readers, who need not know what "ju" is."""
        return {"ju": "m or rad", "1": "no unit"}.get(self.unit, self.unit)


_registered: dict[str, Metric] = {}


def metric(
    name: str, *, unit: str, better: Better, tolerance: Tolerance, share: bool = False, where: str = ""
) -> Callable[[Callable[[Episode], float]], Callable[[Episode], float]]:
    """Register the decorated function as the metric `name`; its docstring's first line describes it.

    Args:
        name: column name, ending with its unit.
        unit: a key of `UNIT_ENDINGS`.
        better: "lower" or "higher".
        tolerance: how far the value of an episode may differ between processors.
        share: whether it is 1 or 0 in an episode, and a row says in which share of its episodes it is 1.
        where: name of such a metric; a row counts only the episodes in which that one is 1. "" for all.

    Raises:
        ValueError: for a name that is taken or does not end with its unit, or an unknown unit or direction.
    """

    def register(function: Callable[[Episode], float]) -> Callable[[Episode], float]:
        if name in _registered:
            raise ValueError(f"metric {name!r} exists already, in {_registered[name].function.__module__}")
        description = (function.__doc__ or "").strip().partition("\n")[0]
        _registered[name] = Metric(name, unit, better, description, tolerance, function, share, where)
        return function

    return register


def metrics_of(module: str) -> list[Metric]:
    """Metrics that the module of this full name registered, in the order of its source."""
    return [each for each in _registered.values() if each.function.__module__ == module]
