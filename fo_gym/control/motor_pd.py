"""Motor PD in joint space, with gravity at the desired pose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.compiling import jit
from fo_gym.parameters import PDGains, per_joint

Array = NDArray[np.float64]

__all__ = ["MotorPD", "pd_torque"]


class MotorPD:
    """tau_c = -K_p (theta - theta_d) - K_d theta' + g(q_d).

    Attributes:
        gains: one value per joint.
        kp, kd: theirs, (dof,).
    """

    def __init__(self, gains: PDGains, dof: int) -> None:
        self.gains: PDGains = per_joint(gains, dof)
        self.kp, self.kd = np.array(self.gains.kp), np.array(self.gains.kd)

    def torque(self, theta: Array, theta_dot: Array, theta_d: Array, gravity: Array) -> Array:
        """Control torque tau_c, N or N m.

        Args:
            theta, theta_dot: measured or nominal motor, (num_envs, dof), m and m/s | rad and rad/s; where the reference
                moves, theta_dot is relative to it.
            theta_d: desired motor position, (num_envs, dof), m | rad.
            gravity: g(q_d), (num_envs, dof), N or N m.
        """
        tau_c = np.empty_like(theta_d)
        _torques(theta, theta_dot, theta_d, gravity, self.kp, self.kd, tau_c)
        return tau_c


@jit
def pd_torque(theta, theta_dot, theta_d, gravity, kp, kd):
    """That of one joint, of numbers."""
    return gravity - kp * (theta - theta_d) - kd * theta_dot


@jit
def _torques(theta, theta_dot, theta_d, gravity, kp, kd, tau_c):
    num_envs, dof = tau_c.shape
    for i in range(num_envs):
        for j in range(dof):
            tau_c[i, j] = pd_torque(theta[i, j], theta_dot[i, j], theta_d[i, j], gravity[i, j], kp[j], kd[j])
