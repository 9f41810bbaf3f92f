"""Friction of loaded gears."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fo_gym.checks import NOT_NEGATIVE, check_numbers
from fo_gym.hardware.effect import Effect, Episodes, FrictionChange

__all__ = ["LoadFriction"]


@dataclass(frozen=True)
class LoadFriction(Effect):
    """Dry friction grows with what the gear carries: f_c and f_s plus gain |tau_j|.

    Origin: load terms of 0.063 and 0.166 identified on two servo joints (Rhoban BAM, arXiv:2410.08650).

    Attributes:
        gain: [1], at least 0.
    """

    gain: float

    def __post_init__(self) -> None:
        check_numbers(self, gain=NOT_NEGATIVE)

    def friction(self, episodes: Episodes) -> FrictionChange:
        """See Effect."""
        return FrictionChange(added=self.gain * np.abs(episodes.truth.tau_j))
