"""Adaptive compensation: a LuGre model whose levels are learned online, in front of the PD-type observer.

As in C. Canudas de Wit, P. Lischinsky, "Adaptive Friction Compensation with Partially Known Dynamic Friction Model",
Int. J. of Adaptive Control and Signal Processing 1997, the shape of friction is taken as identified and its level is
not: load, temperature and wear make dry friction as a whole grow or fall. Viscous friction has a level of its own.
The feedback is that of arXiv:1907.00553; the derivation is ours. With v = theta', e = theta_n - theta and the
identified sigma and g(v):

    z' = v - sigma_0 |v| / g(v) z,      phi = (sigma_0 z + sigma_1 z', sigma_2 v)
    tau_f_hat = -share phi . level - B L (e' + L_p e)

**What is learned**: with the low-pass F = L / (s + L) and psi = F phi, the momentum B v tells r = F tau_f without a
derivative, r' = L (B v' - tau_m + tau_j - r), and

    level' = -rate psi (r + psi . level) / (f_c^2 + |psi|^2)      while |v| > 2 v_s, kept within `BOUNDS`

Let friction be tau_f = -phi . true - d, where d is what the model cannot say: another bristle, another Stribeck
curve, a sensor's offset. Then r + psi . level = psi . (level - true) - F d, and for V = |level - true|^2 / 2

    V' = -rate ((psi . (level - true))^2 - psi . (level - true) F d) / (f_c^2 + |psi|^2)

Where d = 0 it never grows, whatever joint and controller do meanwhile, and the levels converge to the true ones if
psi excites both; else they come to where they explain friction best, within the bounds. Projection onto the bounds
only takes from V, if the true levels lie within. At standstill, where the bristle can hold any torque and phi says
nothing of the levels, nothing is learned: that is what keeps the estimate from hunting as an integral does.

**What is cancelled**: motor and nominal motor give B (e'' + L e' + L L_p e) = phi . (true - share level) + d, a
stable linear system under a bounded torque, but for the error of sigma_2 v, which is small beside the damping B L. At
rest e is the PD-type observer's, with what is left of friction in place of all of it. share < 1 is under-
compensation, as usual with friction models: what is left opposes the motion, although levels are wrong by up to 1 /
share - 1. Too much of it would feed the flexible modes of the joints, which this argument does not see and which the
suite's controllers hardly damp: on the arm a share of 1 swings.

Not so in truth, and part of d: exact B and tau_j, velocities without delay, levels that do not move.

Discrete time: z by one implicit Euler step over the measured displacement, z' its difference quotient; the low-passes
are exact for what is held over the past period; the levels by forward Euler, which contracts while rate dt < 1.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_bandwidth, check_gain, check_share
from baselines.lugre1995 import checked_friction, model_of, stribeck
from fo_gym import JointInfo, LuGre, Signals

Array = NDArray[np.float64]

BOUNDS = (0.0, 3.0)
"""Of a level, as a factor on the identified friction."""

_SLIDES = 2.0
"""In Stribeck velocities: from here on dry friction is little more than f_c, and its sign is known."""

__all__ = ["BOUNDS", "AdaptiveLuGreObserver", "lugre_adaptive"]


class AdaptiveLuGreObserver:
    """tau_f_hat = -share phi . level - B L (e' + L_p e) with nominal feedback; levels begin at 0.

    Args:
        L: bandwidth of the feedback and of what is learned from [1/s], above 0.
        Lp: [1/s], above 0.
        rate: of learning while the joint slides [1/s], above 0.
        share: of the learned friction that is cancelled, in (0, 1].
        friction: the shape: friction at level 1; None takes what was identified for the robot
            (`JointInfo.identified`).

    Attributes:
        level: of dry and of viscous friction, (2, num_envs, dof), from `reset` on.
    """

    feedback = "nominal"
    search_space: ClassVar[dict[str, tuple[float, float]]] = {
        "L": (20.0, 400.0),
        "Lp": (4.0, 80.0),
        "rate": (1.0, 100.0),
        "share": (0.3, 1.0),
    }

    def __init__(self, L: float, Lp: float, rate: float, share: float, friction: LuGre | None = None) -> None:
        self.L = check_gain(self, "L", L)
        self.Lp = check_gain(self, "Lp", Lp)
        self.rate = check_gain(self, "rate", rate)
        self.share = check_share(self, "share", share)
        self.friction = checked_friction(self, friction)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes without a friction that was learned.

        Raises:
            ValueError: no friction model fits the robot, or L or the rate is too fast for the sampling.
        """
        check_bandwidth(self, self.L, joints)
        check_bandwidth(self, self.rate, joints, "rate")
        self._model = model_of(self, self.friction, joints)
        self._inertia, self._dt = joints.motor_inertia, joints.control_dt
        self._weight = -np.expm1(-self.L * joints.control_dt)
        self.level = np.zeros((2, num_envs, joints.dof))
        self._psi = np.zeros_like(self.level)
        self._r, self._z = np.zeros((2, num_envs, joints.dof))
        self._past: tuple[Array, Array, Array] | None = None

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        theta, v, tau_j = signals.theta.copy(), signals.theta_dot.copy(), signals.tau_j.copy()
        past = self._past if self._past is not None else (theta, v, tau_j)
        dry = self._dry(theta - past[0], v)
        if self._past is not None:
            tau_f = self._inertia * (v - past[1]) / self._dt - signals.tau_m + 0.5 * (tau_j + past[2])
            self._learn(np.stack([dry, self._model.sigma_2 * (theta - past[0]) / self._dt]), tau_f, v)
        self._past = theta, v, tau_j
        model = self.level[0] * dry + self.level[1] * self._model.sigma_2 * v
        y = signals.theta_n_dot - v + self.Lp * (signals.theta_n - theta)
        return -self.share * model - self._inertia * self.L * y

    def _dry(self, moved: Array, v: Array) -> Array:
        """Dry friction at level 1, (num_envs, dof), after the bristles were moved along [m | rad]."""
        p = self._model
        z = (self._z + moved) / (1.0 + p.sigma_0 * np.abs(moved) / stribeck(p, v))
        dry = p.sigma_0 * z + p.sigma_1 * (z - self._z) / self._dt
        self._z = z
        return dry

    def _learn(self, phi: Array, tau_f: Array, v: Array) -> None:
        """Move the levels by what the past period says: phi (2, num_envs, dof) and the torque that moved the motor."""
        p = self._model
        self._psi += self._weight * (phi - self._psi)
        self._r += self._weight * (tau_f - self._r)
        scale = np.maximum(np.square(p.f_c) + np.sum(np.square(self._psi), axis=0), np.finfo(float).tiny)
        unexplained = (self._r + np.sum(self._psi * self.level, axis=0)) / scale
        step = np.where(np.abs(v) > _SLIDES * p.v_s, self.rate * self._dt, 0.0) * unexplained
        self.level = np.clip(self.level - step * self._psi, *BOUNDS)


def lugre_adaptive(
    L: float = 100.0, Lp: float = 20.0, rate: float = 20.0, share: float = 0.8, friction: LuGre | None = None
) -> AdaptiveLuGreObserver:
    """The adaptive observer with the paper's high gains in its feedback; rate and share are ours."""
    return AdaptiveLuGreObserver(L, Lp, rate, share, friction)
