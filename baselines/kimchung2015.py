"""A linear disturbance observer on the motor side with nominal feedback, and the torque tau_k beside it.

M. J. Kim, W. K. Chung, "Disturbance-Observer-Based PD Control of Flexible Joint Robots for Asymptotic Convergence",
IEEE T-RO 2015; the forerunner of arXiv:1907.00553. What follows is a *reconstruction*: neither its Q-filter nor its
tau_k could be read.

Q is the textbook filter of relative degree two whose 1 - Q has a double zero at s = 0. The double zero ties theta to
theta_n; with a simple one e = theta_n - theta would drift, because the nominal motor is a double integrator:

    Q(s) = (3 L^2 s + L^3) / (s + L)^3
    tau_f_hat = Q (B theta'' + tau_j - tau_m) = -B s^2 Q / (1 - Q) e = -B L 3L / (s + 3L) (e' + L/3 e)

the PD-type observer with L_p = L/3 behind a low-pass of 3L. Discrete time: the low-pass is exact for an input that is
held over the past period.

tau_k cancels the cross term (theta_k' - q')^T K_j e in the derivative of the nominal robot's energy, to which it adds
theta_k'^T tau_k; it is regularised by eps because it is singular at rest:

    tau_k = -theta_k' ((theta_k' - q')^T K_j e) / (|theta_k'|^2 + eps),      sums over the joints of one robot

It drives the motor and the nominal motor alike, so that e does not feel it. The suite's theta_n is driven by tau_c
alone; hence, with tau_k, e = theta_k - theta with a nominal motor of our own, theta_k = theta_n + d:

    B d'' = tau_k - tau_d,      tau_d = B (2 tie d' + tie^2 d),      tau_m = tau_c + tau_k - tau_d - tau_f_hat

tau_d stands for what the controller would do if it saw theta_k, -K_p d - K_d d', which a compensator cannot ask of it;
without it theta_k would drift away from the theta_n that the controller holds on the target. Without tau_k, d is 0.
q' is the difference quotient of q = theta - tau_j / K_j, low-passed by 3L like the estimate; d moves with its torque
held over the period.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_bandwidth, check_gain
from fo_gym import JointInfo, Signals
from fo_gym.checks import flag

Array = NDArray[np.float64]

__all__ = ["KimChungObserver", "kimchung"]


class KimChungObserver:
    """tau_f_hat = Q (B theta'' + tau_j - tau_m), Q = (3 L^2 s + L^3) / (s + L)^3, with nominal feedback.

    At rest e = -3 tau_f / (B L^2): like the PD-type it stops off the target and does not hunt.

    Args:
        L: bandwidth [1/s], above 0.
        tau_k: whether the energy-shaping torque tau_k is added; off, as in its authors' experiments.
        eps: regularisation of tau_k [m^2/s^2 | rad^2/s^2], above 0.
        tie: how fast theta_k returns to theta_n [1/s], above 0; 7 is sqrt(K_p / B) of the paper's single link.
    """

    feedback = "nominal"
    search_space: ClassVar[dict[str, tuple[float, float]]] = {"L": (20.0, 400.0)}

    def __init__(self, L: float, tau_k: bool = False, eps: float = 1e-4, tie: float = 7.0) -> None:
        self.L = check_gain(self, "L", L)
        self.tau_k = flag("KimChungObserver: tau_k", tau_k)
        self.eps = check_gain(self, "eps", eps)
        self.tie = check_gain(self, "tie", tie)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes with the filters at rest. Raises ValueError where L is too fast for the sampling."""
        check_bandwidth(self, self.L, joints)
        shape = (num_envs, joints.dof)
        self._inertia, self._stiffness, self._dt = joints.motor_inertia, joints.stiffness, joints.control_dt
        self._share = -np.expm1(-3.0 * self.L * joints.control_dt)
        self._filtered, self._d, self._d_dot, self._q_dot = (np.zeros(shape) for _ in range(4))
        self._q: Array | None = None

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, with tau_k less (tau_k - tau_d), (num_envs, dof), N or N m."""
        e = signals.theta_n + self._d - signals.theta
        e_dot = signals.theta_n_dot + self._d_dot - signals.theta_dot
        self._filtered += self._share * (e_dot + self.L / 3.0 * e - self._filtered)
        estimate = -self._inertia * self.L * self._filtered
        return estimate - self._shaping(signals, e) if self.tau_k else estimate

    def _shaping(self, signals: Signals, e: Array) -> Array:
        """tau_k - tau_d, (num_envs, dof), N or N m, by which the nominal motor of our own moves on."""
        dt = self._dt
        q = signals.theta - signals.tau_j / self._stiffness
        rate = (q - self._q) / dt if self._q is not None else 0.0
        self._q = q
        self._q_dot += self._share * (rate - self._q_dot)
        velocity = signals.theta_n_dot + self._d_dot
        power = np.sum((velocity - self._q_dot) * self._stiffness * e, axis=-1, keepdims=True)
        tau_k = -velocity * power / (np.sum(velocity**2, axis=-1, keepdims=True) + self.eps)
        torque = tau_k - self._inertia * (2.0 * self.tie * self._d_dot + self.tie**2 * self._d)
        self._d += dt * self._d_dot + 0.5 * dt**2 / self._inertia * torque
        self._d_dot += dt / self._inertia * torque
        return torque


def kimchung(L: float = 100.0, tau_k: bool = False, eps: float = 1e-4, tie: float = 7.0) -> KimChungObserver:
    """The disturbance observer at L = 100 1/s, the paper's high bandwidth, without tau_k."""
    return KimChungObserver(L, tau_k, eps, tie)
