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

    Origin: in an industrial robot's joint friction changes much from 30 to 80 degrees, viscous friction falling most
    (Bittencourt et al., IROS 2010), and in strain-wave gears from 24 to 50 degrees (Wolf and Iskandar, ICRA 2018). The
    shares are ours: over 30 K dry friction falls by a quarter, viscous friction by 60 %. So is how fast a joint warms
    up, in tens of minutes; an episode is short beside that, and is met cold or warm.

    Attributes:
        start: range of T_0 [K].
        rise: [K], at least 0.
        time: of warming up [s], above 0.
        dry, viscous: [1/K], at least 0.
    """

    start: tuple[float, float] = (0.0, 30.0)
    rise: float = 20.0
    time: float = 1800.0
    dry: float = 0.01
    viscous: float = 0.03

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
