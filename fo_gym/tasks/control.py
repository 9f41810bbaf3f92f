"""What every reference is at work on a batch: where it is at each tick, and the torque that follows it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fo_gym.plant import FlexibleJointPlant
from fo_gym.tasks.scenario import Scenario

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

__all__ = ["TaskControl", "believed"]


class TaskControl(Protocol):
    """Reference and controller of a batch of episodes.

    Attributes:
        theta_d: desired motor position at the current ticks, (num_envs, dof), m or rad.
        reference: the task's reference beside theta_d, (num_envs, k); k = 0 where there is none.
        path: where the tool is to go, (points, 3), m; None where no path of the tool is followed.
    """

    theta_d: Array
    reference: Array
    path: Array | None

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """Take the scenarios of new episodes; the plant has its new parameters already."""

    def update(self, ticks: NDArray[np.int64]) -> None:
        """Move the reference to these control ticks, (num_envs,)."""

    def torque(self, theta: Array, theta_dot: Array) -> Array:
        """Control torque tau_c at the current ticks, (num_envs, dof), from the measured or nominal motor."""

    def distance(self, plant: FlexibleJointPlant, scale: Any) -> Array:
        """How far the plant is from the reference, (num_envs,), in units of `scale`.

        Args:
            plant: the joints as they truly are.
            scale: of every joint [m | rad], a number or (dof,); of the tool [m], where it is what follows.
        """

    def desired_links(self, i: int) -> Array | None:
        """Where the links of environment i should be now, (dof,), m or rad; None where the tool's path says it."""


def believed(scenarios: Sequence[Scenario]) -> tuple[Array, Array]:
    """What the controller knows: factor on the true masses (n, 1), and K_j (n, dof)."""
    mass = np.array([[scenario.believed_mass] for scenario in scenarios])
    return mass, np.array([scenario.believed.stiffness for scenario in scenarios])
