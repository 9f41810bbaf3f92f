"""Friction of joints that warm up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import FINITE, NOT_NEGATIVE, POSITIVE, check_numbers, check_ranges
from fo_gym.hardware.effect import Effect, Episodes, FrictionChange

__all__ = ["Temperature"]


@dataclass(frozen=True)
class Temperature(Effect):
    """Friction falls as the joint warms up: f_c, f_s by exp(-dry T), sigma_2 by exp(-viscous T).

    T(t) = T_0 + rise (1 - exp(-t / time)) above the temperature at which friction was identified; T_0 per episode.

    Origin: ours; that lubricants thin out as they warm is common knowledge, and viscous friction falls most.

    Attributes:
        start: range of T_0 [K].
        rise: [K], at least 0.
        time: of warming up [s], above 0.
        dry, viscous: [1/K], at least 0.
    """

    start: tuple[float, float] = (0.0, 20.0)
    rise: float = 5.0
    time: float = 10.0
    dry: float = 0.005
    viscous: float = 0.02

    def __post_init__(self) -> None:
        check_numbers(self, rise=NOT_NEGATIVE, time=POSITIVE, dry=NOT_NEGATIVE, viscous=NOT_NEGATIVE)
        check_ranges(self, start=FINITE)

    def draw(self, dof: int, generator: np.random.Generator) -> Mapping[str, NDArray[np.float64]]:
        """See Effect: T_0 [K]."""
        return {"start": generator.uniform(*self.start, dof)}

    def friction(self, episodes: Episodes) -> FrictionChange:
        """See Effect."""
        temperature = episodes.drawn["start"] + self.rise * -np.expm1(-episodes.time / self.time)
        return FrictionChange(dry=np.exp(-self.dry * temperature), viscous=np.exp(-self.viscous * temperature))
