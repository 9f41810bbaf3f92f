"""The tool held at home under a soft task-space impedance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import POSITIVE, number
from fo_gym.control.design import designed_impedance
from fo_gym.parameters import ImpedanceGains
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot
from fo_gym.tasks.tool_path import ToolPathControl

Array = NDArray[np.float64]

__all__ = ["ToolHold"]


@dataclass(frozen=True)
class ToolHold:
    """The tool stays at home: the path of a single point, under an impedance that is soft where the tool is pushed.

    Attributes:
        softness: factor on the stiffness of the tool's position in the designed gains (`designed_impedance`); its
            damping gets the square root, which keeps the damping ratio. Orientation and elbow keep their gains.
    """

    softness: float = 0.25

    of_tool = True
    step_time = None
    motion_window = None
    duration = 0.0

    def __post_init__(self) -> None:
        number("ToolHold.softness", self.softness, POSITIVE)

    def fitted_to(self, robot: Robot) -> ToolHold:
        """Itself: nothing is left open."""
        return self

    def target(self, home: Array, share: Array | float = 1.0) -> None:
        """None: the tool stays where it is."""

    def designed_gains(self, robot: Robot) -> ImpedanceGains:
        """Designed gains, softened: unlike a robot's own they are well damped, so that the arm soon rests."""
        gains = designed_impedance(robot)
        damping = gains.kd_position * float(np.sqrt(self.softness))
        return replace(gains, kp_position=gains.kp_position * self.softness, kd_position=damping)

    def control(self, robot: Robot, plant: FlexibleJointPlant, gains: Any) -> ToolPathControl:
        """Impedance about the tool's place."""
        return ToolPathControl(self, robot, plant, gains)

    def at(self, time: Array) -> tuple[Array, Array]:
        """Offset from the start [m] and velocity [m/s] at `time` (n,) [s], (n, 3) each: none."""
        return np.zeros((len(time), 3)), np.zeros((len(time), 3))
