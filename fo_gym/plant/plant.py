"""Flexible joints with LuGre friction on a robot: one control period of the whole plant, batched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.parameters import FlexibleJoint, LuGre, per_joint
from fo_gym.plant.kernel import PARAMETERS, STATE, advance
from fo_gym.plant.rigid_body import RigidBody
from fo_gym.plant.robot import Robot

Array = NDArray[np.float64]

DEFAULT_PHYSICS_DT = 2e-4

__all__ = ["FlexibleJointPlant", "PlantState", "micro_steps"]


def micro_steps(control_dt: float, physics_dt: float | None) -> int:
    """Number of micro-steps in a control period.

    Args:
        control_dt: control period [s], above 0.
        physics_dt: micro-step [s]; None means min(2e-4, control_dt).

    Raises:
        ValueError: a period is not positive, or physics_dt does not divide control_dt (judged to 1e-9).
    """
    if not (np.isfinite(control_dt) and control_dt > 0):
        raise ValueError(f"control_dt is {control_dt} s; it must be finite and above 0")
    if physics_dt is None:
        # The default adapts where 2e-4 does not divide: the largest step below it that does.
        return max(1, int(np.ceil(control_dt / DEFAULT_PHYSICS_DT - 1e-9)))
    if not (np.isfinite(physics_dt) and physics_dt > 0):
        raise ValueError(f"physics_dt is {physics_dt} s; it must be finite and above 0")
    steps = round(control_dt / physics_dt)
    if steps < 1 or abs(steps * physics_dt - control_dt) > 1e-9:
        nearest = control_dt / max(1, steps)
        raise ValueError(f"physics_dt {physics_dt} s does not divide control_dt {control_dt} s; {nearest:.9g} s would")
    return steps


@dataclass
class PlantState:
    """The full state of a plant, bristles included.

    Attributes:
        q, q_dot: links, (num_envs, dof), ju and ju/s.
        theta, theta_dot: motors, (num_envs, dof), ju and ju/s.
        z: bristle deflections, (num_envs, dof), ju.
        time: (num_envs,), s.
    """

    q: Array
    q_dot: Array
    theta: Array
    theta_dot: Array
    z: Array
    time: Array


class FlexibleJointPlant:
    """The batched plant: MuJoCo for the links, the joint kernel for motors, springs and bristles.

        M(q) q'' + C(q,q') q' + g(q) = tau_j + tau_ext
        B theta'' + tau_j            = tau_m + tau_f
        tau_j = K_j (theta - q) + D_j (theta' - q')

    M and the bias are evaluated once per control period, at the predicted middle configuration q + q' dt/2.

    Args:
        robot: the link side.
        num_envs: size of the batch.
        joints: motor and spring of every joint.
        friction: LuGre parameters of every joint.
        control_dt: control period [s].
        physics_dt: micro-step [s]; None means min(2e-4, control_dt); it must divide control_dt.

    Raises:
        ValueError: a parameter is out of range, or the micro-step is too long for the fastest joint.
    """

    def __init__(
        self,
        robot: Robot,
        num_envs: int,
        *,
        joints: FlexibleJoint,
        friction: LuGre,
        control_dt: float = 1e-3,
        physics_dt: float | None = None,
    ) -> None:
        self.robot = robot
        self.num_envs = num_envs
        self.control_dt = control_dt
        self.steps = micro_steps(control_dt, physics_dt)
        self.physics_dt = control_dt / self.steps
        self.body = RigidBody(robot, num_envs)
        shape = (num_envs, robot.dof)
        self._parameters = np.empty((*shape, len(PARAMETERS)))
        self._state = np.zeros((len(STATE), *shape))
        self._ticks = np.zeros(num_envs, dtype=np.int64)
        self.q, self.q_dot, self.theta, self.theta_dot, self.z = self._state
        self.tau_f = np.zeros(shape)
        """Mean friction torque over the past control period, (num_envs, dof), N or N m."""
        home = np.broadcast_to(self.body.model.qpos0, shape)
        everyone = np.arange(num_envs)
        self.configure(everyone, joints=joints, friction=friction)
        self.reset(everyone, home)

    def __setstate__(self, state: dict[str, Any]) -> None:
        # Pickling turns views into copies: make them views of the one state array again.
        self.__dict__.update(state)
        self.q, self.q_dot, self.theta, self.theta_dot, self.z = self._state

    @property
    def time(self) -> Array:
        """Time since reset, (num_envs,), s."""
        return np.asarray(self._ticks * self.control_dt)

    @property
    def stiffness(self) -> Array:
        """K_j of every joint, (num_envs, dof), N/m or N m/rad."""
        return self._parameters[..., PARAMETERS.index("stiffness")]

    @property
    def motor_inertia(self) -> Array:
        """B of every joint, (num_envs, dof), kg or kg m^2."""
        return self._parameters[..., PARAMETERS.index("motor_inertia")]

    def configure(
        self, ids: NDArray[np.intp], *, joints: FlexibleJoint, friction: LuGre, mass_scale: float = 1.0
    ) -> None:
        """Give the named environments these parameters; `mass_scale` multiplies the masses of the file."""
        values = {**vars(per_joint(joints, self.robot.dof)), **vars(per_joint(friction, self.robot.dof))}
        for column, name in enumerate(PARAMETERS):
            self._parameters[ids, :, column] = values[name]
        self.body.scale_mass(np.full(len(ids), mass_scale), ids)

    def reset(self, ids: NDArray[np.intp], q: Array) -> None:
        """Put the named environments at rest at q (n, dof), in static equilibrium: theta = q + K_j^-1 g(q), z = 0.

        Raises:
            ValueError: the micro-step is too long for the fastest joint there.
        """
        q = np.broadcast_to(np.asarray(q, dtype=np.float64), (len(ids), self.robot.dof))
        self._check_steps(ids, q)
        self._state[:, ids] = 0.0
        self.q[ids] = q
        self.theta[ids] = q + self.body.gravity(q, ids) / self.stiffness[ids]
        self.tau_f[ids] = 0.0
        self._ticks[ids] = 0

    def _check_steps(self, ids: NDArray[np.intp], q: Array) -> None:
        """Refuse what the step cannot follow, with the numbers.

        The splitting is stable for h omega < 2; half of that keeps a margin for other poses, and accuracy. The two
        sweeps of the kick settle the springs' damping to 1e-6 where h D_j (1/B + (M^-1)_jj) is below 0.2. The file's
        own dampers are held over a control period, so that they must be slower than it.
        """
        links = np.diagonal(np.linalg.inv(self.body.dense_inertia(q, ids)), axis1=1, axis2=2)
        both = 1.0 / self.motor_inertia[ids] + links
        damping = self._parameters[ids, :, PARAMETERS.index("damping")]
        h, control_dt = ("physics_dt", self.physics_dt), ("control_dt", self.control_dt)
        omega = np.sqrt(self.stiffness[ids] * both)
        self._refuse_long(h, omega, 1.0, "its fastest mode, sqrt(K_j (1/B + (M^-1)_jj))")
        self._refuse_long(h, damping * both, 0.2, "its spring's damping, D_j (1/B + (M^-1)_jj)")
        self._refuse_long(control_dt, self.body.model.dof_damping * links, 1.0, "the file's own damping / M_jj")

    def _refuse_long(self, period: tuple[str, float], rates: Array, limit: float, what: str) -> None:
        """Raise ValueError where a period [s] times a rate (n, dof) [1/s] is above `limit`."""
        name, dt = period
        worst = np.unravel_index(rates.argmax(), rates.shape)
        if not dt * rates[worst] <= limit:
            joint = self.robot.joints[int(worst[1])]
            raise ValueError(
                f"{name} {dt:.3g} s is too long for joint {joint!r}: {what} is {rates[worst]:.4g} 1/s; "
                f"use a {name} of at most {0.99 * limit / rates[worst]:.3g} s, a softer spring or more inertia"
            )

    @property
    def tau_j(self) -> Array:
        """What the torque sensors measure, K_j (theta - q) + D_j (theta' - q'), (num_envs, dof), N or N m."""
        damping = self._parameters[..., PARAMETERS.index("damping")]
        spring: Array = self.stiffness * (self.theta - self.q)
        return spring + damping * (self.theta_dot - self.q_dot)

    def step(self, tau_m: Array, tau_ext: Array) -> None:
        """Advance one control period with motor and external torques held, (num_envs, dof) each, N or N m.

        Raises:
            ValueError: a torque has another shape.
        """
        for name, torque in (("tau_m", tau_m), ("tau_ext", tau_ext)):
            if torque.shape != self.q.shape:
                raise ValueError(f"{name} has shape {torque.shape}; this plant needs {self.q.shape}")
        middle = self.q + (0.5 * self.control_dt) * self.q_dot
        inertia, bias = self.body.dynamics(middle, self.q_dot)
        layout = self.body.layout
        load = tau_ext - bias
        advance(self._state, tau_m, load, inertia, *layout, self._parameters, self.physics_dt, self.steps, self.tau_f)
        self._ticks += 1

    @property
    def finite(self) -> NDArray[np.bool_]:
        """Which environments have a finite state, (num_envs,)."""
        return np.asarray(np.isfinite(self._state).all(axis=(0, 2)))

    def restore(self, i: int, state: PlantState) -> None:
        """Put environment i alone back to where it was in `state`."""
        for row, name in enumerate(STATE):
            self._state[row, i] = getattr(state, name)[i]
        self.tau_f[i] = 0.0

    def get_state(self) -> PlantState:
        """A copy of the full state."""
        q, q_dot, theta, theta_dot, z = self._state.copy()
        return PlantState(q, q_dot, theta, theta_dot, z, self.time)

    def set_state(self, state: PlantState) -> None:
        """Continue from a copy of `state`, exactly.

        Raises:
            ValueError: an array has the wrong shape.
        """
        for row, name in enumerate(STATE):
            value = np.asarray(getattr(state, name))
            if value.shape != self._state[row].shape:
                needed = self._state[row].shape
                raise ValueError(f"PlantState.{name} has shape {value.shape}; this plant needs {needed}")
            self._state[row] = value
        self._ticks[:] = np.rint(np.asarray(state.time) / self.control_dt).astype(np.int64)
