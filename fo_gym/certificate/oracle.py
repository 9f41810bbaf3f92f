"""The equations of joints, friction and observers, solved by SciPy: what the plant is held against.

Written from the equations alone: nothing here comes from the rest of the package, and the rigid body is Pinocchio's,
not MuJoCo's. Parameters are read by attribute name
(stiffness, damping, motor_inertia; sigma_0, sigma_1, sigma_2, f_c, f_s, v_s), so that any holder of them will do.

    M(q) q'' + C(q,q') q' + g(q) = tau_j + tau_ext          z' = v - sigma_0 |v| / g(v) z,   v = theta'
    B theta'' + tau_j            = tau_m + tau_f            g(v) = f_c + (f_s - f_c) exp(-(v/v_s)^2)
    tau_j = K_j (theta - q) + D_j (theta' - q')             tau_f = -(sigma_0 z + sigma_1 z' + sigma_2 v)

The state is one vector of five rows, q, q', theta, theta', z, each with one value per joint.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np
import pinocchio
from numpy.typing import NDArray
from scipy.integrate import odeint, solve_ivp

Array = NDArray[np.float64]

RTOL, ATOL = 1e-10, 1e-13
"""Tolerances of every run unless it says otherwise; two other families of solvers agree with it far below what the
plant is allowed (tests/test_plant_*.py, `test_reference_is_converged`)."""


def lugre(v: Any, z: Any, friction: Any, exp: Callable[[Any], Any] = math.exp) -> tuple[Any, Any]:
    """Bristle rate z' and friction torque tau_f; floats, or arrays with exp=np.exp."""
    ratio = v / friction.v_s
    g = friction.f_c + (friction.f_s - friction.f_c) * exp(-ratio * ratio)
    z_rate = v - friction.sigma_0 * abs(v) / g * z
    return z_rate, -(friction.sigma_0 * z + friction.sigma_1 * z_rate + friction.sigma_2 * v)


@dataclass(frozen=True)
class SingleLink:
    """A link of inertia `mass` without gravity behind one flexible joint."""

    joint: Any
    friction: Any
    mass: float = 1.0

    def rates(self, _: float, state: Array, tau_m: Any, tau_ext: Any) -> list[float]:
        """Rates of the five numbers of the state under held torques."""
        q, w, theta, v, z = state.tolist()
        z_rate, tau_f = lugre(v, z, self.friction)
        tau_j = self.joint.stiffness * (theta - q) + self.joint.damping * (v - w)
        w_rate = (tau_j + tau_ext.item()) / self.mass
        return [w, w_rate, v, (tau_m.item() + tau_f - tau_j) / self.joint.motor_inertia, z_rate]


class Arm:
    """A multibody arm: link accelerations from Pinocchio, motors and bristles from the equations.

    Args:
        robot: MuJoCo's compiled model, read for masses and geometry only: the dynamics are Pinocchio's.
        joint, friction: parameters, scalars or (dof,).
    """

    def __init__(self, robot: mujoco.MjModel, joint: Any, friction: Any) -> None:
        self.joint, self.friction = joint, friction
        self.model = pinocchio_model(robot)
        self._data = self.model.createData()

    def acceleration(self, q: Array, w: Array, torque: Array) -> Array:
        """Link accelerations, (dof,)."""
        return pinocchio.aba(self.model, self._data, q, w, torque)

    def gravity(self, q: Array) -> Array:
        """Torque on the joints that holds the links still at q, (dof,)."""
        return pinocchio.computeGeneralizedGravity(self.model, self._data, q)

    def energy(self, q: Array, w: Array) -> float:
        """Kinetic and potential energy of the links [J]."""
        return float(pinocchio.computeMechanicalEnergy(self.model, self._data, q, w))

    def rates(self, _: float, state: Array, tau_m: Array, tau_ext: Array) -> Array:
        """Rates of the five rows of the state, flat, under held torques (dof,)."""
        q, w, theta, v, z = state.reshape(5, -1)
        z_rate, tau_f = lugre(v, z, self.friction, np.exp)
        tau_j = self.joint.stiffness * (theta - q) + self.joint.damping * (v - w)
        w_rate = self.acceleration(q, w, tau_j + tau_ext)
        return np.concatenate([w, w_rate, v, (tau_m + tau_f - tau_j) / self.joint.motor_inertia, z_rate])


def pinocchio_model(robot: mujoco.MjModel) -> Any:
    """The links as a Pinocchio model, joints in the same order.

    Raises:
        ValueError: a body has several joints.
    """
    model = pinocchio.Model()
    model.gravity.linear = robot.opt.gravity
    place = {0: (0, pinocchio.SE3.Identity())}  # of every body: its Pinocchio joint, and its frame in that joint's
    for body in range(1, robot.nbody):
        if robot.body_jntnum[body] > 1:
            raise ValueError(f"body {robot.body(body).name!r} has several joints; give each a body of its own")
        parent, frame = place[int(robot.body_parentid[body])]
        frame = frame * _frame(robot.body_pos[body], robot.body_quat[body])
        if robot.body_jntnum[body]:
            joint = int(robot.body_jntadr[body])
            anchor = pinocchio.SE3(np.eye(3), robot.jnt_pos[joint])
            hinge = robot.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE
            kind = pinocchio.JointModelRevoluteUnaligned if hinge else pinocchio.JointModelPrismaticUnaligned
            parent = model.addJoint(parent, kind(robot.jnt_axis[joint]), frame * anchor, robot.joint(joint).name)
            frame = anchor.inverse()
        inertia = pinocchio.Inertia(robot.body_mass[body], np.zeros(3), np.diag(robot.body_inertia[body]))
        model.appendBodyToJoint(parent, inertia, frame * _frame(robot.body_ipos[body], robot.body_iquat[body]))
        place[body] = parent, frame
    return model


