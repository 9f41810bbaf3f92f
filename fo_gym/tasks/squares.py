"""Squares: how a tool runs along one, and which one an arm can draw from its home pose."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from fo_gym.robots import Robot
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

MARGIN, MARGIN_SHARE = 0.4, 0.1
"""What joints keep from the ends of their ranges [rad, or natural units of a slide], since the friction-free motion
leaves the reference by up to 0.4 rad (iiwa); and the share of the range that is enough where it is small."""

_PER_SIDE = 8
_DIGITS = 3
"""Scores count to these digits, so that the last bits of a processor decide nothing; of equals the first is taken."""

__all__ = ["Direction", "fitted_square", "square_motion"]


def square_motion(
    time: Array, duration: float, side: float, first: Direction, second: Direction
) -> tuple[Array, Array]:
    """A square's four sides in turn, back to the start; see ToolPath.

    Returns:
        Offset from the start [m] and velocity [m/s] at `time` (n,) [s], (n, 3) each; at rest after the end.
    """
    side_time = duration / 4.0
    progress = np.clip(np.asarray(time, dtype=np.float64) / side_time, 0.0, 4.0)
    index = np.minimum(progress.astype(int), 3)
    x = progress - index
    directions = np.array([first, second, np.negative(first), np.negative(second)]) * side
    corners = np.vstack([np.zeros(3), np.cumsum(directions, axis=0)])
    along = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    speed = 30.0 * x**2 * (1.0 - x) ** 2 / side_time
    return corners[index] + along[:, None] * directions[index], speed[:, None] * directions[index]


def _planes() -> list[tuple[Direction, Direction]]:
    """Directions of first and second side: all quarters of the three planes of the world's axes, the upright first."""
    x, y, z = np.eye(3)
    signs = list(product((-1.0, 1.0), repeat=2))
    both = [(s * first + 0.0, t * second + 0.0) for first, second in ((y, z), (x, z), (x, y)) for s, t in signs]
    return [((*first.tolist(),), (*second.tolist(),)) for first, second in both]


def fitted_square(
    robot: Robot, side: float | None = None, plane: tuple[Direction, Direction] | None = None
) -> tuple[float, Direction, Direction]:
    """The largest square from the tool's home that keeps away from singular poses and from the joints' limits.

    Tried are the quarters of the world's planes and SIZES of the largest side. Along the whole of it the smallest
    singular value of the Jacobian, redundant joints held, is at least SINGULAR, and every joint keeps MARGIN. Among
    squares of one size the one with the most room counts, the smaller of both as a multiple of what is asked.

    Args:
        robot: it has a tool; home is a corner of the square.
        side: its length [m]; None for the largest that fits.
        plane: directions of its first and second side; None for those that leave most room.

    Returns:
        Side [m], directions of the first and the second side.

    Raises:
        ValueError: no square fits; the message says what stands in the way.
    """
    planes = _planes() if plane is None else [plane]
    ticks = np.arange(4 * _PER_SIDE + 1) / _PER_SIDE
    tool = ToolKinematics(robot.link_side, robot.home, robot.redundant, len(planes) * len(ticks))
    poses = Poses(tool.body.model, robot.tool)
    reach = poses.reach()
    smallest = _smallest(tool, tool.jacobian(tool.start), poses.units, reach)[0]
    if smallest < SINGULAR:
        raise ValueError(
            f"the tool of robot {robot.name!r} cannot draw a square from home: that pose is singular, with a smallest "
            f"singular value of {smallest:.2g} where {SINGULAR:g} is asked for; choose another home, tool or redundant "
            "joints"
        )
    largest = min(LARGEST_SIDE, SIDE_SHARE * reach)
    for length in [side] if side is not None else [size * largest for size in SIZES]:
        offsets = [square_motion(ticks, 4.0, length, *directions)[0] for directions in planes]
        room = _room(tool, np.concatenate(offsets), poses, reach)
        rooms = np.round(room.reshape(len(planes), -1).min(axis=1), _DIGITS)
        best = int(np.argmax(rooms))
        if rooms[best] >= 1.0:
            return length, *planes[best]
    raise ValueError(
        f"the tool of robot {robot.name!r} draws no square of {length:.3g} m from home: in the best plane it reaches "
        f"{rooms[best]:.2g} of what is asked for, a smallest singular value of {SINGULAR:g} and {MARGIN:g} rad to the "
        "limit of every joint; choose another home, tool or redundant joints, or a smaller side"
    )


def _smallest(tool: ToolKinematics, jacobian: Array, units: Array, reach: float) -> Array:
    """Smallest singular value of what is controlled, (n,), without dimension."""
    jacobian = scaled(jacobian, units, reach)
    jacobian[:, tool.rows :] = np.eye(len(units))[tool.held]
    return np.asarray(np.linalg.svd(jacobian, compute_uv=False)[:, -1])


def _room(tool: ToolKinematics, offset: Array, poses: Poses, reach: float) -> Array:
    """How much of what is asked for is there at every offset, (n,); above 1 it is enough, 0 is out of reach."""
    q, off = tool.follow(offset)
    reached = off < MAX_RESIDUAL
    q = np.where(reached[:, None], q, tool.q_start)
    pose, _ = tool.body.tool_pose(q)
    low, high = joint_range(poses.model)
    asked = np.minimum(MARGIN * poses.units, MARGIN_SHARE * (high - low))
    margin = (np.minimum(q - low, high - q) / asked).min(axis=1)
    room = np.minimum(_smallest(tool, tool.jacobian(pose), poses.units, reach) / SINGULAR, margin)
    return np.where(reached, room, 0.0)
