"""Flexible joints with LuGre friction on a robot: one control period of the whole plant, batched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, instance, number, real, real_array, shown, whole_number
from fo_gym.micro_steps import PhysicsDt, StepAdvice, advise_steps, auto_steps, check_steps, is_auto, micro_steps
from fo_gym.parameters import PARAMETERS, FlexibleJoint, LuGre, packed
from fo_gym.plant.kernel import STATE, advance, predict, spring_torque
from fo_gym.plant.rigid_body import RigidBody
from fo_gym.plant.twin import twin_model
from fo_gym.robots import LinkSide

Array = NDArray[np.float64]

MAX_ENVS = 100_000
"""Size of a batch at most: half a gigabyte for an arm of seven joints."""

_FRICTION = [PARAMETERS.index(name) for name in ("sigma_2", "f_c", "f_s")]

__all__ = ["MAX_ENVS", "FlexibleJointPlant", "PlantState"]


@dataclass
class PlantState:
    """The full state of a plant, bristles included.

    Attributes:
        q, q_dot: links, (num_envs, dof), m and m/s | rad and rad/s.
        theta, theta_dot: motors, (num_envs, dof), m and m/s | rad and rad/s.
        z: bristle deflections, (num_envs, dof), m | rad.
        q_dot_before: link velocities one control period ago, (num_envs, dof), m/s | rad/s.
        time: (num_envs,), s.
    """

    q: Array
    q_dot: Array
    theta: Array
    theta_dot: Array
    z: Array
    q_dot_before: Array
    time: Array


class FlexibleJointPlant:
    """The batched plant: MuJoCo for the links, the joint kernel for motors, springs and bristles.

        M(q) q'' + C(q,q') q' + g(q) = tau_j + tau_ext
        B theta'' + tau_j            = tau_m + tau_f
        tau_j = K_j (theta - q) + D_j (theta' - q')

    M and the bias are evaluated once per control period, at the predicted middle of the period: configuration
    q + q' dt/2 and velocity q' + (q' - q'_before)/2, extrapolated from the period before.

    Args:
        link_side: the links.
        num_envs: size of the batch, at most MAX_ENVS.
        joints: motor and spring of every joint.
        friction: LuGre parameters of every joint.
        control_dt: control period [s].
        physics_dt: micro-step [s]; None means min(2e-4, control_dt); it must divide control_dt; "auto" takes the
            longest that follows `joints` and `friction` in the pose of the file, see `fo_gym.micro_steps`.

    Raises:
        ValueError: a parameter is out of range, or the micro-step is too long for a joint, or too short.
    """

    def __init__(
        self,
        link_side: LinkSide,
        num_envs: int,
        *,
        joints: FlexibleJoint,
        friction: LuGre,
        control_dt: float = 1e-3,
        physics_dt: PhysicsDt = None,
    ) -> None:
        instance("link_side", link_side, LinkSide)
        instance("joints", joints, FlexibleJoint)
        instance("friction", friction, LuGre)
        self.link_side = link_side
        self.dof = link_side.dof
        self.num_envs = whole_number("num_envs", num_envs, 1, MAX_ENVS)
        self.control_dt = control_dt
        self.body = RigidBody(link_side, num_envs)
        shape = (num_envs, self.dof)
        self._parameters = np.empty((*shape, len(PARAMETERS)))
        self._friction = np.empty((*shape, len(_FRICTION)))
        self._state = np.zeros((len(STATE), *shape))
        self._q_dot_before = np.zeros(shape)
        self._ticks = np.zeros(num_envs, dtype=np.int64)
        self.q, self.q_dot, self.theta, self.theta_dot, self.z = self._state
        self.tau_f = np.zeros(shape)
        """Mean friction torque over the past control period, (num_envs, dof), N or N m."""
        self.link_damping = np.zeros(shape)
        """Of dampers at the links beside the file's from now on, (num_envs, dof), N s/m or N m s/rad, to be set."""
        home = np.broadcast_to(self.body.model.qpos0, shape)
        everyone = np.arange(num_envs)
        self.configure(everyone, joints=joints, friction=friction)
        if is_auto(physics_dt):
            self.steps = auto_steps(self.advise(everyone, home), control_dt)
        else:
            self.steps = micro_steps(control_dt, physics_dt)
        self.physics_dt = control_dt / self.steps
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
        self._parameters[ids] = packed(joints, friction, self.dof)
        self._friction[ids] = self._parameters[ids][..., _FRICTION]
        self.body.scale_mass(np.full(len(ids), number("mass scale", mass_scale, POSITIVE)), ids)

    def vary_friction(self, dry: Array | float, added: Array | float, viscous: Array | float) -> None:
        """Friction from now on: f_c and f_s of `configure` times `dry` plus `added`, its sigma_2 times `viscous`.

        Args:
            dry, viscous: factors, (num_envs, dof) or numbers.
            added: [N | N m], likewise.
        """
        own = self._friction
        values = (viscous * own[..., 0], dry * own[..., 1] + added, dry * own[..., 2] + added)
        for column, value in zip(_FRICTION, values, strict=True):
            self._parameters[..., column] = value

    def advise(self, ids: NDArray[np.intp], q: Array) -> StepAdvice:
        """The largest micro-step that follows each joint in all of the named environments at q (n, dof), and why."""
        return advise_steps(self.link_side.joints, self._parameters[ids], self.body.mobility(q, ids))

    def reset(self, ids: NDArray[np.intp], q: Array) -> None:
        """Put the named environments at rest at q (n, dof), in static equilibrium: theta = q + K_j^-1 g(q), z = 0.

        Raises:
            ValueError: q has another shape or is not finite, or the micro-step is too long for a joint there.
        """
        q = real("q", q)
        shape = len(ids), self.dof
        q = np.broadcast_to(real_array("q", q, shape if q.ndim > 1 else shape[1:]), shape)
        mobility = self.body.mobility(q, ids)
        check_steps(
            advise_steps(self.link_side.joints, self._parameters[ids], mobility),
            physics_dt=self.physics_dt,
            control_dt=self.control_dt,
        )
        self._state[:, ids] = 0.0
        self._q_dot_before[ids] = 0.0
        self.q[ids] = q
        self.theta[ids] = q + self.body.gravity(q, ids) / self.stiffness[ids]
        self.tau_f[ids] = 0.0
        self._ticks[ids] = 0

    @property
    def damping(self) -> Array:
        """D_j of every joint, (num_envs, dof), N s/m or N m s/rad."""
        return self._parameters[..., PARAMETERS.index("damping")]

    @property
    def tau_j(self) -> Array:
        """What the torque sensors measure, K_j (theta - q) + D_j (theta' - q'), (num_envs, dof), N or N m."""
        tau_j = np.empty_like(self.q)
        spring_torque(self._state, self._parameters, tau_j)
        return tau_j

    def step(self, tau_m: Array, tau_ext: Array) -> None:
        """Advance one control period with motor and external torques held, (num_envs, dof) each, N or N m.

        Raises:
            ValueError: a torque has another shape, or does not hold real numbers.
        """
        tau_m, tau_ext = real("tau_m", tau_m), real("tau_ext", tau_ext)
        for name, torque in (("tau_m", tau_m), ("tau_ext", tau_ext)):
            if torque.shape != self.q.shape:
                raise ValueError(f"{name} has shape {torque.shape}; this plant needs {self.q.shape}")
        predict(self._state, self._q_dot_before, self.control_dt, *self.body.inputs)
        inertia, bias = self.body.forward()
        links = tau_ext - bias, self.link_damping + self.body.damping, inertia, *self.body.layout
        advance(self._state, tau_m, *links, self._parameters, self.physics_dt, self.steps, self.tau_f)
        self._ticks += 1

    @property
    def finite(self) -> NDArray[np.bool_]:
        """Which environments have a finite state, (num_envs,)."""
        return np.asarray(np.isfinite(self._state).all(axis=(0, 2)))

    @property
    def motion(self) -> Array:
        """The motion as one array, (5, num_envs, dof), rows as in the kernel's STATE; not a copy."""
        return self._state

    def snapshot(self) -> Array:
        """A copy of `motion`."""
        return self._state.copy()

    def restore(self, i: int, snapshot: Array) -> None:
        """Put environment i alone back to where it was at `snapshot`."""
        self._state[:, i] = snapshot[:, i]
        self._q_dot_before[i] = self.q_dot[i]
        self.tau_f[i] = 0.0

    def get_state(self) -> PlantState:
        """A copy of the full state."""
        q, q_dot, theta, theta_dot, z = self._state.copy()
        return PlantState(q, q_dot, theta, theta_dot, z, self._q_dot_before.copy(), self.time)

    def check_state(self, state: PlantState) -> None:
        """Raise ValueError where `state` is none of this plant, naming the field."""
        instance("state", state, PlantState)
        for name in (*STATE, "q_dot_before"):
            real_array(f"PlantState.{name}", getattr(state, name), self.q.shape)
        time = real_array("PlantState.time", state.time, (self.num_envs,), NOT_NEGATIVE)
        if not np.allclose(np.rint(time / self.control_dt) * self.control_dt, time, rtol=1e-9, atol=1e-9):
            raise ValueError(
                f"PlantState.time is {shown(time)} s; these are no whole control periods of {self.control_dt:g} s: "
                "make the plant with the control_dt of the one that gave the state"
            )

    def set_state(self, state: PlantState) -> None:
        """Continue from a copy of `state`, exactly.

        Raises:
            ValueError: an array has the wrong shape, or does not hold finite real numbers; nothing has changed then.
        """
        self.check_state(state)
        for name, own in zip(STATE, self._state, strict=True):
            own[:] = getattr(state, name)
        self._q_dot_before[:] = state.q_dot_before
        self._ticks[:] = np.rint(np.asarray(state.time) / self.control_dt).astype(np.int64)

    def to_mujoco(
        self, env: int = 0, *, timestep: float = 1e-4, integrator: str = "implicitfast"
    ) -> tuple[mujoco.MjModel, mujoco.MjData]:
        """The twin: environment `env`, motors, springs and friction included, wholly in MuJoCo, in its present state.

        Open it with `mujoco.viewer.launch(*plant.to_mujoco())`; see `twin_model` for its names. Controls are tau_m,
        external torques go to `data.qfrc_applied`; friction is the force of the actuators "<joint>_friction" and the
        damping of the motors' joints.

        Args:
            env: which environment.
            timestep: MuJoCo's step [s].
            integrator: "euler", "implicit", "implicitfast" or "rk4".

        Raises:
            ValueError: no such environment or integrator, or a time step that is not above 0.
        """
        env = whole_number("env", env, 0, self.num_envs - 1)
        values = dict(zip(PARAMETERS, self._parameters[env].T, strict=True))
        model = twin_model(self.link_side, values, self.body.mass_scale[env], timestep, integrator)
        data = mujoco.MjData(model)
        data.qpos[:] = np.concatenate([self.q[env], self.theta[env]])
        data.qvel[:] = np.concatenate([self.q_dot[env], self.theta_dot[env]])
        data.act[:] = self.z[env, values["sigma_0"] > 0.0]
        data.time = self.time[env]
        mujoco.mj_forward(model, data)
        return model, data
