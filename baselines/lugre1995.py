"""Model-based compensation: an observer of the LuGre model's bristle.

C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, "A New Model for Control of Systems with Friction", IEEE TAC
1995; H. Olsson, K. J. Astrom, "Observer-Based Friction Compensation", CDC 1996. With v = theta' and the model's g(v):

    z_hat' = v - sigma_0 |v| / g(v) z_hat - k (theta - theta_d)
    F_hat = sigma_0 z_hat + sigma_1 z_hat' + sigma_2 v,     tau_f_hat = -F_hat

Discrete time: z_hat by one implicit Euler step per period, with the newest measurements, stable at any speed; z_hat' is
its difference quotient.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from fo_gym import JointInfo, LuGre, Signals
from fo_gym.checks import NOT_NEGATIVE, number, shown

Array = NDArray[np.float64]

__all__ = [
    "IDENTIFIED",
    "MISIDENTIFIED",
    "MISMATCH",
    "LuGreObserver",
    "checked_friction",
    "lugre_nominal",
    "lugre_off",
    "model_of",
]

_ARM_F_C = np.array([4.0, 4.0, 4.0, 4.0, 3.0, 3.0, 3.0])
_ARM_SIGMA_0 = _ARM_F_C / 1e-4
_ARM_INERTIA = np.array([1.2, 1.2, 1.2, 1.2, 0.6, 0.6, 0.6])

IDENTIFIED: Mapping[int, LuGre] = {
    1: LuGre(sigma_0=1e5, sigma_1=float(np.sqrt(1e5)), sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=0.001),
    7: LuGre(
        sigma_0=_ARM_SIGMA_0,
        sigma_1=np.sqrt(_ARM_SIGMA_0 * _ARM_INERTIA),
        sigma_2=5.0,
        f_c=_ARM_F_C,
        f_s=1.5 * _ARM_F_C,
        v_s=0.01,
    ),
}
"""Identified parameters of the two shipped robots, by their number of joints: the single link, the MIRO-like arm.

A model-based compensator needs an identification of its robot; this one was told the nominal values. Where friction is
drawn per episode, it is off like any identification of a robot that has aged.
"""

MISMATCH = 1.0 + np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]) * np.random.default_rng(1995).uniform(0.2, 0.3, 6)
"""Factors on sigma_0, sigma_1, sigma_2, f_c, f_s, v_s: off by 20 to 30 %, in turn up and down; drawn from seed 1995."""


def _misidentified(friction: LuGre) -> LuGre:
    names = (field.name for field in fields(friction))
    return LuGre(**{name: getattr(friction, name) * factor for name, factor in zip(names, MISMATCH, strict=True)})


MISIDENTIFIED: Mapping[int, LuGre] = {dof: _misidentified(friction) for dof, friction in IDENTIFIED.items()}
"""IDENTIFIED with every parameter off by its MISMATCH."""


def checked_friction(owner: object, friction: LuGre | Mapping[int, LuGre]) -> LuGre | Mapping[int, LuGre]:
    """The argument as it is. Raises ValueError where it is no friction model, nor one for each number of joints."""
    models = friction.values() if isinstance(friction, Mapping) else (friction,)
    if not models or not all(isinstance(model, LuGre) for model in models):
        raise ValueError(
            f"{type(owner).__name__}: friction is {shown(friction)}; give fo_gym.LuGre(...), or one for "
            "each number of joints, {dof: fo_gym.LuGre(...)}"
        )
    return friction


def model_of(owner: object, friction: LuGre | Mapping[int, LuGre], dof: int) -> LuGre:
    """The friction model of a robot with `dof` joints.

    Raises:
        ValueError: there is none, or it is for another number of joints.
    """
    name = type(owner).__name__
    if isinstance(friction, Mapping):
        if dof not in friction:
            raise ValueError(
                f"{name}: no friction was identified for a robot with {dof} joints, only for {sorted(friction)}; "
                f"give the parameters of yours as {name}(friction=fo_gym.LuGre(...))"
            )
        friction = friction[dof]
    for field in fields(friction):
        shape = np.shape(getattr(friction, field.name))
        if shape not in ((), (1,), (dof,)):
            raise ValueError(
                f"{name}: friction.{field.name} has shape {shape}; give one value for all joints or one for each of "
                f"the {dof}"
            )
    return friction


class LuGreObserver:
    """tau_f_hat = -(sigma_0 z_hat + sigma_1 z_hat' + sigma_2 v) with measured feedback.

    With the true parameters the model runs beside the joint and cancels its friction but for the sampling. Wrong ones
    leave a rest of friction, or drive the joint: where sigma_2 is too large for the controller's damping, it runs away.

    k adds an integral action of sigma_0 k on the position error, which makes it converge where (sigma_1 s + sigma_0) /
    (B s^2 + K_d s + K_p) is strictly positive real. That asks for sigma_1 K_d > sigma_0 B, which none of the suite's
    controllers meets; the 10 of the 1995 example hunts here, and k must be small.

    Args:
        friction: parameters of the model, or one such set for each number of joints.
        k: gain of the position error [1/s], at least 0.
    """

    feedback = "measured"
    search_space: ClassVar[dict[str, tuple[float, float]]] = {"k": (1e-6, 1e-2)}

    def __init__(self, friction: LuGre | Mapping[int, LuGre], k: float = 1e-3) -> None:
        self.friction = checked_friction(self, friction)
        self.k = number("LuGreObserver: k", k, NOT_NEGATIVE)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes with the bristles at rest. Raises ValueError where no friction model fits the robot."""
        self._model = model_of(self, self.friction, joints.dof)
        self._dt = joints.control_dt
        self._z = np.zeros((num_envs, joints.dof))

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        p, v = self._model, signals.theta_dot
        g = p.f_c + (p.f_s - p.f_c) * np.exp(-np.square(v / p.v_s))
        drive = v - self.k * (signals.theta - signals.theta_d)
        z = (self._z + self._dt * drive) / (1.0 + self._dt * p.sigma_0 * np.abs(v) / g)
        z_dot = (z - self._z) / self._dt
        self._z = z
        return -(p.sigma_0 * z + p.sigma_1 * z_dot + p.sigma_2 * v)


def lugre_nominal(friction: LuGre | Mapping[int, LuGre] = IDENTIFIED, k: float = 1e-3) -> LuGreObserver:
    """The observer with the nominal parameters of the shipped robots: exact on "nominal", and so a reference there."""
    return LuGreObserver(friction, k)


def lugre_off(friction: LuGre | Mapping[int, LuGre] = MISIDENTIFIED, k: float = 1e-3) -> LuGreObserver:
    """The observer with parameters that are 20 to 30 % off."""
    return LuGreObserver(friction, k)
