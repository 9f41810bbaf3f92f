"""Inverse kinematics: the joint positions that follow a tool's path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from fo_gym.plant.links import Links, ToolPose
from fo_gym.robots.link_side import LinkSide
from fo_gym.robots.poses import tool_rows

Array = NDArray[np.float64]

MAX_ROWS = 100_000
"""Ticks of a path at most: it is tabulated, and a tool's inverse kinematics is solved for all of them at once."""

MAX_RESIDUAL = 1e-9
"""By how much the inverse kinematics may miss the path at most [m | rad]."""

__all__ = ["PathTable", "ToolKinematics", "path_table", "path_ticks"]


class TimedPath(Protocol):
    """Where a tool is to go; paths that are alike have the same hash, since tables of them are kept."""

    def __hash__(self) -> int: ...

    @property
    def duration(self) -> float:
        """Time that it takes [s]."""

    def at(self, time: Array) -> tuple[Array, Array]:
        """Offset from the start [m] and velocity [m/s] at `time` (n,) [s], (n, 3) each."""


class PathTable(NamedTuple):
    """A path, tick by tick.

    Attributes:
        position: desired tool position, (ticks, 3), m; the last row holds for ever.
        velocity: desired tool velocity, (ticks, 3), m/s.
        rotation: desired tool orientation, constant, (3, 3).
        held: desired positions of the redundant joints, constant, (redundant,), m | rad.
        q_d: joint positions that do all this, continued from the start pose, (ticks, dof), m | rad.
    """

    position: Array
    velocity: Array
    rotation: Array
    held: Array
    q_d: Array


def _orientation_error(rotation: Array, desired: Array) -> Array:
    """Vector that turns `desired` into `rotation`, in the world, (n, 3), rad; exact to second order."""
    return 0.5 * np.cross(np.swapaxes(desired, -1, -2), np.swapaxes(rotation, -1, -2)).sum(axis=-2)


class ToolKinematics:
    """Inverse kinematics of many tool positions at once, about one start pose.

    The tool follows in position and orientation (at least 6 joints) or in position alone (3 to 5); the redundant joints
    stay where they start.

    Args:
        robot: the link side, with a tool.
        q_start: start pose, (dof,), m | rad.
        redundant: names of the joints that are held, as many as the tool leaves free.
        count: how many positions there are.

    Attributes:
        body: `count` copies of the link side.
        start: the tool in the start pose, `count` times.
        held: indices of the redundant joints.

    Raises:
        ValueError: the robot has no tool or too few joints for a tool path, or `redundant` are not as many as it needs.
    """

    def __init__(self, robot: LinkSide, q_start: Array, redundant: Sequence[str], count: int) -> None:
        self.rows = tool_rows(robot.dof)
        if robot.tool is None:
            raise ValueError("a tool path needs a robot with a tool; name a site, a body or a link of its file")
        if robot.dof < 3:
            raise ValueError(f"a tool path needs a robot with at least 3 joints; this one has {robot.dof}")
        known = len(set(redundant) & set(robot.joints))
        if not known == len(redundant) == robot.dof - self.rows:
            raise ValueError(
                f"redundant joints are {tuple(redundant)}; a tool path of a robot with {robot.dof} joints needs "
                f"{robot.dof - self.rows} of {robot.joints}, each once"
            )
        self.links = Links(robot)
        self.q_start = q_start
        self.start = self.links.tool_pose(np.tile(q_start, (count, 1)))
        self.held = np.array([robot.joints.index(name) for name in redundant], dtype=np.intp)
        self._held_rows = np.zeros((count, len(self.held), robot.dof))
        self._held_rows[:, np.arange(len(self.held)), self.held] = 1.0

    def jacobian(self, pose: ToolPose) -> Array:
        """Of what is controlled, redundant joints included, (count, dof, dof)."""
        return np.concatenate([pose.jacobian[:, : self.rows], self._held_rows], axis=1)

    def follow(self, offset: Array) -> tuple[Array, Array]:
        """Joint positions that put the tool `offset` (count, 3) [m] off its start.

        Newton's method, the offsets growing from nothing to their full size so that the solution stays on the branch of
        the start pose.

        Returns:
            q (count, dof); by how much each misses [m | rad], (count,): large, or NaN, where there is no solution.
        """
        q = np.tile(self.q_start, (len(offset), 1))
        residual = np.full(q.shape, np.inf)
        for size in (0.25, 0.5, 0.75, 1.0, 1.0, 1.0):
            for _ in range(3):
                pose = self.links.tool_pose(q)
                residual = np.concatenate(
                    [
                        pose.position - self.start.position - size * offset,
                        _orientation_error(pose.rotation, self.start.rotation)[:, : self.rows - 3],
                        q[:, self.held] - self.q_start[self.held],
                    ],
                    axis=1,
                )
                q -= np.linalg.solve(self.jacobian(pose), residual[..., None])[..., 0]
        return q, np.abs(residual).max(axis=1)


def path_ticks(duration: float, dt: float) -> int:
    """Ticks of a path, its two ends included.

    Raises:
        ValueError: there are more than MAX_ROWS.
    """
    if duration / dt > MAX_ROWS:
        raise ValueError(
            f"control_dt is {dt:g} s, too short for a path of {duration:g} s: its table has at most {MAX_ROWS} "
            f"rows; give a control_dt of at least {duration / MAX_ROWS:g} s"
        )
    return round(duration / dt) + 1


def path_table(robot: LinkSide, path: TimedPath, q_start: Array, dt: float, redundant: Sequence[str]) -> PathTable:
    """Tabulate `path` from the tool pose at q_start, with a tick every dt seconds.

    Args:
        robot: the link side, with a tool.
        path: the tool's path.
        q_start: start pose, (dof,), m | rad.
        dt: control period [s].
        redundant: names of the joints that stay where they start, see ToolKinematics.

    Raises:
        ValueError: the robot suits no tool path, the path leaves its reach, or has more than MAX_ROWS ticks.
    """
    ticks = path_ticks(path.duration, dt)
    offset, velocity = path.at(np.arange(ticks, dtype=np.float64) * dt)
    tool = ToolKinematics(robot, q_start, redundant, ticks)
    q_d, off = tool.follow(offset)
    if not off.max() < MAX_RESIDUAL:
        raise ValueError(f"inverse kinematics of the path ends {off.max():.2g} m or rad off: out of reach")
    start = tool.start
    return PathTable(start.position + offset, velocity, start.rotation[0], q_start[tool.held], q_d)
