"""Impedance in task space: tool position, tool orientation, and the joints that settle the redundancy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fo_gym.compiling import jit
from fo_gym.parameters import ImpedanceGains, check_joints
from fo_gym.plant.rigid_body import RigidBody

Array = NDArray[np.float64]

_STATICS_ITERATIONS = 3

__all__ = ["Impedance", "TaskSetpoint"]


class TaskSetpoint(NamedTuple):
    """What the tool should do now.

    Attributes:
        position, velocity: (num_envs, 3), m and m/s.
        rotation: (3, 3), the same for all environments.
        held: positions of the redundant joints, (redundant,), m | rad, the same for all environments.
    """

    position: Array
    velocity: Array
    rotation: Array
    held: Array


class Impedance:
    """tau_c = J^T(theta) (-K_p e_x - K_d e_x') + g(q_bar(theta)), e_x = x(theta) - x_d.

    x stacks tool position, tool orientation (where `oriented`) and the redundant joints. q_bar is the quasi-static link
    position, K_j (theta - q_bar) = g(q_bar), found by fixed-point iteration; each pass gains a factor K_j^-1 dg/dq.

    Args:
        gains: stiffness and damping of the parts; those of the elbow are the redundant joints'.
        body: the link side as the controller knows it.
        redundant: indices of the joints that are held, each by itself, because the tool leaves them free.
        oriented: whether the tool's orientation is controlled, beside its position.

    Raises:
        ValueError: the gains are for another number of redundant joints.
    """

    def __init__(
        self, gains: ImpedanceGains, body: RigidBody, redundant: Sequence[int], *, oriented: bool = True
    ) -> None:
        self.gains = gains
        self.body = body
        self.redundant = np.array(redundant, dtype=np.intp)
        check_joints(gains, len(redundant))
        self._tool = np.array(
            [[gains.kp_position, gains.kd_position], [gains.kp_orientation, gains.kd_orientation]][: 1 + oriented]
        )
        self._elbow = np.empty((len(redundant), 2))
        self._elbow[:, 0], self._elbow[:, 1] = gains.kp_elbow, gains.kd_elbow

    def torque(self, theta: Array, theta_dot: Array, stiffness: Array, mass: Array, setpoint: TaskSetpoint) -> Array:
        """Control torque tau_c, (num_envs, dof), N m.

        Args:
            theta, theta_dot: measured or nominal motor, (num_envs, dof), rad and rad/s.
            stiffness: K_j as the controller knows it, (num_envs, dof), N m/rad.
            mass: factor on the body's masses in what the controller knows, (num_envs, 1).
            setpoint: desired motion of the tool.
        """
        pose, gravity = self.body.tool_pose(theta)
        tau_c = mass * gravity
        for _ in range(_STATICS_ITERATIONS - 1):
            tau_c = mass * self.body.gravity(theta - tau_c / stiffness)
        _add_impedance(tau_c, *pose, theta, theta_dot, *setpoint, self.redundant, self._tool, self._elbow)
        return tau_c


@jit
def _add_impedance(
    tau_c, position, rotation, jacobian, theta, theta_dot, x_d, x_dot_d, rotation_d, held, redundant, tool, elbow
):
    """Add J^T (-K_p e_x - K_d e_x') to tau_c, environment by environment, so that neighbours do not matter."""
    num_envs, dof = theta.shape
    error = np.empty(6)
    for i in range(num_envs):
        for k in range(3):
            error[k] = position[i, k] - x_d[i, k]
            # Half the sum of desired axes x actual axes: the rotation vector of R R_d^T, to second order.
            a, b = (k + 1) % 3, (k + 2) % 3
            turn = 0.0
            for axis in range(3):
                turn += rotation_d[a, axis] * rotation[i, b, axis] - rotation_d[b, axis] * rotation[i, a, axis]
            error[3 + k] = 0.5 * turn
        for row in range(3 * len(tool)):
            part = row // 3
            rate = -x_dot_d[i, row] if part == 0 else 0.0
            for j in range(dof):
                rate += jacobian[i, row, j] * theta_dot[i, j]
            force = -tool[part, 0] * error[row] - tool[part, 1] * rate
            for j in range(dof):
                tau_c[i, j] += jacobian[i, row, j] * force
        for k in range(len(redundant)):
            j = redundant[k]
            tau_c[i, j] -= elbow[k, 0] * (theta[i, j] - held[k]) + elbow[k, 1] * theta_dot[i, j]
