"""Kinematics and gravity of a tree of joints, compiled: the product of exponentials (Brockett 1984).

Every joint moves all that comes after it by a screw, whose axis is known where all joints are at their reference.

Environment by environment, so that neighbours do not matter.
"""

from __future__ import annotations

import math

import numpy as np

from fo_gym.compiling import jit

AXIS, ANCHOR, MOMENT, MASS, SLIDES, BEFORE, LEADS, SPRING, REST = 0, 3, 6, 9, 10, 11, 12, 13, 16
"""Columns of what is known of every joint, where each part begins.

Its axis (3) and a point on it (3) [m]; mass times place (3) [kg m] and mass [kg] of what it carries up to the next
joints; whether it slides; the joint before it, counted from 1, or 0; whether it moves the tool; the coefficients (3) of
its spring, of x, x^2 and x^3; where that spring is at rest [m | rad].
"""

COLUMNS = 17

__all__ = [
    "gravity_torque",
    "gravity_torques",
    "motion_room",
    "place",
    "tool_column",
    "tool_distances",
    "tool_frame",
    "tool_poses",
    "tool_positions",
]


@jit
def motion_room(dof):
    """Room for `place`: a turn (3, 3), a shift, an axis and a point on it, (3,) each, for the world and every joint."""
    room = np.zeros((dof + 1, 6, 3))
    for k in range(3):
        room[0, k, k] = 1.0
    return room


@jit
def place(joints, reference, q, room):
    """Move everything to q (dof,).

    Args:
        joints, reference: see Links.
        q: joint positions, (dof,), m | rad.
        room: out, see `motion_room`: row j + 1 is how joint j has moved what it carries, x -> turn x + shift, and where
            its own axis is now.
    """
    for j in range(len(joints)):
        above, own = int(joints[j, BEFORE]), j + 1
        for a in range(3):
            axis, anchor = 0.0, room[above, 3, a]
            for b in range(3):
                axis += room[above, a, b] * joints[j, AXIS + b]
                anchor += room[above, a, b] * joints[j, ANCHOR + b]
            room[own, 4, a], room[own, 5, a] = axis, anchor
        distance = q[j] - reference[j]
        x, y, z = room[own, 4, 0], room[own, 4, 1], room[own, 4, 2]
        if joints[j, SLIDES] > 0.0:
            for a in range(3):
                room[own, 3, a] = room[above, 3, a] + distance * room[own, 4, a]
                for b in range(3):
                    room[own, a, b] = room[above, a, b]
            continue
        # Rodrigues: cos I + sin [axis x] + (1 - cos) axis axis^T.
        sine, cosine = math.sin(distance), math.cos(distance)
        rest = 1.0 - cosine
        for b in range(3):
            u, v, w = room[above, 0, b], room[above, 1, b], room[above, 2, b]
            along = rest * (x * u + y * v + z * w)
            room[own, 0, b] = cosine * u + sine * (y * w - z * v) + along * x
            room[own, 1, b] = cosine * v + sine * (z * u - x * w) + along * y
            room[own, 2, b] = cosine * w + sine * (x * v - y * u) + along * z
        for a in range(3):
            shift = room[own, 5, a]
            for b in range(3):
                shift -= room[own, a, b] * joints[j, ANCHOR + b]
            room[own, 3, a] = shift


