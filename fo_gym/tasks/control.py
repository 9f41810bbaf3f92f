"""A task at work on a batch: the reference of every environment at its tick, and the torque that follows it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import shown
from fo_gym.control.impedance import Impedance, TaskSetpoint
from fo_gym.control.motor_pd import MotorPD
from fo_gym.parameters import ImpedanceGains, PDGains
from fo_gym.plant import FlexibleJointPlant, Robot
from fo_gym.robots.poses import tool_rows
from fo_gym.tasks.path import PathTable, SquarePath, path_table
from fo_gym.tasks.scenario import Scenario
from fo_gym.tasks.task import Task

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

REDUNDANT = ("joint3",)
"""Redundant joint of the shipped arm."""

__all__ = ["PathControl", "StepControl", "TaskControl", "make_control"]


class TaskControl(Protocol):
    """Reference and controller of a batch of episodes.

    Attributes:
        theta_d: desired motor position at the current ticks, (num_envs, dof), m or rad.
        reference: the task's reference beside theta_d, (num_envs, k); k = 0 where there is none.
    """

    theta_d: Array
    reference: Array

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """Take the scenarios of new episodes; the plant has its new parameters already."""

    def update(self, ticks: NDArray[np.int64]) -> None:
        """Move the reference to these control ticks, (num_envs,)."""

    def torque(self, theta: Array, theta_dot: Array) -> Array:
        """Control torque tau_c at the current ticks, (num_envs, dof), from the measured or nominal motor."""

    def distance(self, plant: FlexibleJointPlant) -> Array:
        """How far the plant is from the reference, (num_envs,), in m | rad (root mean square), or m of the tool."""


class StepControl:
    """Motor PD towards a target that jumps once: q_start before the step, the scenario's target after it."""

    def __init__(self, task: Task, plant: FlexibleJointPlant, gains: PDGains) -> None:
        shape = (plant.num_envs, plant.robot.dof)
        assert task.step_time is not None
        self._step_tick = round(task.step_time / plant.control_dt)
        self._plant = plant
        self._law = MotorPD(gains, plant.robot.dof)
        # Before and after the step.
        self._theta_d = np.zeros((2, *shape))
        self._gravity = np.zeros((2, *shape))
        self.theta_d = np.zeros(shape)
        self._gravity_d = np.zeros(shape)
        self._stepped = -1
        self.reference = np.zeros((plant.num_envs, 0))

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """See TaskControl."""
        self._stepped = -1
        poses = np.array([[scenario.q_start, scenario.target] for scenario in scenarios])
        mass, stiffness = _believed(scenarios)
        for phase in (0, 1):
            q_d = poses[:, phase]
            self._gravity[phase, ids] = mass * self._plant.body.gravity(q_d, ids)
            self._theta_d[phase, ids] = q_d + self._gravity[phase, ids] / stiffness

    def update(self, ticks: NDArray[np.int64]) -> None:
        """See TaskControl."""
        after = ticks >= self._step_tick
        stepped = int(np.count_nonzero(after))
        if stepped == self._stepped:
            return  # between two resets time only goes on: the same number of environments are the same ones
        self._stepped = stepped
        self.theta_d = np.where(after[:, None], self._theta_d[1], self._theta_d[0])
        self._gravity_d = np.where(after[:, None], self._gravity[1], self._gravity[0])

    def torque(self, theta: Array, theta_dot: Array) -> Array:
        """See TaskControl."""
        return self._law.torque(theta, theta_dot, self.theta_d, self._gravity_d)

    def distance(self, plant: FlexibleJointPlant) -> Array:
        """See TaskControl."""
        error = plant.theta - self.theta_d
        return np.sqrt(np.add.reduce(error * error, axis=1) / error.shape[1])


def _believed(scenarios: Sequence[Scenario]) -> tuple[Array, Array]:
    """What the controller knows: factor on the true masses (n, 1), and K_j (n, dof)."""
    mass = np.array([[scenario.believed_mass] for scenario in scenarios])
    return mass, np.array([scenario.believed.stiffness for scenario in scenarios])


@lru_cache(maxsize=8)
def _cached_table(robot: Robot, path: SquarePath, q_start: tuple[float, ...], dt: float) -> PathTable:
    return path_table(robot, path, np.array(q_start), dt, REDUNDANT)


class PathControl:
    """Impedance along a tool path."""

    def __init__(self, task: Task, plant: FlexibleJointPlant, gains: ImpedanceGains) -> None:
        assert task.path is not None
        self.table = _cached_table(plant.robot, task.path, tuple(task.q_start.tolist()), plant.control_dt)
        self._plant = plant
        held = [plant.robot.joints.index(name) for name in REDUNDANT]
        self._law = Impedance(gains, plant.body, held, oriented=tool_rows(plant.robot.dof) == 6)
        self._mass_scale = np.ones((plant.num_envs, 1))
        self._mass = np.ones((plant.num_envs, 1))
        self._stiffness = plant.stiffness.copy()
        self._row = np.zeros(plant.num_envs, dtype=np.int64)
        self.theta_d = np.zeros((plant.num_envs, plant.robot.dof))
        self.reference = np.zeros((plant.num_envs, 3))

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """See TaskControl."""
        self._mass[ids], self._stiffness[ids] = _believed(scenarios)
        self._mass_scale[ids, 0] = [scenario.mass_scale for scenario in scenarios]
        self._mass_scale[ids] *= self._mass[ids]

    def update(self, ticks: NDArray[np.int64]) -> None:
        """See TaskControl."""
        self._row = np.minimum(ticks, len(self.table.q_d) - 1)
        gravity = self.table.gravity[self._row] * self._mass_scale
        self.theta_d = self.table.q_d[self._row] + gravity / self._stiffness
        self.reference = self.table.position[self._row]

    def torque(self, theta: Array, theta_dot: Array) -> Array:
        """See TaskControl."""
        table = self.table
        setpoint = TaskSetpoint(self.reference, table.velocity[self._row], table.rotation, table.held)
        return self._law.torque(theta, theta_dot, self._stiffness, self._mass, setpoint)

    def distance(self, plant: FlexibleJointPlant) -> Array:
        """See TaskControl."""
        error = plant.body.tool_position(plant.q) - self.reference
        return np.sqrt(np.add.reduce(error * error, axis=1))


def make_control(task: Task, plant: FlexibleJointPlant, gains: PDGains | ImpedanceGains) -> TaskControl:
    """The task's reference and controller for a plant.

    Raises:
        ValueError: the gains are of the other kind than the task's controller takes.
    """
    expected = type(task.gains)
    if not isinstance(gains, expected):
        raise ValueError(f"gains is {shown(gains)}; this task's controller takes {expected.__name__}(...)")
    if isinstance(gains, ImpedanceGains):
        return PathControl(task, plant, gains)
    return StepControl(task, plant, gains)
