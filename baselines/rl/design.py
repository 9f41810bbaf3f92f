"""What a learned compensator is made of, apart from its weights."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Design"]


@dataclass(frozen=True)
class Design:
    """An observer, the policy's rate and its bound. Frozen; what is out of range is refused.

    Attributes:
        residual: whether the policy's action is added to the observer, or stands alone.
        L, Lp, Li: gains of the PID-type observer [1/s], [1/s], [1/s^2]; without `residual` they only scale inputs.
        period: time between two actions of the policy [s]; the observer runs at the control rate.
        bound: largest action, as a share of the friction scale (see `PolicyLoop`).
        floor: friction scale at the start of an episode, as a share of the joint's torque limit.
    """

    residual: bool = True
    L: float = 100.0
    Lp: float = 20.0
    Li: float = 100.0
    period: float = 2e-3
    bound: float = 1.0
    floor: float = 0.02

    def __post_init__(self) -> None:
        if not isinstance(self.residual, bool):
            raise ValueError(f"Design.residual is {self.residual!r}; it must be True or False")
        for name in ("L", "Lp", "Li", "period", "bound", "floor"):
            value = getattr(self, name)
            if not (isinstance(value, int | float) and np.isfinite(value) and value > 0):
                raise ValueError(f"Design.{name} is {value!r}; it must be a finite number above 0")
