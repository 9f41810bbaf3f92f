"""A step of the joints: hold, jump, and hold again, under motor PD."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.binding import Bound, bound
from fo_gym.checks import FINITE, NOT_NEGATIVE, Value, check_values, number
from fo_gym.compiling import jit
from fo_gym.control.design import designed_pd
from fo_gym.control.motor_pd import MotorPD, pd_torque
from fo_gym.parameters import PDGains, check_joints
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot
from fo_gym.tasks.control import CompiledControl, believed, joint_distance
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


class StepControl(CompiledControl):
    """Motor PD towards a target that jumps once: q_start before the step, the scenario's target after it."""

    def __init__(self, step: Step, plant: FlexibleJointPlant, gains: PDGains) -> None:
        super().__init__(plant)
        self._step_tick = round(step.time / plant.control_dt)
        self._law = MotorPD(gains, plant.dof)
        # Before and after the step.
        self._q_d, self._theta_d, self._gravity = np.zeros((3, 2, plant.num_envs, plant.dof))
        self.bind()

    def _bound_follow(self, *given: Any) -> list[Bound]:
        law = self._step_tick, self._theta_d, self._gravity, self._law.kp, self._law.kd
        return [bound(_follow, *law, self.theta_d, *given, *share) for share in self._plant.threads.shares]

    def _bound_distance(self, scale: Any, distance: Array) -> list[Bound]:
        both = self._plant.theta, self.theta_d
        return [bound(joint_distance, *both, scale, distance, *share) for share in self._plant.threads.shares]

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """See TaskControl."""
        poses = np.array([[scenario.q_start, scenario.target] for scenario in scenarios])
        mass, stiffness = believed(scenarios)
        for phase in (0, 1):
            q_d = self._q_d[phase, ids] = poses[:, phase]
            self._gravity[phase, ids] = self._plant.body.links.gravity(q_d, mass)
            self._theta_d[phase, ids] = q_d + self._gravity[phase, ids] / stiffness

    def desired_links(self, i: int) -> Array:
        """See TaskControl."""
        links: Array = self._q_d[int(self.ticks[i] >= self._step_tick), i]
        return links


@jit
def _follow(step_tick, phase_theta_d, phase_gravity, kp, kd, theta_d, ticks, theta, theta_dot, tau_c, first, last):
    for i in range(first, last):
        phase = 1 if ticks[i] >= step_tick else 0
        for j in range(theta_d.shape[1]):
            theta_d[i, j], gravity = phase_theta_d[phase, i, j], phase_gravity[phase, i, j]
            tau_c[i, j] = pd_torque(theta[i, j], theta_dot[i, j], theta_d[i, j], gravity, kp[j], kd[j])
