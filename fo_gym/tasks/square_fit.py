"""Side and plane of a square that an arm can draw from its start pose."""

from __future__ import annotations

from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fo_gym.robots import LinkSide, Robot
from fo_gym.robots.poses import Poses, joint_range, scaled
from fo_gym.tasks.kinematics import MAX_RESIDUAL, ToolKinematics

Array = NDArray[np.float64]
Direction = tuple[float, float, float]

LARGEST_SIDE = 0.15
"""Side of a square where nothing asks for less [m]: the paper's."""

SIDE_SHARE = 0.3
"""Side at most, as a share of the tool's longest lever."""

SIZES = (1.0, 0.85, 0.7, 0.55, 0.4, 0.3, 0.2)
"""Sides that are tried, as shares of the largest."""

SINGULAR = 0.08
"""Smallest singular value along a path, without dimension (robots.poses.scaled): a joint moves by at most 1 / SINGULAR
radians while the tool moves by its longest lever."""

SINGULAR_SHARE = 0.6
"""The same as a share of that at home: the tool's stiffness acts on the joints with its square, so a third remains."""

MARGIN, MARGIN_SHARE = 0.4, 0.1
"""What joints keep from the ends of their ranges [rad, or natural units of a slide], since the friction-free motion
leaves the reference by up to 0.4 rad (iiwa); and the share of the range that is enough where it is small."""

GRAVITY_CHANGE = 0.06
"""By how much gravity may change along a path, as a share of the torque limits; designed friction is 0.05 of them. To a
compensator without torque sensor the two look the same, and friction is what is to be rejected."""

LEVEL = 1.15
"""A plane in which gravity changes by up to so many times the least counts as well as the best."""

_PER_SIDE = 8
_DIGITS = 3
"""Scores count to these digits, so that the last bits of a processor decide nothing; of equals the first is taken."""

__all__ = ["Direction", "fitted_square"]


def _planes() -> list[tuple[Direction, Direction]]:
    """Directions of first and second side: all quarters of the three planes of the world's axes, the upright first."""
    x, y, z = np.eye(3)
    signs = list(product((-1.0, 1.0), repeat=2))
    pairs = [(s * first + 0.0, t * second + 0.0) for first, second in ((y, z), (x, z), (x, y)) for s, t in signs]
    return [((*first.tolist(),), (*second.tolist(),)) for first, second in pairs]


def fitted_square(
    robot: Robot,
    side: float | None = None,
    plane: tuple[Direction, Direction] | None = None,
) -> tuple[float, tuple[Direction, Direction]]:
    """The largest square from the tool's start that keeps away from singular poses and from the joints' limits.

    Tried are the quarters of the world's planes and SIZES of the largest side. Along the whole of it the smallest
    singular value of the Jacobian, redundant joints held, is at least SINGULAR, and SINGULAR_SHARE of that at home;
    every joint keeps MARGIN; and gravity changes by GRAVITY_CHANGE at most. Where no size has all that, the one with
    the least change counts; of squares of one size the first in which gravity changes least. Friction plays no part:
    without it the square is the same.

    Args:
        robot: with a tool; its home is a corner of the square.
        side: length of a side [m]; None for the largest that fits.
        plane: unit vectors of the first and the second side, in the world; None for the one with the most room.

    Returns:
        Side [m]; plane, as above.

    Raises:
        ValueError: no square fits; the message says what stands in the way.
    """
    links, limit = robot.link_side, np.asarray(robot.flexible.torque_limit)
    home, limits = tuple(robot.home.tolist()), tuple(limit.tolist())
    return _fitted(links, links.stamp, robot.name, home, robot.redundant, limits, side, plane)


