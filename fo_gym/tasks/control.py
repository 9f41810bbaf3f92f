"""What every reference is at work on a batch: where it is at each tick, and the torque that follows it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fo_gym.plant import FlexibleJointPlant
from fo_gym.tasks.scenario import Scenario

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

__all__ = ["PathStatics", "TaskControl", "believed", "joint_distance"]


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


def joint_distance(plant: FlexibleJointPlant, theta_d: Array, scale: Any) -> Array:
    """Root mean square of (theta - theta_d) / scale over the joints, (num_envs,)."""
    distance = np.empty(len(theta_d))
    _distance(plant.theta, theta_d, np.full(theta_d.shape[1], scale), distance)
    return distance


@njit(cache=True, error_model="numpy")
def _distance(theta, theta_d, scale, distance):
    num_envs, dof = theta.shape
    for i in range(num_envs):
        squares = 0.0
        for j in range(dof):
            error = (theta[i, j] - theta_d[i, j]) / scale[j]
            squares += error * error
        distance[i] = math.sqrt(squares / dof)


class PathStatics:
    """Where the motors should be on a tabulated path, theta_d = q_d + K_j^-1 g(q_d), with what the controller knows.

    Args:
        plant: the batch.
        q_d: desired links at every tick, (ticks, dof), m | rad; the last row holds for ever.
        gravity: g(q_d) with the masses of the file, (ticks, dof), N | N m.

    Attributes:
        row: of the table, at the current ticks, (num_envs,).
        theta_d: desired motors, (num_envs, dof), m | rad.
        mass, stiffness: factor on the true masses (num_envs, 1), and K_j (num_envs, dof), as the controller knows them.
        gravity: g(q_d) with the masses of each episode, (num_envs, dof), N | N m.
    """

    def __init__(self, plant: FlexibleJointPlant, q_d: Array, gravity: Array) -> None:
        self._q_d, self._gravity = q_d, gravity
        self._mass_scale = np.ones((plant.num_envs, 1))
        self.mass = np.ones((plant.num_envs, 1))
        self.stiffness = plant.stiffness.copy()
        self.update(np.zeros(plant.num_envs, dtype=np.int64))

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """Take the scenarios of new episodes."""
        self.mass[ids], self.stiffness[ids] = believed(scenarios)
        self._mass_scale[ids, 0] = [scenario.mass_scale for scenario in scenarios]
        self._mass_scale[ids] *= self.mass[ids]

    def update(self, ticks: NDArray[np.int64]) -> None:
        """Move to these control ticks, (num_envs,)."""
        self.row = np.minimum(ticks, len(self._q_d) - 1)
        self.gravity = self._gravity[self.row] * self._mass_scale
        self.theta_d = self._q_d[self.row] + self.gravity / self.stiffness
