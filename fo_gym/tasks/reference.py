"""What a task's reference is: the motion that is asked for, before there is a plant to follow it."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from fo_gym.parameters import ImpedanceGains, PDGains
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot
from fo_gym.tasks.control import TaskControl

Array = NDArray[np.float64]

__all__ = ["Reference"]


@runtime_checkable
class Reference(Protocol):
    """A motion that a task asks for: `Step`, `JointPath`, `ToolPath`, or a frozen dataclass of a user's own.

    Where the tool follows it, the tool's position is what is scored.
    """

    @property
    def step_time(self) -> float | None:
        """When the target jumps [s], or None."""

    @property
    def motion_window(self) -> tuple[float, float] | None:
        """(start, end) [s] in which it moves along its path, or None."""

    @property
    def of_tool(self) -> bool:
        """Whether the tool follows it."""

    def fitted_to(self, robot: Robot) -> Any:
        """The same with what was left open chosen for a robot. Raises ValueError, saying why, where it suits none."""

    def target(self, home: Array, share: Array | float = 1.0) -> Array | None:
        """Links that are desired in the end, (dof,), where an episode may ask for others; None on a path.

        Args:
            home: where the links start, (dof,), m or rad.
            share: of the way there, a number or (dof,).
        """

    def designed_gains(self, robot: Robot) -> PDGains | ImpedanceGains:
        """Gains of its controller, by design or as the robot brings them."""

    def control(self, robot: Robot, plant: FlexibleJointPlant, gains: Any) -> TaskControl:
        """Reference and controller at work on a batch.

        Args:
            robot: to which it is fitted.
            plant: the batch.
            gains: of the kind that `designed_gains` gives.
        """
