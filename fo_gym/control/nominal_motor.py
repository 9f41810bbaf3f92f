"""The nominal motor: where the motor would be without friction, driven by the measured joint torque."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.compiling import jit

Array = NDArray[np.float64]

__all__ = ["NominalMotor", "move_nominal"]


class NominalMotor:
    """B theta_n'' + tau_j = tau_c, in discrete time with the torques of a tick held over the period.

    Args:
        theta, theta_dot: where it is, (num_envs, dof), m and m/s | rad and rad/s: arrays that it moves.
        dt: control period [s].
    """

    def __init__(self, theta: Array, theta_dot: Array, dt: float) -> None:
        self.theta, self.theta_dot = theta, theta_dot
        self.dt = dt

    def reset(self, ids: NDArray[np.intp], theta: Array, theta_dot: Array) -> None:
        """Start the named environments from the true motor, (n, dof) each."""
        self.theta[ids] = theta
        self.theta_dot[ids] = theta_dot

    def step(self, tau_c: Array, tau_j: Array, motor_inertia: Array) -> None:
        """Advance one control period with the values of its first tick, (num_envs, dof) each."""
        move_nominal((self.theta, self.theta_dot, motor_inertia), tau_c, tau_j, self.dt, 0, len(self.theta))


@jit
def move_nominal(motors, tau_c, tau_j, dt, first, last):
    """One period of the nominal motors of the environments from `first` to `last`; see NominalMotor.step.

    Args:
        motors: (theta, theta_dot, motor_inertia), the first two in place, (num_envs, dof) each.
        tau_c, tau_j, dt: see NominalMotor.
        first, last: of the environments; `last` is not among them.
    """
    theta, theta_dot, motor_inertia = motors
    for i in range(first, last):
        for j in range(theta.shape[1]):
            acceleration = (tau_c[i, j] - tau_j[i, j]) / motor_inertia[i, j]
            theta[i, j] += dt * theta_dot[i, j] + (0.5 * dt * dt) * acceleration
            theta_dot[i, j] += dt * acceleration