@lru_cache(maxsize=8)
def _fitted(
    links: LinkSide,
    _stamp: tuple[int, int],
    name: str,
    at: tuple[float, ...],
    redundant: tuple[str, ...],
    limits: tuple[float, ...],
    side: float | None,
    plane: tuple[Direction, Direction] | None,
) -> tuple[float, tuple[Direction, Direction]]:
    """What `fitted_square` gives, kept: an environment that is made again asks again."""
    planes, home = _planes() if plane is None else [plane], np.array(at)
    tool = ToolKinematics(links, home, redundant, len(planes) * 4 * _PER_SIDE)
    poses = Poses(links.model, links.tool)
    reach = poses.reach()
    smallest = float(_smallest(tool, tool.jacobian(tool.start), poses.units, reach)[0])
    if smallest < SINGULAR:
        directions = np.linalg.matrix_rank(scaled(poses.jacobian(home)[: tool.rows], poses.units, reach), 1e-6)
        raise ValueError(
            f"the tool {links.tool!r} of robot {name!r} cannot draw a square: at home its joints move it in "
            f"{directions} of the {tool.rows} directions that the task controls, and the smallest singular value is "
            f"{smallest:.2g} where {SINGULAR:g} is asked for; choose another home, tool or other redundant joints"
        )
    asked = max(SINGULAR, SINGULAR_SHARE * smallest)
    largest = min(LARGEST_SIDE, SIDE_SHARE * reach)
    found: list[tuple[float, float, tuple[Direction, Direction]]] = []
    for length in [side] if side is not None else [size * largest for size in SIZES]:
        q, room = _room(tool, length * np.concatenate([_outline(*each) for each in planes]), poses, reach, asked)
        rooms = np.round(room.reshape(len(planes), -1).min(axis=1), _DIGITS)
        if rooms.max() >= 1.0:
            change = np.abs(tool.links.gravity(q) - poses.gravity(home)) / np.array(limits)
            changes = np.where(rooms >= 1.0, change.reshape(len(planes), -1).max(axis=1), np.inf)
            best = int(np.flatnonzero(changes <= LEVEL * changes.min())[0])
            found.append((max(GRAVITY_CHANGE, float(changes[best])), length, planes[best]))
            if found[-1][0] == GRAVITY_CHANGE:
                break
    if found:
        return min(found, key=lambda each: each[0])[1:]
    raise ValueError(
        f"the tool draws no square of {length:.3g} m from this start pose: in the best plane it reaches "
        f"{rooms.max():.2g} of what is asked for, a smallest singular value of {asked:.2g} and {MARGIN:g} rad to the "
        "limit of every joint; choose another home, tool or other redundant joints, or a smaller side"
    )


def _outline(first: Direction, second: Direction) -> Array:
    """Points of a square of side 1, (4 _PER_SIDE, 3), from its first corner."""
    along = np.arange(_PER_SIDE)[:, None] / _PER_SIDE
    u, v = np.array(first), np.array(second)
    return np.concatenate([along * u, u + along * v, u + v - along * u, v - along * v])


def _smallest(tool: ToolKinematics, jacobian: Array, units: Array, reach: float) -> Array:
    """Smallest singular value of what is controlled, (n,), without dimension."""
    jacobian = scaled(jacobian, units, reach)
    jacobian[:, tool.rows :] = np.eye(len(units))[tool.held]
    return np.asarray(np.linalg.svd(jacobian, compute_uv=False)[:, -1])


def _room(tool: ToolKinematics, offset: Array, poses: Poses, reach: float, least: float) -> tuple[Array, Array]:
    """Joint positions at every offset, (n, dof), and how much of what is asked for is there, (n,).

    Asked for are `least` as the smallest singular value, and MARGIN: 1 is enough. Where an offset is out of reach it
    is 0, and the joints are at home.
    """
    q, off = tool.follow(offset)
    reached = off < MAX_RESIDUAL
    q = np.where(reached[:, None], q, tool.q_start)
    pose = tool.links.tool_pose(q)
    low, high = joint_range(poses.model)
    asked = np.minimum(MARGIN * poses.units, MARGIN_SHARE * (high - low))
    margin = (np.minimum(q - low, high - q) / asked).min(axis=1)
    room = np.minimum(_smallest(tool, tool.jacobian(pose), poses.units, reach) / least, margin)
    return q, np.where(reached, room, 0.0)
