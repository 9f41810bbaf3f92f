"""The elasto-plastic law: a bristle that holds like a spring until it is bent far enough."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, Value
from fo_gym.friction.bristle import BristleLaw
from fo_gym.friction.law import Levels
from fo_gym.friction.lugre import LuGre, check_dry, dry_friction, steady_curve

Array = NDArray[np.float64]

__all__ = ["ElastoPlastic"]


def _rate(v: float, z: float, p: Any) -> float:
    if p.sigma_0 == 0.0 or v * z <= 0.0:
        return 0.0
    s = dry_friction(v, p)
    # Deflections as forces: where the bristle starts to slip, where it slips as fast as it is pulled, and its own.
    low, force = p.break_away * p.f_c, p.sigma_0 * abs(z)
    if force <= low:
        return 0.0
    plastic = 1.0 if force >= s else 0.5 * (1.0 + math.sin(math.pi * (force - 0.5 * (s + low)) / (s - low)))
    return p.sigma_0 * abs(v) / s * plastic


@dataclass(frozen=True, eq=False)
class ElastoPlastic(BristleLaw):
    """Elasto-plastic friction on the motor side (Dupont, Hayward, Armstrong, Altpeter 2002); v = theta'.

        z'    = v (1 - alpha sigma_0 z sgn(v) / s(v)),   s(v) = f_c + (f_s - f_c) exp(-(v/v_s)^2)
        tau_f = -(sigma_0 z + sigma_1 z' + sigma_2 v)

    alpha is 0 where sgn z != sgn v or |z| <= z_ba, 1 where |z| >= z_ss = s(v) / sigma_0, and between them
    1/2 (1 + sin(pi (|z| - (z_ss + z_ba)/2) / (z_ss - z_ba))). Up to z_ba the bristle is a spring: what vibrates below
    that holds, where LuGre drifts. With z_ba = 0 it still holds at first, and slips the sooner.

    Attributes:
        sigma_0: bristle stiffness [N/m | N m/rad], at least 0; 0 leaves only viscous friction.
        sigma_1: bristle damping [N s/m | N m s/rad], at least 0.
        sigma_2: viscous coefficient [N s/m | N m s/rad], at least 0.
        f_c: Coulomb friction [N | N m], at least 0, above 0 where sigma_0 is.
        f_s: stiction [N | N m], at least f_c.
        v_s: Stribeck velocity [m/s | rad/s], above 0.
        break_away: z_ba as a share of f_c / sigma_0, at least 0 and below 1.
    """

    levels: ClassVar[Levels] = Levels("f_c", "f_s", "v_s", "sigma_0", "sigma_1", "sigma_2")
    rate = staticmethod(_rate)

    sigma_0: Value
    sigma_1: Value
    sigma_2: Value
    f_c: Value
    f_s: Value
    v_s: Value
    break_away: Value = 0.7

    def __post_init__(self) -> None:
        check_dry(self, break_away=NOT_NEGATIVE)
        if np.any(np.asarray(self.break_away) >= 1.0):
            raise ValueError(
                f"ElastoPlastic.break_away is {self.break_away}; a bristle starts to slip below f_c: give less than 1"
            )

    def steady(self, v: Value) -> Array:
        """Friction torque tau_f at constant velocity v [m/s | rad/s], in N | N m; it opposes v."""
        return steady_curve(self, v)

    @classmethod
    def like(cls, lugre: LuGre, break_away: float = 0.7) -> ElastoPlastic:
        """The one with bristle and steady curve of `lugre`; its presliding is stiffer, up to `break_away` a spring."""
        return cls(**vars(lugre), break_away=break_away)
