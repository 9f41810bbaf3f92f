"""How hard an arm is pushed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.robots import Robot
from fo_gym.robots.poses import Poses

__all__ = ["fitted_torque"]

_SHARE = 1.0 / 15.0
"""Of the joint's torque limit: 10 N m at joint 2 of the MIRO-like arm, as in the experiment of arXiv:1907.00553."""


def fitted_torque(robot: Robot) -> NDArray[np.float64]:
    """A push at the joint that carries the most, as a share of its limit, in the home pose: (dof,), N or N m.

    Where no joint carries anything, as on a horizontal rail, it is the first.
    """
    load = np.abs(Poses(robot.link_side.model).gravity(robot.home)) / robot.flexible.torque_limit
    torque = np.zeros(robot.dof)
    joint = int(np.argmax(load))
    torque[joint] = np.asarray(robot.flexible.torque_limit)[joint] * _SHARE
    return torque
