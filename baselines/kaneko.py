"""A disturbance observer on the motor side without torque sensing.

The scheme of K. Kaneko and others (K. Ohnishi's disturbance observer on a flexible joint's motor), as described in
arXiv:1907.00553; no text of theirs could be read, and the first-order Q is ours:

    tau_f_hat = Q(s) (B theta'' - tau_m + g_0) = Q(s) (tau_f - (tau_j - g_0)),      Q = L / (s + L)

Without the sensor the joint torque is a disturbance like friction and is cancelled with it, and so are the link's
inertia, every push and gravity: the motor becomes a position-controlled one, B theta'' = tau_c - g_0. A controller
around such an observer has no gravity term. The suite's tau_c has one, g(q_d), and with g_0 = 0 nothing would be left
for it to hold: the arm would rise until K_p (theta - theta_d) = g(q_d). Therefore the constant g_0, the torque that
holds the robot at the start, is kept out of what is cancelled; it stands for the gravity model that such a controller
would use. It is read from the torque sensor at the first tick, where the joints are in equilibrium, the only use of
that sensor. What gravity changes after the start stays an error of (g(q_d) - g_0) / K_p.

Discrete time, with p = B theta' and tau_m as it was applied over the past period:

    tau_f_hat = L (p - x),      x += control_dt (tau_m - g_0 + tau_f_hat),  x_0 = p_0
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_bandwidth, check_gain
from fo_gym import JointInfo, Signals

Array = NDArray[np.float64]

__all__ = ["KanekoObserver", "kaneko"]


class KanekoObserver:
    """tau_f_hat = L / (s + L) (B theta'' - tau_m + g_0) with measured feedback: takes the joint torque for friction.

    Args:
        L: bandwidth [1/s], above 0. Slow observers destabilise the joint: the link's inertia is cancelled too late.
    """

    feedback = "measured"
    search_space: ClassVar[dict[str, tuple[float, float]]] = {"L": (20.0, 400.0)}

    def __init__(self, L: float) -> None:
        self.L = check_gain(self, "L", L)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes from equilibrium. Raises ValueError where L is too fast for the sampling."""
        check_bandwidth(self, self.L, joints)
        self._inertia = joints.motor_inertia
        self._dt = joints.control_dt
        self._held: Array | None = None
        self._estimate = np.zeros((num_envs, joints.dof))

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        momentum = self._inertia * signals.theta_dot
        if self._held is None:
            self._held = signals.tau_j.copy()
            self._momentum = momentum
        else:
            self._momentum = self._momentum + self._dt * (signals.tau_m - self._held + self._estimate)
        self._estimate = self.L * (momentum - self._momentum)
        return self._estimate


def kaneko(L: float = 100.0) -> KanekoObserver:
    """The observer without torque sensing at L = 100 1/s, the paper's high bandwidth."""
    return KanekoObserver(L)
