"""Generalised Maxwell slip: springs side by side that break away one after the other, and remember where."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, Value, real_array, shown
from fo_gym.friction.law import FrictionLaw, Levels
from fo_gym.friction.lugre import LuGre, check_dry, dry_friction, steady_curve

Array = NDArray[np.float64]

MOST_ELEMENTS = 32

__all__ = ["MOST_ELEMENTS", "MaxwellSlip", "presliding_elements"]


def _stuck_for(d: float, mode: float, v: float, bound: float, h: float) -> float:
    """How long an element sticks within the next h seconds at velocity v [s]."""
    if v == 0.0:
        return h
    if mode * v > 0.0:
        return 0.0
    return min(h, max(0.0, (bound - d if v > 0.0 else bound + d) / abs(v)))


def _respond(v: float, z: Array, h: float, p: Any, memory: Array) -> tuple[float, float]:
    s, count = dry_friction(v, p), len(p.alpha)
    held, slope = 0.0, p.sigma_2
    for i in range(count):
        k, b = p.kappa[i] * p.sigma_0, p.kappa[i] * p.sigma_1
        bound, d = p.alpha[i] * s / k, z[i]
        t = _stuck_for(d, z[count + i], v, bound, h)
        # It sticks for t, and then it slips: what it is off its bound decays, see fo_gym.friction.bristle.
        off = 0.0 if t > 0.0 else d - (bound if v > 0.0 else -bound)
        x = p.attraction / s * (h - t)
        left = 1.0 / (1.0 + x + 0.5 * x * x)
        mean, end = (1.0 + 0.5 * x) * left - 1.0, left - 1.0
        held += k * (d + (1.0 - t / h) * off * mean) + b * off * end / h
        slope += k * t * (1.0 - 0.5 * t / h) + b * t / h
    memory[0], memory[1], memory[2] = s, held, slope
    return held, slope


def _step(v: float, z: Array, h: float, p: Any, memory: Array) -> float:
    s, count = memory[0], len(p.alpha)
    for i in range(count):
        bound, d = p.alpha[i] * s / (p.kappa[i] * p.sigma_0), z[i]
        t = _stuck_for(d, z[count + i], v, bound, h)
        if t == h:
            z[i], z[count + i] = d + h * v, 0.0
            continue
        target = bound if v > 0.0 else -bound
        x = p.attraction / s * (h - t)
        off = 0.0 if t > 0.0 else d - target
        z[i], z[count + i] = target + off / (1.0 + x + 0.5 * x * x), 1.0 if v > 0.0 else -1.0
    return -(memory[1] + memory[2] * v)


@dataclass(frozen=True, eq=False)
class MaxwellSlip(FrictionLaw):
    """Generalised Maxwell-slip friction on the motor side (Al-Bender, Lampaert, Swevers 2005); v = theta'.

    N springs in parallel, k_i = kappa_i sigma_0 with dampers kappa_i sigma_1. A spring sticks, d_i' = v, until it bears
    alpha_i s(v); then it slips, its force F_i = k_i d_i following s, until v changes its sign:

        F_i'  = C (sgn(v) alpha_i - F_i / s(v)),   s(v) = f_c + (f_s - f_c) exp(-(v/v_s)^2)
        tau_f = -(sum_i (k_i d_i + kappa_i sigma_1 d_i') + sigma_2 v)

    Its presliding has hysteresis with nonlocal memory: after an inner loop the outer curve goes on as if there had been
    none. The states of a joint are d_1 ... d_N and how each slips: 1 forward, -1 backward, 0 not at all.

    Attributes:
        sigma_0: stiffness of all springs together [N/m | N m/rad], above 0.
        sigma_1: their damping together [N s/m | N m s/rad], at least 0.
        sigma_2: viscous coefficient [N s/m | N m s/rad], at least 0.
        f_c: Coulomb friction [N | N m], above 0.
        f_s: stiction [N | N m], at least f_c.
        v_s: Stribeck velocity [m/s | rad/s], above 0.
        attraction: C, how fast the force of slipping springs follows s [N/s | N m/s], at least 0.
        alpha: share of s that each spring carries, (N,), above 0, their sum 1; the same for all joints.
        kappa: share of sigma_0 of each, likewise.
    """

    levels: ClassVar[Levels] = Levels("f_c", "f_s", "v_s", "sigma_0", "sigma_1", "sigma_2")
    memory: ClassVar[int] = 3
    respond = staticmethod(_respond)
    step = staticmethod(_step)

    sigma_0: Value
    sigma_1: Value
    sigma_2: Value
    f_c: Value
    f_s: Value
    v_s: Value
    attraction: Value
    alpha: tuple[float, ...]
    kappa: tuple[float, ...]

    def __post_init__(self) -> None:
        check_dry(self, attraction=NOT_NEGATIVE)
        if np.any(np.asarray(self.sigma_0) == 0.0):
            raise ValueError(f"MaxwellSlip.sigma_0 is {self.sigma_0}; it must be above 0: springs cannot slip without")
        for name in ("alpha", "kappa"):
            shares = np.ravel(getattr(self, name))
            if not 0 < len(shares) <= MOST_ELEMENTS or len(shares) != len(np.ravel(self.alpha)):
                raise ValueError(
                    f"MaxwellSlip.{name} is {shown(getattr(self, name))}; give alpha and kappa of 1 to {MOST_ELEMENTS} "
                    "springs, equally many"
                )
            values = real_array(f"MaxwellSlip.{name}", shares, (len(shares),), POSITIVE)
            if abs(values.sum() - 1.0) > 1e-6:
                raise ValueError(f"MaxwellSlip.{name} is {shown(values.tolist())}, of sum {values.sum():.6g}, not 1")
            object.__setattr__(self, name, tuple(values.tolist()))

    @property
    def states(self) -> int:
        """Two for each spring."""
        return 2 * len(self.alpha)

    def _bounds(self, v: float) -> Array:
        """Deflections at which the springs slip, (N,)."""
        p: Any = self
        return np.asarray(dry_friction(v, p) * np.array(self.alpha) / (np.array(self.kappa) * p.sigma_0))

    def equations(self, v: float, z: Array) -> tuple[Array, float]:
        """See FrictionLaw; how a spring slips changes at `events` alone."""
        p: Any = self
        d, mode = np.split(z, 2)
        k, s = np.array(self.kappa) * p.sigma_0, dry_friction(v, p)
        rate = np.where(mode == 0.0, v, p.attraction * (mode * np.array(self.alpha) - k * d / s) / k)
        tau_f = -(np.sum(k * d + np.array(self.kappa) * p.sigma_1 * rate) + p.sigma_2 * v)
        return np.concatenate([rate, np.zeros_like(mode)]), float(tau_f)

    def events(self, v: float, z: Array) -> Array:
        """The velocity, if a spring slips, and how far each stuck one is from slipping in the direction of motion."""
        d, mode = np.split(z, 2)
        return np.append(v if mode.any() else 1.0, np.where(mode == 0.0, self._bounds(v) - d * np.sign(v), 1.0))

    def switched(self, v: float, z: Array) -> Array:
        """See FrictionLaw."""
        d, mode = np.split(z, 2)
        mode = np.where(mode * v > 0.0, mode, 0.0)
        starts = (mode == 0.0) & (d * np.sign(v) >= self._bounds(v) * (1.0 - 1e-9))
        return np.concatenate([d, np.where(starts, np.sign(v), mode)])

    def steady(self, v: Value) -> Array:
        """Friction torque tau_f at constant velocity v [m/s | rad/s], in N | N m; it opposes v."""
        return steady_curve(self, v)

    @classmethod
    def like(cls, lugre: LuGre, elements: int = 4) -> MaxwellSlip:
        """The one with LuGre's steady curve, its stiffness at the first touch, and about its presliding curve.

        C = sigma_0 v_s: at v_s slipping springs follow the curve as fast as LuGre's bristle.

        Args:
            lugre: sigma_0 above 0.
            elements: number of springs, from 1 to MOST_ELEMENTS.
        """
        alpha, kappa = presliding_elements(elements)
        attraction = np.asarray(lugre.sigma_0) * np.asarray(lugre.v_s)
        return cls(**vars(lugre), attraction=attraction, alpha=alpha, kappa=kappa)


@cache
def presliding_elements(count: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """(alpha, kappa) of springs that together yield like LuGre's bristle, F / f_s = 1 - exp(-sigma_0 x / f_s).

    The sum of min(kappa_i x, alpha_i) is the polygon of `count` + 1 straight pieces that lies nearest to that curve in
    the mean square over x from 0 to 6, starts with its slope, and ends at 1; four digits.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415 (heavy, and nothing else needs it)

    x = np.linspace(0.0, 6.0, 1201)

    def shares(logs: Array) -> Array:
        logs = logs.reshape(2, count)
        parts = np.exp(logs - logs.max(axis=1, keepdims=True))
        return np.asarray(parts / parts.sum(axis=1, keepdims=True))

    def error(logs: Array) -> Array:
        alpha, kappa = shares(logs)
        return np.asarray(np.minimum(kappa[:, None] * x, alpha[:, None]).sum(axis=0) + np.expm1(-x))

    breaks = np.geomspace(0.4, 4.0, count) if count > 1 else np.ones(1)
    start = np.log(np.concatenate([np.full(count, 1.0 / count), 1.0 / breaks]))
    found = np.round(shares(least_squares(error, start).x), 4)
    found[:, 0] += 1.0 - found.sum(axis=1)
    alpha, kappa = (tuple(float(value) for value in np.round(row, 4)) for row in found)
    return alpha, kappa
