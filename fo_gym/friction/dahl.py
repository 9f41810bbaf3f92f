"""Dahl's law: a bristle without stiction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, Value, check_values
from fo_gym.friction.bristle import BristleLaw
from fo_gym.friction.law import Levels
from fo_gym.friction.lugre import LuGre, check_slips

Array = NDArray[np.float64]

__all__ = ["Dahl"]


def _rate(v: float, z: float, p: Any) -> float:
    return p.sigma_0 * abs(v) / p.f_c if p.sigma_0 > 0.0 else 0.0


@dataclass(frozen=True, eq=False)
class Dahl(BristleLaw):
    """Dahl friction on the motor side (Dahl 1968); v = theta'. It has no stiction: nothing breaks away.

        z'    = v (1 - sigma_0 z sgn(v) / f_c)
        tau_f = -(sigma_0 z + sigma_1 z' + sigma_2 v)          Dahl's own has sigma_1 = sigma_2 = 0

    The exponent of 1 that Dahl gives to most materials; it is LuGre without the Stribeck effect.

    Attributes:
        sigma_0: bristle stiffness [N/m | N m/rad], at least 0; 0 leaves only viscous friction.
        f_c: Coulomb friction [N | N m], at least 0, above 0 where sigma_0 is.
        sigma_1: bristle damping [N s/m | N m s/rad], at least 0.
        sigma_2: viscous coefficient [N s/m | N m s/rad], at least 0.
    """

    levels: ClassVar[Levels] = Levels(coulomb="f_c", stiffness="sigma_0", damping="sigma_1", viscous="sigma_2")
    rate = staticmethod(_rate)

    sigma_0: Value
    f_c: Value
    sigma_1: Value = 0.0
    sigma_2: Value = 0.0

    def __post_init__(self) -> None:
        check_values(self, **dict.fromkeys(("sigma_0", "sigma_1", "sigma_2", "f_c"), NOT_NEGATIVE))
        check_slips(self)

    def steady(self, v: Value) -> Array:
        """Friction torque tau_f at constant velocity v [m/s | rad/s], in N | N m; it opposes v."""
        dry = np.sign(v) * self.f_c * (np.asarray(self.sigma_0) > 0)
        return np.asarray(-(dry + self.sigma_2 * np.asarray(v)))

    @classmethod
    def like(cls, lugre: LuGre) -> Dahl:
        """The one with LuGre's bristle and, well above its v_s, its steady curve; the law has no stiction."""
        return cls(lugre.sigma_0, lugre.f_c, lugre.sigma_1, lugre.sigma_2)
