"""A linear extended-state observer: friction as a third state of the motor, estimated from its position alone.

J. Han, "From PID to Active Disturbance Rejection Control", IEEE TIE 2009; linear, with all gains from one bandwidth:
Z. Gao, "Scaling and Bandwidth-Parameterization Based Controller Tuning", ACC 2003. With u = (tau_m - tau_j) / B and the
states theta, theta' and d = tau_f / B, of which nothing is known but that it changes slowly:

    x_1' = x_2 + 3 w (theta - x_1)
    x_2' = x_3 + 3 w^2 (theta - x_1) + u
    x_3' = w^3 (theta - x_1),      tau_f_hat = B x_3 = w^3 / (s + w)^3 tau_f

Le Tien's estimate, L = w, behind two more low-passes w / (s + w): these stand for the velocity, which is not taken from
the encoder's differences. At low frequencies it lags by 3 / w.

Discrete time: R. Miklosovic, A. Radke, Z. Gao, "Discrete Implementation and Generalization of the Extended State
Observer", ACC 2006, the current estimator. The motor moves exactly under torques that are held over the period (tau_m
and tau_j of the past one are taken to be so), and the newest position corrects by

    l = (1 - b^3,  3 (1 - b)^2 (1 + b) / (2 dt),  (1 - b)^3 / dt^2),      b = exp(-w dt)

which puts all three poles at b: stable at any w dt.
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_gain
from fo_gym import JointInfo, Signals

Array = NDArray[np.float64]

__all__ = ["ExtendedStateObserver", "eso"]


class ExtendedStateObserver:
    """tau_f_hat = w^3 / (s + w)^3 tau_f with measured feedback, from theta, tau_j and tau_m.

    Args:
        bandwidth: w [1/s], above 0.
    """

    feedback = "measured"
    search_space: ClassVar[dict[str, tuple[float, float]]] = {"bandwidth": (60.0, 1200.0)}

    def __init__(self, bandwidth: float) -> None:
        self.bandwidth = check_gain(self, "bandwidth", bandwidth)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes from where the motors are, without an estimate."""
        dt = joints.control_dt
        b = math.exp(-self.bandwidth * dt)
        self._gains = 1.0 - b**3, 1.5 * (1.0 - b) ** 2 * (1.0 + b) / dt, (1.0 - b) ** 3 / dt**2
        self._inertia = joints.motor_inertia
        self._dt = dt
        self._d = np.zeros((num_envs, joints.dof))
        self._theta, self._theta_dot = np.zeros((2, num_envs, joints.dof))
        self._tau_j: Array | None = None

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        if self._tau_j is None:
            self._theta, self._theta_dot = signals.theta.copy(), signals.theta_dot.copy()
        else:
            self._predict_and_correct(signals, self._tau_j)
        self._tau_j = signals.tau_j.copy()
        return self._inertia * self._d

    def _predict_and_correct(self, signals: Signals, tau_j: Array) -> None:
        dt = self._dt
        acceleration = (signals.tau_m - tau_j) / self._inertia + self._d
        theta = self._theta + dt * self._theta_dot + 0.5 * dt**2 * acceleration
        error = signals.theta - theta
        self._theta = theta + self._gains[0] * error
        self._theta_dot = self._theta_dot + dt * acceleration + self._gains[1] * error
        self._d = self._d + self._gains[2] * error


def eso(bandwidth: float = 300.0) -> ExtendedStateObserver:
    """The extended-state observer that lags by 10 ms at low frequencies, as Le Tien's does at the paper's high gain."""
    return ExtendedStateObserver(bandwidth)
