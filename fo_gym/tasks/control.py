"""What every reference is at work on a batch: where it is at each tick, and the torque that follows it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.binding import Binds, Bound
from fo_gym.compiling import jit
from fo_gym.plant import FlexibleJointPlant
from fo_gym.tasks.scenario import Scenario

Array = NDArray[np.float64]
Ids = NDArray[np.intp]
Ticks = NDArray[np.int64]

__all__ = ["CompiledControl", "PathStatics", "TaskControl", "Ticks", "believed", "joint_distance", "path_statics"]


class TaskControl(Binds, ABC):
    """Reference and controller of a batch of episodes; derive from it.

    It remembers nothing between two ticks but what `reset` gave it, since `follow` is asked about other motors, too.
    What is called a place is written into, and never replaced.

    Args:
        num_envs: size of the batch.
        dof: number of joints.
        references: length of the task's reference beside theta_d.

    Attributes:
        theta_d: desired motor position at the ticks of the last `follow`, (num_envs, dof), m or rad; a place.
        reference: the task's reference beside theta_d, (num_envs, references); a place.
        path: where the tool is to go, (points, 3), m; None where no path of the tool is followed.
        ticks: those of the last `follow`, (num_envs,).
    """

    def __init__(self, num_envs: int, dof: int, references: int = 0) -> None:
        self.theta_d, self.reference = np.zeros((num_envs, dof)), np.zeros((num_envs, references))
        self.path: Array | None = None
        self.ticks: Ticks = np.zeros(num_envs, dtype=np.int64)

    @abstractmethod
    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """Take the scenarios of new episodes; the plant has its new parameters already."""

    @abstractmethod
    def follow(self, ticks: Ticks, theta: Array, theta_dot: Array, tau_c: Array) -> None:
        """Move theta_d and reference to these control ticks, and write the torque that follows them.

        Args:
            ticks: (num_envs,); to be kept in `self.ticks`.
            theta, theta_dot: measured or nominal motor, (num_envs, dof), m and m/s | rad and rad/s.
            tau_c: out, control torque, (num_envs, dof), N or N m.
        """

    def torque(self, theta: Array, theta_dot: Array) -> Array:
        """Control torque at the ticks of the last `follow` for other motors than those, (num_envs, dof), N or N m."""
        tau_c = np.empty_like(self.theta_d)
        self.follow(self.ticks, theta, theta_dot, tau_c)
        return tau_c

    @abstractmethod
    def distance(self, plant: FlexibleJointPlant, scale: Any) -> Array:
        """How far the plant is from the reference, (num_envs,), in units of `scale`.

        Args:
            plant: the joints as they truly are.
            scale: of every joint [m | rad], (dof,); of the tool [m], a number, where it is what follows.
        """

    @abstractmethod
    def desired_links(self, i: int) -> Array | None:
        """Where the links of environment i should be now, (dof,), m or rad; None where the tool's path says it."""


class CompiledControl(TaskControl):
    """One whose `follow` is compiled and bound to the arrays that it was given last: mostly they are the same ones."""

    bindings: ClassVar[tuple[str, ...]] = ("_given", "_follows", "_scale", "_distances")

    def __init__(self, plant: FlexibleJointPlant, references: int = 0) -> None:
        super().__init__(plant.num_envs, plant.dof, references)
        self._plant = plant
        self._apart = np.empty(plant.num_envs)

    def bind(self) -> None:
        """See Binds."""
        self._given: tuple[Any, ...] = (None, None, None, None)
        self._scale: Any = None

    @abstractmethod
    def _bound_follow(self, ticks: Ticks, theta: Array, theta_dot: Array, tau_c: Array) -> list[Bound]:
        """What `follow` calls for these arrays, one for each share of the plant's threads."""

    @abstractmethod
    def _bound_distance(self, scale: Any, distance: Array) -> list[Bound]:
        """What `distance` calls for this scale, likewise; the result goes into `distance`."""

    def follow(self, ticks: Ticks, theta: Array, theta_dot: Array, tau_c: Array) -> None:
        """See TaskControl."""
        given = self._given
        if not (ticks is given[0] and theta is given[1] and theta_dot is given[2] and tau_c is given[3]):
            self.ticks, self._given = ticks, (ticks, theta, theta_dot, tau_c)
            self._follows = self._bound_follow(*self._given)
        self._plant.threads.run(self._follows)

    def distance(self, plant: FlexibleJointPlant, scale: Any) -> Array:
        """See TaskControl. The array is the same one every time."""
        if scale is not self._scale:
            self._scale, self._distances = scale, self._bound_distance(scale, self._apart)
        self._plant.threads.run(self._distances)
        return self._apart


def believed(scenarios: Sequence[Scenario]) -> tuple[Array, Array]:
    """What the controller knows: factor on the masses of the robot's file (n,), and K_j (n, dof)."""
    mass = np.array([scenario.mass_scale * scenario.believed_mass for scenario in scenarios])
    return mass, np.array([scenario.believed.stiffness for scenario in scenarios])


@jit
def joint_distance(theta, theta_d, scale, distance, first, last):
    """Root mean square of (theta - theta_d) / scale over the joints, into distance (num_envs,), from first to last."""
    dof = theta.shape[1]
    for i in range(first, last):
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

    Attributes:
        row: of the table, at the current ticks, (num_envs,).
        mass, stiffness: see `believed`, (num_envs,) and (num_envs, dof).
        gravity: g(q_d) with the masses of each episode, (num_envs, dof), N | N m.
        compiled: what `path_statics` knows it by.
    """

    def __init__(self, plant: FlexibleJointPlant, q_d: Array) -> None:
        springs = plant.body.links.gravity(q_d, 0.0)
        table = np.ascontiguousarray(q_d), springs, plant.body.links.gravity(q_d) - springs
        self.mass = np.ones(plant.num_envs)
        self.stiffness = plant.stiffness.copy()
        self.row = np.zeros(plant.num_envs, dtype=np.int64)
        self.gravity = np.zeros((plant.num_envs, plant.dof))
        self.compiled = *table, self.mass, self.stiffness, self.row, self.gravity

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """Take the scenarios of new episodes."""
        self.mass[ids], self.stiffness[ids] = believed(scenarios)


@jit
def path_statics(statics, ticks, theta_d, first, last):
    """Move environments `first` to `last` to these control ticks, and write their desired motors.

    Args:
        statics: what a PathStatics is compiled as.
        ticks: (num_envs,).
        theta_d: out, (num_envs, dof), m | rad.
        first, last: of the environments; `last` is not among them.
    """
    table_q_d, springs, weight, mass, stiffness, row, gravity = statics
    dof = theta_d.shape[1]
    for i in range(first, last):
        row[i] = min(ticks[i], len(table_q_d) - 1)
        for j in range(dof):
            gravity[i, j] = springs[row[i], j] + mass[i] * weight[row[i], j]
            theta_d[i, j] = table_q_d[row[i], j] + gravity[i, j] / stiffness[i, j]
