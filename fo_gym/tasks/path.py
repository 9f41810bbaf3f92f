"""The tool path of the square task, and the joint angles that follow it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fo_gym.plant import Robot
from fo_gym.plant.rigid_body import RigidBody

Array = NDArray[np.float64]

ELBOW = 2
"""The joint whose angle, held constant, settles the redundancy of seven joints: the third."""

MAX_ROWS = 100_000
"""Ticks of a path at most: its inverse kinematics is solved for all of them at once."""

__all__ = ["ELBOW", "PathTable", "SquarePath", "path_table"]


@dataclass(frozen=True)
class SquarePath:
    """A square in the plane of two directions, its four sides run through in turn, back to the start.

    Each side follows s(x) = 10 x^3 - 15 x^4 + 6 x^5: smooth up to acceleration, at rest in the corners.

    Attributes:
        side: length of a side [m].
        duration: time for all four sides [s].
        first: unit vector of the first side, in the world.
        second: unit vector of the second side, at a right angle to the first.
    """

    side: float
    duration: float
    first: tuple[float, float, float]
    second: tuple[float, float, float]

    def at(self, time: Array) -> tuple[Array, Array]:
        """Offset from the start [m] and velocity [m/s] at `time` (n,) [s], (n, 3) each; at rest after the end."""
        side_time = self.duration / 4.0
        progress = np.clip(np.asarray(time, dtype=np.float64) / side_time, 0.0, 4.0)
        index = np.minimum(progress.astype(int), 3)
        x = progress - index
        directions = np.array([self.first, self.second, np.negative(self.first), np.negative(self.second)]) * self.side
        corners = np.vstack([np.zeros(3), np.cumsum(directions, axis=0)])
        along = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
        speed = 30.0 * x**2 * (1.0 - x) ** 2 / side_time
        return corners[index] + along[:, None] * directions[index], speed[:, None] * directions[index]


class PathTable(NamedTuple):
    """A path, tick by tick, for a robot with the masses of its file.

    Attributes:
        position: desired tool position, (ticks, 3), m; the last row holds for ever.
        velocity: desired tool velocity, (ticks, 3), m/s.
        rotation: desired tool orientation, constant, (3, 3).
        elbow: desired angle of the third joint, constant, rad.
        q_d: joint angles of (position, rotation, elbow), continued from the start pose, (ticks, dof), rad.
        gravity: g(q_d), (ticks, dof), N m.
    """

    position: Array
    velocity: Array
    rotation: Array
    elbow: float
    q_d: Array
    gravity: Array


def _orientation_error(rotation: Array, desired: Array) -> Array:
    """Vector that turns `desired` into `rotation`, in the world, (n, 3), rad; exact to second order."""
    return 0.5 * np.cross(np.swapaxes(desired, -1, -2), np.swapaxes(rotation, -1, -2)).sum(axis=-2)


def path_table(robot: Robot, path: SquarePath, q_start: Array, dt: float) -> PathTable:
    """Tabulate `path` from the tool pose at q_start, with a tick every dt seconds.

    The inverse kinematics is solved by Newton's method at all ticks at once, the path growing from a point to its
    full size so that the solution stays on the branch of the start pose.

    Raises:
        ValueError: the robot does not have seven joints, the path leaves its reach, or has more than MAX_ROWS ticks.
    """
    if robot.dof != 7:
        raise ValueError(f"a tool path with elbow needs a robot with 7 joints; this one has {robot.dof}")
    if path.duration / dt > MAX_ROWS:
        raise ValueError(
            f"control_dt is {dt:g} s, too short for a path of {path.duration:g} s: its table has at most {MAX_ROWS} "
            f"rows; give a control_dt of at least {path.duration / MAX_ROWS:g} s"
        )
    ticks = round(path.duration / dt) + 1
    offset, velocity = path.at(np.arange(ticks, dtype=np.float64) * dt)
    body = RigidBody(robot, ticks)
    q_d = np.tile(q_start, (ticks, 1))
    start, _ = body.tool_pose(q_d)
    elbow_row = np.zeros((ticks, 1, robot.dof))
    elbow_row[:, 0, ELBOW] = 1.0
    residual = np.full((ticks, robot.dof), np.inf)
    for size in (0.25, 0.5, 0.75, 1.0, 1.0, 1.0):
        for _ in range(3):
            pose, _ = body.tool_pose(q_d)
            residual = np.concatenate(
                [
                    pose.position - start.position - size * offset,
                    _orientation_error(pose.rotation, start.rotation),
                    q_d[:, ELBOW, None] - q_start[ELBOW],
                ],
                axis=1,
            )
            jacobian = np.concatenate([pose.jacobian, elbow_row], axis=1)
            q_d -= np.linalg.solve(jacobian, residual[..., None])[..., 0]
    if not np.abs(residual).max() < 1e-9:
        raise ValueError(f"inverse kinematics of the path ends {np.abs(residual).max():.2g} m or rad off: out of reach")
    return PathTable(
        start.position + offset, velocity, start.rotation[0], float(q_start[ELBOW]), q_d, body.gravity(q_d)
    )
