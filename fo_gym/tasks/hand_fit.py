"""How a hand guides an arm: how far, how fast, how firmly."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fo_gym.robots import Robot
from fo_gym.robots.poses import Poses
from fo_gym.tasks.square_fit import Direction, fitted_square

Array = NDArray[np.float64]

STIFFNESS = 1000.0
"""Of a hand that holds on firmly, at most [N/m]. Ours: firm for a human arm, so that the tool follows it."""

DAMPING_TIME = 0.03
"""Damping as a share of the stiffness [s]: 30 N s/m at 1000 N/m. Ours."""

FORCE_SHARE = 0.6
"""Share of a joint's torque limit that the hand may take if the tool stood still while its point is a stroke away."""

TOOL_RATE = 100.0
"""Hand and links alone, without the motors behind the springs, swing at most this fast [rad/s], and the damper slows
them at most as fast: a tenth of the rate at which the hand is sampled."""

STROKE_TIME = 1.5
"""A stroke's length over its speed [s]: 0.1 m/s on 15 cm. Ours: as slow as one guides a robot to a place."""

__all__ = ["FittedHand", "fitted_hand"]


class FittedHand(NamedTuple):
    """What suits a robot: see the attributes of `Hand` of these names."""

    stroke: float
    speed: float
    stiffness: float
    damping: float
    direction: Direction
    across: Direction


def fitted_hand(
    robot: Robot,
    stroke: float | None = None,
    direction: Direction | None = None,
    across: Direction | None = None,
    stiffness: float | None = None,
) -> FittedHand:
    """Where the tool has room, and a hand that the motors can hold; what is given is kept.

    Strokes lie in the square that the tool could draw from home (`fitted_square`), as long as its side.

    Raises:
        ValueError: there is no such square; the message says why.
    """
    if stroke is None or direction is None or across is None:
        plane = None if direction is None or across is None else (direction, across)
        try:
            side, (first, second) = fitted_square(robot, stroke, plane)
        except ValueError as error:
            raise ValueError(f"a hand guides the tool where it could draw a square: {error}") from error
        stroke, direction, across = side, direction or first, across or second
    poses = Poses(robot.link_side.model, robot.tool)
    jacobian = poses.jacobian(robot.home)[:3]
    lightest = 1.0 / np.linalg.eigvalsh(jacobian @ np.linalg.solve(poses.inertia(robot.home), jacobian.T))[-1]
    if stiffness is None:
        levers = np.abs(np.array([direction, across]) @ jacobian).max(axis=0)
        tightest = float(np.max(levers / robot.flexible.torque_limit)) * stroke / FORCE_SHARE
        stiffness = float(min(1.0 / max(tightest, 1.0 / STIFFNESS), TOOL_RATE**2 * lightest))
    damping = float(min(DAMPING_TIME * stiffness, TOOL_RATE * lightest))
    return FittedHand(stroke, stroke / STROKE_TIME, stiffness, damping, direction, across)
