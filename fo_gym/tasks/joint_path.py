"""A path of the joints: sinusoids with reversals, under motor PD."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.binding import Bound, bound
from fo_gym.checks import FINITE, NOT_NEGATIVE, POSITIVE, Value, check_numbers, check_values
from fo_gym.compiling import jit
from fo_gym.control.design import designed_pd
from fo_gym.control.motor_pd import MotorPD, pd_torque
from fo_gym.parameters import PDGains, check_joints
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot
from fo_gym.tasks.control import CompiledControl, PathStatics, joint_distance, path_statics
from fo_gym.tasks.joint_fit import fitted_sinusoids
from fo_gym.tasks.kinematics import path_ticks
from fo_gym.tasks.scenario import Scenario

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

__all__ = ["JointPath", "JointPathControl"]


@dataclass(frozen=True, eq=False)
class JointPath:
    """Every joint swings about its home: q_d = home + s(t) amplitude sin(2 pi frequency t + phase).

    The envelope s swells from 0 to 1 and, before the end, back to 0, as 10 x^3 - 15 x^4 + 6 x^5: the motion starts and
    ends at rest, at home, and is smooth up to acceleration. One value stands for all joints.

    Attributes:
        duration: time of the whole motion [s].
        swell: time in which it swells, and dies away [s]; at most half of `duration`.
        amplitude: [m | rad]; None for what suits the robot.
        frequency: [Hz]; None likewise.
        phase: [rad]; None likewise.
    """

    duration: float
    swell: float = 2.0
    amplitude: Value | None = None
    frequency: Value | None = None
    phase: Value | None = None

    of_tool = False
    step_time = None

    def __post_init__(self) -> None:
        check_numbers(self, duration=POSITIVE, swell=POSITIVE)
        if self.swell > 0.5 * self.duration:
            raise ValueError(
                f"JointPath.swell is {self.swell:g} s; a motion of {self.duration:g} s has at most "
                f"{0.5 * self.duration:g} s to swell"
            )
        bounds = {"amplitude": NOT_NEGATIVE, "frequency": POSITIVE, "phase": FINITE}
        check_values(self, **{name: bound for name, bound in bounds.items() if getattr(self, name) is not None})

    @property
    def motion_window(self) -> tuple[float, float]:
        """(start, end) [s] in which it moves."""
        return 0.0, self.duration

    def fitted_to(self, robot: Robot) -> JointPath:
        """The same with a value for every joint, what was left open chosen for the robot.

        Raises:
            ValueError: it has another number of joints, or its torque limits leave no room to move.
        """
        check_joints(self, robot.dof)
        given = (self.amplitude, self.frequency, self.phase)
        spread = [None if value is None else np.broadcast_to(value, robot.dof) for value in given]
        amplitude, frequency, phase = fitted_sinusoids(robot, *spread)
        return replace(self, amplitude=amplitude, frequency=frequency, phase=phase)

    def target(self, home: Array, share: Array | float = 1.0) -> None:
        """None: the path says where the links go."""

    def designed_gains(self, robot: Robot) -> PDGains:
        """The robot's own PD gains, or designed ones."""
        return robot.pd_gains or designed_pd(robot)

    def control(self, robot: Robot, plant: FlexibleJointPlant, gains: Any) -> JointPathControl:
        """Motor PD along the path."""
        return JointPathControl(self, robot, plant, gains)

    def at(self, time: Array) -> tuple[Array, Array]:
        """Offset from home [m | rad] and its velocity [m/s | rad/s] at `time` (n,) [s], (n, dof) each."""
        if self.amplitude is None or self.frequency is None or self.phase is None:
            raise ValueError("JointPath has no amplitude, frequency or phase yet; give them, or use fitted_to(robot)")
        time = np.asarray(time, dtype=np.float64)[:, None]
        inside = np.minimum(time, self.duration - time)
        x = np.clip(inside / self.swell, 0.0, 1.0)
        envelope = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
        swelling = 30.0 * x**2 * (1.0 - x) ** 2 / self.swell * np.where(time < 0.5 * self.duration, 1.0, -1.0)
        rate = 2.0 * np.pi * np.asarray(self.frequency)
        swing, velocity = np.sin(rate * time + self.phase), rate * np.cos(rate * time + self.phase)
        return self.amplitude * envelope * swing, self.amplitude * (envelope * velocity + swelling * swing)


class JointPathControl(CompiledControl):
    """tau_c = -K_p (theta_* - theta_d) - K_d (theta_*' - q_d') + g(q_d), theta_d = q_d + K_j^-1 g(q_d).

    q_d' stands for theta_d': the spring's own deflection changes slower by dg/dq / K_j.
    """

    def __init__(self, path: JointPath, robot: Robot, plant: FlexibleJointPlant, gains: PDGains) -> None:
        super().__init__(plant)
        ticks = path_ticks(path.duration, plant.control_dt)
        offset, self._velocity = path.at(np.arange(ticks, dtype=np.float64) * plant.control_dt)
        self._q_d = robot.home + offset
        self._law = MotorPD(gains, robot.dof)
        self._statics = PathStatics(plant, self._q_d)
        self.bind()

    def _bound_follow(self, *given: Any) -> list[Bound]:
        law = self._statics.compiled, self._velocity, self._law.kp, self._law.kd
        return [bound(_follow, *law, self.theta_d, *given, *share) for share in self._plant.threads.shares]

    def _bound_distance(self, scale: Any, distance: Array) -> list[Bound]:
        both = self._plant.theta, self.theta_d
        return [bound(joint_distance, *both, scale, distance, *share) for share in self._plant.threads.shares]

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """See TaskControl."""
        self._statics.reset(ids, scenarios)

    def desired_links(self, i: int) -> Array:
        """See TaskControl."""
        links: Array = self._q_d[self._statics.row[i]]
        return links


@jit
def _follow(statics, velocity, kp, kd, theta_d, ticks, theta, theta_dot, tau_c, first, last):
    path_statics(statics, ticks, theta_d, first, last)
    row, gravity = statics[-2:]
    for i in range(first, last):
        for j in range(theta_d.shape[1]):
            rate = theta_dot[i, j] - velocity[row[i], j]
            tau_c[i, j] = pd_torque(theta[i, j], rate, theta_d[i, j], gravity[i, j], kp[j], kd[j])
