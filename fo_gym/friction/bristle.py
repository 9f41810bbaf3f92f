"""Laws of one bristle, z' = v - a z with a rate a >= 0 that depends on v and z: their step, whatever the rate.

    tau_f = -(sigma_0 z + sigma_1 z' + sigma_2 v)

Over a step the rate is frozen, which makes the bristle linear, and it decays by 1 / (1 + x + x^2/2), x = a h, the (0,2)
Pade form of exp(-x): second order, no oscillation at any x, so that neither stiction creeps nor fast sliding rings.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.friction.law import FrictionLaw

Array = NDArray[np.float64]

__all__ = ["BristleLaw", "bristle_mean", "bristle_response", "bristle_step"]


def bristle_mean(a: float, h: float) -> tuple[float, float]:
    """Weights (w_z, w_v) of the mean deflection over a step, z_mean = w_z z + w_v v, for z' = v - a z."""
    x = a * h
    scale = 1.0 / (1.0 + x + 0.5 * x * x)
    return (1.0 + 0.5 * x) * scale, 0.5 * h * (1.0 + x) * scale


def bristle_response(a: float, z: float, h: float, p: Any) -> tuple[float, float]:
    """What `FrictionLaw.respond` gives for a bristle at deflection z whose rate over the step is a."""
    w_z, w_v = bristle_mean(a, h)
    elastic = p.sigma_0 - p.sigma_1 * a
    viscous = p.sigma_2 + (p.sigma_1 if p.sigma_0 > 0.0 else 0.0)
    return elastic * w_z * z, viscous + elastic * w_v


def bristle_step(z: float, v: float, a: float, h: float, p: Any) -> tuple[float, float]:
    """One bristle over h seconds at velocity v and rate a.

    Returns:
        (z, tau_f): deflection at the end of the step [m | rad]; mean friction torque over it [N | N m], opposing v.
    """
    w_z, w_v = bristle_mean(a, h)
    z_mean = w_z * z + w_v * v
    z_rate = v - a * z_mean if p.sigma_0 > 0.0 else 0.0
    return z + h * z_rate, -(p.sigma_0 * z_mean + p.sigma_1 * z_rate + p.sigma_2 * v)


def _step(v: float, z: Array, h: float, p: Any, memory: Array) -> float:
    z[0], tau_f = bristle_step(z[0], v, memory[0], h, p)
    return tau_f


def _responding(rate: Any) -> Any:
    """`FrictionLaw.respond` for a bristle's rate, a function of v, z and p: the mean of the rates at both ends.

    Where that would carry the bristle beyond the point at which it slips as fast as it is pulled, as it may in a step
    that bends it by all that it bends, it is the rate there.
    """

    def respond(v: float, z: Array, h: float, p: Any, memory: Array) -> tuple[float, float]:
        """See FrictionLaw."""
        first = rate(v, z[0], p)
        w_z, w_v = bristle_mean(first, h)
        a = 0.5 * (first + rate(v, z[0] + h * (v - first * (w_z * z[0] + w_v * v)), p))
        w_z, w_v = bristle_mean(a, h)
        end = z[0] + h * (v - a * (w_z * z[0] + w_v * v))
        last = rate(v, end, p)
        memory[0] = last if (v - last * end) * (v - first * z[0]) < 0.0 else a
        return bristle_response(memory[0], z[0], h, p)

    return respond


class BristleLaw(FrictionLaw):
    """A law of one bristle: it has the parameters sigma_0, sigma_1, sigma_2 and others, and says the bristle's `rate`.

    Second order, stable for any step and without creep below break-away follow from that.
    """

    memory: ClassVar[int] = 1
    step = staticmethod(_step)

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if "rate" in vars(cls) and "respond" not in vars(cls):
            cls.respond = staticmethod(_responding(cls.rate))  # type: ignore[method-assign]

    @staticmethod
    def rate(v: float, z: float, p: Any) -> float:
        """How fast the bristle forgets its deflection [1/s], at least 0: z' = v - rate z. Compiled as `respond` is.

        Args:
            v: velocity of the motor [m/s | rad/s].
            z: deflection [m | rad].
            p: the joint's parameters, by attribute.
        """
        raise NotImplementedError("a law of one bristle has a function `rate`")

    def equations(self, v: float, z: Array) -> tuple[Array, float]:
        """See FrictionLaw."""
        p: Any = self
        z_rate = v - self.rate(v, z[0], p) * z[0] if p.sigma_0 > 0.0 else 0.0
        return np.array([z_rate]), -(p.sigma_0 * z[0] + p.sigma_1 * z_rate + p.sigma_2 * v)
