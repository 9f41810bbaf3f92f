"""Flexible joints with friction on a robot: one control period of the whole plant, batched."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.binding import Binds, Bound, bound
from fo_gym.checks import POSITIVE, instance, number, real, real_array, shown, whole_number
from fo_gym.friction import FrictionLaw
from fo_gym.micro_steps import PhysicsDt, StepAdvice, advise_steps, auto_steps, check_steps, is_auto, micro_steps
from fo_gym.parameters import JOINT, FlexibleJoint, check_joints, packed
from fo_gym.plant.kernel import MOTION, predict, sense
from fo_gym.plant.kernels import kernel_of
from fo_gym.plant.rigid_body import RigidBody
from fo_gym.plant.state import PlantState
from fo_gym.plant.twin import twin_data, twin_model
from fo_gym.robots import LinkSide
from fo_gym.threads import Threads, number_of_threads

Array = NDArray[np.float64]

MAX_ENVS = 100_000
"""Size of a batch at most: half a gigabyte for an arm of seven joints."""

__all__ = ["MAX_ENVS", "FlexibleJointPlant"]


class FlexibleJointPlant(Binds):
    """The batched plant: MuJoCo for the links, the joint kernel for motors, springs and friction.

        M(q) q'' + C(q,q') q' + g(q) = tau_j + tau_ext
        B theta'' + tau_j            = tau_m + tau_f
        tau_j = K_j (theta - q) + D_j (theta' - q')

    M and the bias are evaluated once per control period, at the predicted middle of the period: configuration
    q + q' dt/2 and velocity q' + (q' - q'_before)/2, extrapolated from the period before.

    Args:
        link_side: the links.
        num_envs: size of the batch, at most MAX_ENVS.
        joints: motor and spring of every joint.
        friction: of every joint; its law, and the number of that law's states, are the plant's from then on.
        control_dt: control period [s].
        physics_dt: micro-step [s]; None means min(2e-4, control_dt); it must divide control_dt; "auto" takes the
            longest that follows `joints` and `friction` in the pose of the file, see `fo_gym.micro_steps`.
        num_threads: at most; None asks the environment variable FO_GYM_NUM_THREADS, see `fo_gym.threads`.

    Raises:
        ValueError: a parameter is out of range, or the micro-step is too long for a joint, or too short.
    """

    bindings = ("_predicts", "_moves")

    def __init__(
        self,
        link_side: LinkSide,
        num_envs: int,
        *,
        joints: FlexibleJoint,
        friction: FrictionLaw,
        control_dt: float = 1e-3,
        physics_dt: PhysicsDt = None,
        num_threads: int | None = None,
    ) -> None:
        instance("link_side", link_side, LinkSide)
        instance("joints", joints, FlexibleJoint)
        instance("friction", friction, FrictionLaw)
        self.link_side = link_side
        self.dof = link_side.dof
        self.num_envs = whole_number("num_envs", num_envs, 1, MAX_ENVS)
        self.control_dt = control_dt
        self.threads = Threads(self.num_envs, self.dof, number_of_threads(num_threads))
        self.body = RigidBody(link_side, num_envs, self.threads.shares)
        shape = (num_envs, self.dof)
        self._law = friction
        self._joints = np.empty((*shape, len(JOINT)))
        self._friction = np.empty(shape, friction.dtype)
        self._own_friction = self._friction.copy()
        self._state = np.zeros((len(MOTION) + friction.states, *shape))
        self._before = np.zeros_like(self._state)  # a control period ago
        self._ticks = np.zeros(num_envs, dtype=np.int64)
        self.tau_f = np.zeros(shape)
        """Mean friction torque over the past control period, (num_envs, dof), N or N m."""
        self.link_damping = np.zeros(shape)
        """Of dampers at the links beside the file's from now on, (num_envs, dof), N s/m or N m s/rad, to be set."""
        self.motor_torque = np.zeros(shape)
        """What disturbs the motors beside friction from now on, likewise, N or N m, to be set."""
        self.tau_m, self.tau_ext = np.zeros((2, *shape))  # in the coming period, likewise, to be set
        home = np.broadcast_to(self.body.model.qpos0, shape)
        everyone = np.arange(num_envs)
        self._name_parts()
        self.configure(everyone, joints=joints, friction=friction)
        if is_auto(physics_dt):
            self.steps = auto_steps(self.advise(everyone, home), control_dt)
        else:
            self.steps = micro_steps(control_dt, physics_dt)
        self.physics_dt = control_dt / self.steps
        self.bind()
        self.reset(everyone, home)

    def _name_parts(self) -> None:
        self.q, self.q_dot, self.theta, self.theta_dot, *_ = self._state
        states = self._state[len(MOTION) :]
        self.z = states[0] if len(states) == 1 else np.moveaxis(states, 0, -1)
        self._q_dot_before = self._before[MOTION.index("q_dot")]

    def bind(self) -> None:
        """See Binds."""
        self._name_parts()
        body, kernel, torques = self.body, kernel_of(self._law), (self.tau_m, self.motor_torque, self.tau_ext)
        parameters = body.layout, self._joints, self._friction, self.physics_dt, self.steps, self.tau_f
        before, self._predicts, self._moves = (self._before, self._ticks, self.control_dt), [], []
        for share in body.shares:
            links, place = (*share.outputs, self.link_damping, body.damping), (share.first, share.last)
            self._predicts.append(bound(predict, self._state, *before, *share.inputs, *place))
            self._moves.append(bound(kernel, self._state, torques, links, *parameters, *place))

    @property
    def time(self) -> Array:
        """Time since reset, (num_envs,), s."""
        return np.asarray(self._ticks * self.control_dt)

    @property
    def stiffness(self) -> Array:
        """K_j of every joint, (num_envs, dof), N/m or N m/rad."""
        return self._joints[..., JOINT.index("stiffness")]

    @property
    def motor_inertia(self) -> Array:
        """B of every joint, (num_envs, dof), kg or kg m^2."""
        return self._joints[..., JOINT.index("motor_inertia")]

    def configure(
        self, ids: NDArray[np.intp], *, joints: FlexibleJoint, friction: FrictionLaw, mass_scale: float = 1.0
    ) -> None:
        """Give the named environments these parameters; `mass_scale` multiplies the masses of the file.

        Raises:
            ValueError: the friction is of another law than the plant's.
        """
        self._check_law(friction)
        self._joints[ids] = packed(joints, self.dof)
        self._friction[ids] = self._own_friction[ids] = friction.packed(self.dof)
        self.body.scale_mass(np.full(len(ids), number("mass scale", mass_scale, POSITIVE)), ids)

    def _check_law(self, friction: FrictionLaw) -> None:
        """Raise ValueError where friction is not of the plant's law, or for another number of joints."""
        instance("friction", friction, FrictionLaw)
        check_joints(friction, self.dof)
        if type(friction) is not type(self._law) or friction.dtype != self._law.dtype:
            raise ValueError(
                f"friction is {shown(friction)}; this plant's law is {type(self._law).__name__} with "
                f"{self._law.states} state(s): make another plant for another law"
            )

    def vary_friction(
        self, dry: Array | float, added: Array | float, viscous: Array | float, stiction: Array | float = 0.0
    ) -> None:
        """Friction from now on: that of `configure` with its levels changed, as the law has them.

        Args:
            dry: factor on Coulomb friction and stiction, (num_envs, dof) or a number.
            added: what is then added to both [N | N m], likewise.
            viscous: factor on viscous friction, likewise.
            stiction: what is added to stiction alone [N | N m], likewise.
        """
        type(self._law).vary(self._own_friction, self._friction, dry, added, viscous, stiction)

    def advise(self, ids: NDArray[np.intp], q: Array) -> StepAdvice:
        """The largest micro-step that follows each joint in all of the named environments at q (n, dof), and why."""
        return self._advised(ids, self.body.mobility(q, ids))

    def _advised(self, ids: NDArray[np.intp], mobility: Array) -> StepAdvice:
        return advise_steps(self.link_side.joints, self._joints[ids], mobility, self._law, self._friction[ids])

    def reset(self, ids: NDArray[np.intp], q: Array) -> None:
        """Put the named environments at rest at q (n, dof), in static equilibrium: theta = q + K_j^-1 g(q), z = 0.

        Raises:
            ValueError: q has another shape or is not finite, or the micro-step is too long for a joint there.
        """
        q = real("q", q)
        shape = len(ids), self.dof
        q = np.broadcast_to(real_array("q", q, shape if q.ndim > 1 else shape[1:]), shape)
        mobility = self.body.mobility(q, ids)
        check_steps(self._advised(ids, mobility), physics_dt=self.physics_dt, control_dt=self.control_dt)
        self._state[:, ids] = 0.0
        self._q_dot_before[ids] = 0.0
        self.q[ids] = q
        self.theta[ids] = q + self.body.gravity(q, ids) / self.stiffness[ids]
        self.tau_f[ids] = 0.0
        self._ticks[ids] = 0

    @property
    def damping(self) -> Array:
        """D_j of every joint, (num_envs, dof), N s/m or N m s/rad."""
        return self._joints[..., JOINT.index("damping")]

    @property
    def tau_j(self) -> Array:
        """What the torque sensors measure, K_j (theta - q) + D_j (theta' - q'), (num_envs, dof), N or N m."""
        readings = np.empty((3, *self.q.shape))
        sense(self._state, self._joints, *readings)
        return readings[2]

    def sensors(self, theta: Array, theta_dot: Array, tau_j: Array) -> Bound:
        """What writes into these three arrays, (num_envs, dof) each, what perfect sensors measure when it is called."""
        return bound(sense, self._state, self._joints, theta, theta_dot, tau_j)

    def take(self, tau_m: Array, tau_ext: Array) -> None:
        """Have these arrays, (num_envs, dof) of float64 each, for `tau_m` and `tau_ext` from now on."""
        self.tau_m, self.tau_ext = tau_m, tau_ext
        self.bind()

    def step(self, tau_m: Array, tau_ext: Array) -> None:
        """Advance one control period with motor and external torques held, (num_envs, dof) each, N or N m.

        Raises:
            ValueError: a torque has another shape, or does not hold real numbers.
        """
        torques = {"tau_m": real("tau_m", tau_m), "tau_ext": real("tau_ext", tau_ext)}
        for name, torque in torques.items():
            if torque.shape != self.q.shape:
                raise ValueError(f"{name} has shape {torque.shape}; this plant needs {self.q.shape}")
        self.tau_m[:], self.tau_ext[:] = torques["tau_m"], torques["tau_ext"]
        self.advance()

    def advance(self) -> None:
        """Advance one control period with `tau_m` and `tau_ext` held."""
        self.threads.run(self._predicts)
        self.threads.run(self.body.forwards)
        self.threads.run(self._moves)

    @property
    def finite(self) -> NDArray[np.bool_]:
        """Which environments have a finite state, (num_envs,)."""
        return np.asarray(np.isfinite(self._state).all(axis=(0, 2)))

    @property
    def motion(self) -> Array:
        """The motion as one array, (4 + states, num_envs, dof), rows as in the kernel's MOTION; not a copy."""
        return self._state

    def snapshot(self) -> Array:
        """A copy of `motion`."""
        return self._state.copy()

    def restore(self, i: int) -> None:
        """Put environment i alone back to where it was a control period ago."""
        self._state[:, i] = self._before[:, i]
        self.tau_f[i] = 0.0

    def get_state(self) -> PlantState:
        """A copy of the full state."""
        q, q_dot, theta, theta_dot = self._state[: len(MOTION)].copy()
        return PlantState(q, q_dot, theta, theta_dot, self.z.copy(), self._q_dot_before.copy(), self.time)

    def check_state(self, state: PlantState) -> None:
        """Raise ValueError where `state` is none of this plant, naming the field."""
        instance("state", state, PlantState)
        state.check(self.q.shape, self.z.shape, self.control_dt)

    def set_state(self, state: PlantState) -> None:
        """Continue from a copy of `state`, exactly.

        Raises:
            ValueError: an array has the wrong shape, or does not hold finite real numbers; nothing has changed then.
        """
        self.check_state(state)
        for name in (*MOTION, "z"):
            getattr(self, name)[:] = getattr(state, name)
        self._q_dot_before[:] = state.q_dot_before
        self._ticks[:] = np.rint(np.asarray(state.time) / self.control_dt).astype(np.int64)

    def to_mujoco(
        self, env: int = 0, *, timestep: float = 1e-4, integrator: str = "implicitfast", scene: bool = True
    ) -> tuple[mujoco.MjModel, mujoco.MjData]:
        """The twin: environment `env`, motors, springs and friction included, wholly in MuJoCo, in its present state.

        Open it with `mujoco.viewer.launch(*plant.to_mujoco())`; see `twin_model` for its names. Controls are tau_m,
        external torques go to `data.qfrc_applied`; friction is the force of the actuators "<joint>_friction" and the
        damping of the motors' joints.

        Args:
            env: which environment.
            timestep: MuJoCo's step [s].
            integrator: "euler", "implicit", "implicitfast" or "rk4".
            scene: whether with geoms, cameras and lights; without, it is faster.

        Raises:
            ValueError: no such environment or integrator, a time step that is not above 0, or a law that MuJoCo lacks.
        """
        env = whole_number("env", env, 0, self.num_envs - 1)
        friction = self._friction[env]
        parts = self.link_side, self._joints[env], self._law, friction, self.body.mass_scale[env]
        model = twin_model(*parts, timestep, integrator, scene=scene)
        return model, twin_data(model, self._state[:, env], friction, self.time[env])
