"""LuGre: friction of a bristle that slips the sooner the faster it is pulled."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, Bound, Value, check_values
from fo_gym.friction.bristle import BristleLaw, bristle_response
from fo_gym.friction.law import Levels

Array = NDArray[np.float64]

__all__ = ["FRICTIONLESS", "LuGre", "bristle_rate", "check_dry", "check_slips", "dry_friction", "steady_curve"]


def dry_friction(v: float, p: Any) -> float:
    """Dry friction at velocity v, g(v) = f_c + (f_s - f_c) exp(-(v/v_s)^2) [N | N m]; compiled with the kernel."""
    s = v / p.v_s
    if s * s > 700.0:
        return p.f_c  # to the bit; an exp that underflows takes ten times as long
    return p.f_c + (p.f_s - p.f_c) * math.exp(-s * s)


def bristle_rate(v: float, p: Any) -> float:
    """Give a = sigma_0 |v| / g(v) [1/s], the rate at which LuGre's bristle forgets its deflection at velocity v."""
    if p.sigma_0 == 0.0:
        return 0.0
    return p.sigma_0 * abs(v) / dry_friction(v, p)


def _rate(v: float, z: float, p: Any) -> float:
    return bristle_rate(v, p)


def _respond(v: float, z: Array, h: float, p: Any, memory: Array) -> tuple[float, float]:
    memory[0] = bristle_rate(v, p)
    return bristle_response(memory[0], z[0], h, p)


def steady_curve(law: Any, v: Value) -> Array:
    """The steady tau_f at velocity v, -(sign(v) g(v) + sigma_2 v) [N | N m], of a law with these parameters."""
    g = law.f_c + (law.f_s - law.f_c) * np.exp(-np.square(v / law.v_s))
    return np.asarray(-(np.sign(v) * g * (np.asarray(law.sigma_0) > 0) + law.sigma_2 * np.asarray(v)))


def check_dry(law: Any, **others: Bound) -> None:
    """Check the parameters of a law with a Stribeck curve, and those that it has beside them.

    Raises:
        ValueError: one is out of bounds, stiction is below Coulomb friction, or a bristle has none to slip at.
    """
    not_negative = dict.fromkeys(("sigma_0", "sigma_1", "sigma_2", "f_c", "f_s"), NOT_NEGATIVE)
    check_values(law, **not_negative, v_s=POSITIVE, **others)
    name = type(law).__name__
    if np.any(np.asarray(law.f_s) < np.asarray(law.f_c)):
        raise ValueError(f"{name}.f_s is {law.f_s}; stiction must be at least the Coulomb friction f_c = {law.f_c}")
    check_slips(law)


def check_slips(law: Any) -> None:
    """Raise ValueError where a bristle has no Coulomb friction to slip at."""
    if np.any((np.asarray(law.sigma_0) > 0) & (np.asarray(law.f_c) == 0)):
        name = type(law).__name__
        raise ValueError(f"{name}.f_c is 0 where sigma_0 is above 0; give f_c > 0, or sigma_0 = 0 for no dry friction")


@dataclass(frozen=True, eq=False)
class LuGre(BristleLaw):
    """LuGre friction on the motor side (Canudas de Wit et al. 1995); v = theta'.

        z'    = v - sigma_0 |v| / g(v) z,   g(v) = f_c + (f_s - f_c) exp(-(v/v_s)^2)
        tau_f = -(sigma_0 z + sigma_1 z' + sigma_2 v)      opposes motion in B theta'' + tau_j = tau_m + tau_f

    Attributes:
        sigma_0: bristle stiffness [N/m | N m/rad], at least 0; 0 leaves only viscous friction.
        sigma_1: bristle damping [N s/m | N m s/rad], at least 0.
        sigma_2: viscous coefficient [N s/m | N m s/rad], at least 0.
        f_c: Coulomb friction [N | N m], at least 0, above 0 where sigma_0 is.
        f_s: stiction [N | N m], at least f_c.
        v_s: Stribeck velocity [m/s | rad/s], above 0.
    """

    levels: ClassVar[Levels] = Levels("f_c", "f_s", "v_s", "sigma_0", "sigma_1", "sigma_2")
    respond = staticmethod(_respond)
    rate = staticmethod(_rate)

    sigma_0: Value
    sigma_1: Value
    sigma_2: Value
    f_c: Value
    f_s: Value
    v_s: Value

    def __post_init__(self) -> None:
        check_dry(self)

    def steady(self, v: Value) -> Array:
        """Friction torque tau_f at constant velocity v [m/s | rad/s], in N | N m; it opposes v."""
        return steady_curve(self, v)

    @classmethod
    def like(cls, lugre: LuGre) -> LuGre:
        """The same."""
        return lugre

    def passivity_margin(self) -> Array:
        """sigma_2 - sigma_1 (f_s - f_c) / f_c: above 0, a sufficient condition for the passivity of v -> -tau_f."""
        f_c, f_s = np.broadcast_arrays(np.asarray(self.f_c, dtype=np.float64), self.f_s)
        excess = np.divide(f_s - f_c, f_c, out=np.zeros_like(f_c), where=f_c > 0)
        return np.asarray(self.sigma_2 - self.sigma_1 * excess)


FRICTIONLESS = LuGre(sigma_0=0.0, sigma_1=0.0, sigma_2=0.0, f_c=0.0, f_s=0.0, v_s=1.0)
"""No friction at all: what the reference competitor `ideal` runs on."""
