"""What the adaptive compensator is made of, apart from its weights."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

__all__ = ["AdaptiveDesign"]


@dataclass(frozen=True)
class AdaptiveDesign:
    """An observer, and how what is not friction is learned. Frozen; what is out of range is refused.

    Attributes:
        L, Lp, Li: gains of the PID-type observer [1/s], [1/s], [1/s^2].
        period: of the blocks that are learned from [s]: readings are averaged over it.
        longest_delay: of commands, up to which delays are looked for; itself it is not [s].
        largest_zero: bound of the estimated zero of the torque sensor, as a share of the torque limit.
        largest_error: bound of the estimated error of the motor inertia, as a share of it.
    """

    L: float = 220.0
    Lp: float = 60.0
    Li: float = 200.0
    period: float = 1e-2
    longest_delay: float = 8e-3
    largest_zero: float = 0.02
    largest_error: float = 0.18

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (isinstance(value, int | float) and np.isfinite(value) and value > 0):
                raise ValueError(f"AdaptiveDesign.{name} is {value!r}; it must be a finite number above 0")

    def delays(self, control_dt: float) -> int:
        """How many delays of commands are told apart: 0, 1, ... control periods."""
        return ceil(self.longest_delay / control_dt - 1e-9)
