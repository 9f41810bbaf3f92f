"""When the robot is pushed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fo_gym.checks import NOT_NEGATIVE, check_ranges
from fo_gym.hardware.effect import Drawn, Effect

__all__ = ["PushTime"]


@dataclass(frozen=True)
class PushTime(Effect):
    """The push comes at any time of a wide range. Origin: ours.

    Attributes:
        start: range of its start [s].
    """

    start: tuple[float, float]

    def __post_init__(self) -> None:
        check_ranges(self, start=NOT_NEGATIVE)

    def draw(self, dof: int, generator: np.random.Generator) -> Mapping[str, float]:
        """See Effect: when [s]."""
        return {"start": generator.uniform(*self.start)}

    def pushed_at(self, time: float | None, drawn: Drawn) -> float:
        """See Effect."""
        return float(drawn["start"])