def _frame(position: Array, quaternion: Array) -> Any:
    """A frame from MuJoCo's position and quaternion (w, x, y, z)."""
    w, x, y, z = quaternion
    return pinocchio.SE3(pinocchio.Quaternion(w, x, y, z).matrix(), position)


@dataclass
class Control:
    """Motor PD, nominal motor and friction observer at a sampling period of `dt`; scalars or arrays throughout.

        tau_c = -k_p (theta_* - theta_d) - k_d theta_*' + feedforward,   theta_* = theta_n if nominal else theta
        tau_f_hat = -B L (e' + L_p e + L_i int e),   e = theta_n - theta
        B theta_n'' + tau_j = tau_c

    L_i = 0 makes it the PD-type, L_p = L_i = 0 Le Tien's observer, L = 0 none.
    """

    dt: float
    motor_inertia: Any = 1.0
    k_p: Any = 50.0
    k_d: Any = 5.0
    theta_d: Any = 0.01
    feedforward: Any = 0.0
    L: Any = 0.0
    L_p: Any = 0.0
    L_i: Any = 0.0
    nominal: Any = False
    theta_n: Any = field(default=0.0)
    w_n: Any = field(default=0.0)
    integral: Any = field(default=0.0)

    def __call__(self, theta: Any, v: Any, tau_j: Any) -> Any:
        """tau_m of this tick from what is measured at it; then the nominal motor and the integral move on by dt."""
        e, e_rate = self.theta_n - theta, self.w_n - v
        estimate = -self.motor_inertia * self.L * (e_rate + self.L_p * e + self.L_i * self.integral)
        position, velocity = theta + self.nominal * e, v + self.nominal * e_rate
        tau_c = -self.k_p * (position - self.theta_d) - self.k_d * velocity + self.feedforward
        acceleration = (tau_c - tau_j) / self.motor_inertia
        self.theta_n = self.theta_n + self.dt * self.w_n + 0.5 * self.dt**2 * acceleration
        self.w_n = self.w_n + self.dt * acceleration
        self.integral = self.integral + self.dt * e
        return tau_c - estimate


def sampled(
    plant: SingleLink | Arm,
    control: Control,
    start: Array,
    tau_ext: Array,
    *,
    method: str = "LSODA",
    rtol: float = RTOL,
    atol: float = ATOL,
) -> Array:
    """States at the ticks, (periods + 1, 5, dof), under sampled control; both torques held, `tau_ext` (periods, dof).

    Every control period is an integration of its own, so that no step of the solver crosses a jump of the torque.
    """
    state = np.array(start, dtype=float)
    history = [state]
    for push in tau_ext:
        q, w, theta, v, _ = state
        tau_j = plant.joint.stiffness * (theta - q) + plant.joint.damping * (v - w)
        tau_m = np.asarray(control(theta, v, tau_j))
        state = _period(plant, state, (tau_m, push), control.dt, method, rtol, atol)
        history.append(state)
    return np.array(history)


def _period(
    plant: Any, state: Array, held: tuple[Array, Array], dt: float, method: Any, rtol: float, atol: float
) -> Array:
    x = state.ravel()
    if method == "LSODA":  # `odeint` is the same code as solve_ivp's LSODA, with a loop that is not in Python
        options: dict[str, Any] = {"rtol": rtol, "atol": atol, "tcrit": [dt], "mxstep": 100_000}
        end = odeint(plant.rates, x, [0.0, dt], args=held, tfirst=True, **options)[-1]
    else:
        solution = solve_ivp(plant.rates, (0.0, dt), x, method=method, args=held, rtol=rtol, atol=atol)
        if not solution.success:
            raise RuntimeError(f"{method}: {solution.message}")
        end = solution.y[:, -1]
    return end.reshape(state.shape)


def continuous(plant: SingleLink, gains: Control, times: Array, rtol: float = 1e-9) -> Array:
    """Motor angle at `times` under continuous-time control from rest, (len(times),); `gains.dt` plays no part."""
    B = gains.motor_inertia

    def _rates(t: float, x: Array) -> list[float]:
        q, w, theta, v, _, theta_n, w_n, integral = x.tolist()
        e, e_rate = theta_n - theta, w_n - v
        position, velocity = (theta_n, w_n) if gains.nominal else (theta, v)
        tau_c = -gains.k_p * (position - gains.theta_d) - gains.k_d * velocity
        tau_f_hat = -B * gains.L * (e_rate + gains.L_p * e + gains.L_i * integral)
        tau_j = plant.joint.stiffness * (theta - q) + plant.joint.damping * (v - w)
        motion = plant.rates(t, x[:5], np.float64(tau_c - tau_f_hat), np.float64(0.0))
        return [*motion, w_n, (tau_c - tau_j) / B, e]

    solution = odeint(_rates, np.zeros(8), times, rtol=rtol, atol=1e-3 * rtol, tfirst=True, mxstep=100_000)
    return solution[:, 2]
