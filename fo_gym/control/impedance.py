"""Impedance in task space: tool position, tool orientation, and the joints that settle the redundancy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fo_gym.compiling import jit
from fo_gym.parameters import ImpedanceGains, check_joints
from fo_gym.plant.links import Links
from fo_gym.plant.screws import gravity_torque, motion_room, place, tool_column, tool_frame

Array = NDArray[np.float64]

_STATICS_ITERATIONS = 3

__all__ = ["Impedance", "TaskSetpoint", "impedance_torques"]


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
        links: kinematics and gravity of the link side.
        redundant: indices of the joints that are held, each by itself, because the tool leaves them free.
        oriented: whether the tool's orientation is controlled, beside its position.

    Attributes:
        compiled: what `impedance_torques` knows it by.

    Raises:
        ValueError: the gains are for another number of redundant joints.
    """

    def __init__(self, gains: ImpedanceGains, links: Links, redundant: Sequence[int], *, oriented: bool = True) -> None:
        self.gains = gains
        self.links = links
        check_joints(gains, len(redundant))
        tool = np.array(
            [[gains.kp_position, gains.kd_position], [gains.kp_orientation, gains.kd_orientation]][: 1 + oriented]
        )
        elbow = np.empty((len(redundant), 2))
        elbow[:, 0], elbow[:, 1] = gains.kp_elbow, gains.kd_elbow
        self.compiled = links.joints, links.world, links.reference, np.array(redundant, dtype=np.intp), tool, elbow


@jit
def _task_errors(position, rotation, x_d, rotation_d, error):
    """Where the tool is too far, (6,): position, and half the sum of desired axes x actual axes.

    The second is the rotation vector of R R_d^T, to second order.
    """
    for k in range(3):
        error[k] = position[k] - x_d[k]
        a, b = (k + 1) % 3, (k + 2) % 3
        turn = 0.0
        for axis in range(3):
            turn += rotation_d[a, axis] * rotation[b, axis] - rotation_d[b, axis] * rotation[a, axis]
        error[3 + k] = 0.5 * turn


@jit
def _task_torque(error, rate, columns, tool, torque):
    """J^T (-K_p e_x - K_d e_x') of the tool's rows that `tool` has gains for, into torque (dof,); J^T is `columns`."""
    torque[:] = 0.0
    for row in range(3 * len(tool)):
        part = row // 3
        force = -tool[part, 0] * error[row] - tool[part, 1] * rate[row]
        for j in range(len(torque)):
            torque[j] += columns[j, row] * force


@jit
def impedance_torques(law, stiffness, mass, theta, theta_dot, setpoint, tau_c, first, last):
    """Write the control torque of the environments from `first` to `last`, which is not among them.

    Environment by environment, so that neighbours do not matter.

    Args:
        law: what an Impedance is compiled as.
        stiffness: K_j as the controller knows it, (num_envs, dof), N m/rad.
        mass: factor on the masses of the robot's file, as the controller knows it, (num_envs,).
        theta, theta_dot: measured or nominal motor, (num_envs, dof), rad and rad/s.
        setpoint: desired motion of the tool, a TaskSetpoint or a tuple of its fields.
        tau_c: out, (num_envs, dof), N m.
        first, last: of the environments.
    """
    joints, world, reference, redundant, tool, elbow = law
    x_d, x_dot_d, rotation_d, held = setpoint
    dof = len(joints)
    room, carried, columns = motion_room(dof), np.empty((dof + 1, 4)), np.empty((dof, 6))
    position, rotation, error, rate = np.empty(3), np.empty((3, 3)), np.empty(6), np.empty(6)
    q_bar, gravity = np.empty(dof), np.empty(dof)
    for i in range(first, last):
        place(joints, reference, theta[i], room)
        tool_frame(joints, world, room, position, rotation)
        _task_errors(position, rotation, x_d[i], rotation_d, error)
        for row in range(6):
            rate[row] = -x_dot_d[i, row] if row < 3 else 0.0
        for j in range(dof):
            tool_column(joints[j], room[j + 1], position, columns[j])
            for row in range(6):
                rate[row] += columns[j, row] * theta_dot[i, j]
        _task_torque(error, rate, columns, tool, tau_c[i])
        for k in range(len(redundant)):
            j = redundant[k]
            tau_c[i, j] -= elbow[k, 0] * (theta[i, j] - held[k]) + elbow[k, 1] * theta_dot[i, j]
        gravity_torque(joints, world, theta[i], mass[i], room, carried, gravity)
        for _ in range(_STATICS_ITERATIONS - 1):
            for j in range(dof):
                q_bar[j] = theta[i, j] - gravity[j] / stiffness[i, j]
            place(joints, reference, q_bar, room)
            gravity_torque(joints, world, q_bar, mass[i], room, carried, gravity)
        for j in range(dof):
            tau_c[i, j] += gravity[j]