@jit
def gravity_torque(joints, world, q, mass, room, carried, torque):
    """What holds the links still where `place` has put them.

    Args:
        joints, world: see Links.
        q: joint positions, (dof,), m | rad.
        mass: factor on the masses.
        room: as `place` left it.
        carried: room for a mass times its place, and the mass, (dof + 1, 4).
        torque: out, (dof,), N m | N.
    """
    dof = len(joints)
    carried[:] = 0.0
    gx, gy, gz = world[0]
    for j in range(dof - 1, -1, -1):
        above, own = int(joints[j, BEFORE]), j + 1
        weight = mass * joints[j, MASS]
        for a in range(3):
            moment = weight * room[own, 3, a]
            for b in range(3):
                moment += room[own, a, b] * (mass * joints[j, MOMENT + b])
            carried[own, a] += moment
        carried[own, 3] += weight
        for a in range(4):
            carried[above, a] += carried[own, a]
        heavy = carried[own, 3]
        x, y, z = room[own, 4, 0], room[own, 4, 1], room[own, 4, 2]
        if joints[j, SLIDES] > 0.0:
            pull = heavy * (gx * x + gy * y + gz * z)
        else:
            u, v, w = (
                carried[own, 0] - heavy * room[own, 5, 0],
                carried[own, 1] - heavy * room[own, 5, 1],
                carried[own, 2] - heavy * room[own, 5, 2],
            )
            pull = gx * (y * w - z * v) + gy * (z * u - x * w) + gz * (x * v - y * u)
        stretch = q[j] - joints[j, REST]
        spring = joints[j, SPRING] + stretch * (joints[j, SPRING + 1] + stretch * joints[j, SPRING + 2])
        torque[j] = stretch * spring - pull


@jit
def tool_frame(joints, world, room, position, rotation):
    """Tool position (3,) [m] and rotation (3, 3) where `place` has put the links."""
    last = 0
    for j in range(len(joints)):
        if joints[j, LEADS] > 0.0:
            last = j + 1
    own = room[last]
    for a in range(3):
        position[a] = own[3, a]
        for b in range(3):
            position[a] += own[a, b] * world[1, b]
            rotation[a, b] = 0.0
            for c in range(3):
                rotation[a, b] += own[a, c] * world[2 + b, c]


@jit
def gravity_torques(joints, world, reference, q, mass, torque):
    """`Links.gravity` into torque (n, dof)."""
    n, dof = q.shape
    room, carried = motion_room(dof), np.empty((dof + 1, 4))
    for i in range(n):
        place(joints, reference, q[i], room)
        gravity_torque(joints, world, q[i], mass[i], room, carried, torque[i])


@jit
def tool_column(joint, own, position, column):
    """Column of the tool's Jacobian, (6,), linear and angular, that a joint's row of `joints` and of `room` gives."""
    for a in range(6):
        column[a] = 0.0
    if joint[LEADS] == 0.0:
        return
    x, y, z = own[4]
    if joint[SLIDES] > 0.0:
        column[0], column[1], column[2] = x, y, z
        return
    u, v, w = position[0] - own[5, 0], position[1] - own[5, 1], position[2] - own[5, 2]
    column[0], column[1], column[2] = y * w - z * v, z * u - x * w, x * v - y * u
    column[3], column[4], column[5] = x, y, z


@jit
def tool_positions(joints, world, reference, q, position):
    """`Links.tool_position` into position (n, 3)."""
    n, dof = q.shape
    room, rotation = motion_room(dof), np.empty((3, 3))
    for i in range(n):
        place(joints, reference, q[i], room)
        tool_frame(joints, world, room, position[i], rotation)


@jit
def tool_distances(joints, world, reference, q, point, distance):
    """How far the tool is from `point` (n, 3) [m] at q (n, dof), into distance (n,) [m]."""
    n, dof = q.shape
    room, position, rotation = motion_room(dof), np.empty(3), np.empty((3, 3))
    for i in range(n):
        place(joints, reference, q[i], room)
        tool_frame(joints, world, room, position, rotation)
        squares = 0.0
        for a in range(3):
            squares += (position[a] - point[i, a]) ** 2
        distance[i] = math.sqrt(squares)


@jit
def tool_poses(joints, world, reference, q, position, rotation, jacobian):
    """`Links.tool_pose` into the parts of a ToolPose."""
    n, dof = q.shape
    room = motion_room(dof)
    for i in range(n):
        place(joints, reference, q[i], room)
        tool_frame(joints, world, room, position[i], rotation[i])
        for j in range(dof):
            tool_column(joints[j], room[j + 1], position[i], jacobian[i, :, j])
