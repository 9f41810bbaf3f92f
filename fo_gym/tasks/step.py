"""A step of the joints: hold, jump, and hold again, under motor PD."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import FINITE, NOT_NEGATIVE, Value, check_values, number
from fo_gym.control.design import designed_pd
from fo_gym.control.motor_pd import MotorPD
from fo_gym.parameters import PDGains, check_joints
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot
from fo_gym.tasks.control import believed, joint_distance
from fo_gym.tasks.scenario import Scenario

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

__all__ = ["Step", "StepControl"]


@dataclass(frozen=True, eq=False)
class Step:
    """The desired links jump once.

    Attributes:
        size: of the jump from the home pose [m | rad], one value for all joints or one for each.
        time: when [s]; 0 starts with it.
    """

    size: Value
    time: float = 0.0

    of_tool = False
    motion_window = None

    def __post_init__(self) -> None:
        check_values(self, size=FINITE)
        number("Step.time", self.time, NOT_NEGATIVE, "s")

    @property
    def step_time(self) -> float:
        """When the target jumps [s]."""
        return self.time

    def fitted_to(self, robot: Robot) -> Step:
        """The same with a size for every joint. Raises ValueError where it has another number of joints."""
        check_joints(self, robot.dof)
        return replace(self, size=np.broadcast_to(np.asarray(self.size, dtype=np.float64), (robot.dof,)))

    def target(self, home: Array, share: Array | float = 1.0) -> Array:
        """Desired links after a step of `share` times the size, (dof,), m or rad."""
        return home + self.size * share

    def designed_gains(self, robot: Robot) -> PDGains:
        """The robot's own PD gains, or designed ones."""
        return robot.pd_gains or designed_pd(robot)

    def control(self, robot: Robot, plant: FlexibleJointPlant, gains: Any) -> StepControl:
        """Motor PD towards the target."""
        return StepControl(self, plant, gains)


class StepControl:
    """Motor PD towards a target that jumps once: q_start before the step, the scenario's target after it."""

    path: Array | None = None

    def __init__(self, step: Step, plant: FlexibleJointPlant, gains: PDGains) -> None:
        shape = (plant.num_envs, plant.dof)
        self._step_tick = round(step.time / plant.control_dt)
        self._plant = plant
        self._law = MotorPD(gains, plant.dof)
        # Before and after the step.
        self._q_d = np.zeros((2, *shape))
        self._theta_d = np.zeros((2, *shape))
        self._gravity = np.zeros((2, *shape))
        self.theta_d = np.zeros(shape)
        self._gravity_d = np.zeros(shape)
        self._after = np.zeros(plant.num_envs, dtype=bool)
        self._stepped = -1
        self.reference = np.zeros((plant.num_envs, 0))

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """See TaskControl."""
        self._stepped = -1
        poses = np.array([[scenario.q_start, scenario.target] for scenario in scenarios])
        mass, stiffness = believed(scenarios)
        for phase in (0, 1):
            q_d = self._q_d[phase, ids] = poses[:, phase]
            self._gravity[phase, ids] = mass * self._plant.body.gravity(q_d, ids)
            self._theta_d[phase, ids] = q_d + self._gravity[phase, ids] / stiffness

    def update(self, ticks: NDArray[np.int64]) -> None:
        """See TaskControl."""
        self._after = ticks >= self._step_tick
        stepped = int(np.count_nonzero(self._after))
        if stepped == self._stepped:
            return  # between two resets time only goes on: the same number of environments are the same ones
        self._stepped = stepped
        self.theta_d = np.where(self._after[:, None], self._theta_d[1], self._theta_d[0])
        self._gravity_d = np.where(self._after[:, None], self._gravity[1], self._gravity[0])

    def torque(self, theta: Array, theta_dot: Array) -> Array:
        """See TaskControl."""
        return self._law.torque(theta, theta_dot, self.theta_d, self._gravity_d)

    def distance(self, plant: FlexibleJointPlant, scale: Any) -> Array:
        """See TaskControl."""
        return joint_distance(plant, self.theta_d, scale)

    def desired_links(self, i: int) -> Array:
        """See TaskControl."""
        links: Array = self._q_d[int(self._after[i]), i]
        return links
