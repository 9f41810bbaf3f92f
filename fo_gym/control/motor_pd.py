"""Motor PD in joint space, with gravity at the desired pose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.parameters import PDGains, per_joint

Array = NDArray[np.float64]

__all__ = ["MotorPD"]


class MotorPD:
    """tau_c = -K_p (theta - theta_d) - K_d theta' + g(q_d)."""

    def __init__(self, gains: PDGains, dof: int) -> None:
        self.gains: PDGains = per_joint(gains, dof)

    def torque(self, theta: Array, theta_dot: Array, theta_d: Array, gravity: Array) -> Array:
        """Control torque tau_c, N or N m.

        Args:
            theta, theta_dot: measured or nominal motor, (num_envs, dof), m and m/s | rad and rad/s; where the reference
                moves, theta_dot is relative to it.
            theta_d: desired motor position, (num_envs, dof), m | rad.
            gravity: g(q_d), (num_envs, dof), N or N m.
        """
        return gravity - self.gains.kp * (theta - theta_d) - self.gains.kd * theta_dot
