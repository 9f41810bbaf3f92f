"""The equations of joints, friction and observers, solved by SciPy: what the tests hold the plant against.

Written from the equations alone; nothing here comes from the package. Parameters are read by attribute name
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
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from scipy.integrate import odeint, solve_ivp

RTOL, ATOL = 1e-10, 1e-13
"""Of every run unless a test says otherwise; `test_reference_is_converged` shows what they are worth."""


SLIDER = """
<mujoco model="slider">
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="carriage">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
    </body>
  </worldbody>
</mujoco>
"""
"""The single link: 1 kg on a slide, without gravity."""


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

    def rates(self, _: float, state: np.ndarray, tau_m: np.ndarray, tau_ext: np.ndarray) -> list[float]:
        q, w, theta, v, z = state.tolist()
        z_rate, tau_f = lugre(v, z, self.friction)
        tau_j = self.joint.stiffness * (theta - q) + self.joint.damping * (v - w)
        w_rate = (tau_j + tau_ext.item()) / self.mass
        return [w, w_rate, v, (tau_m.item() + tau_f - tau_j) / self.joint.motor_inertia, z_rate]


class Arm:
    """A multibody arm: link accelerations from MuJoCo's forward dynamics, motors and bristles from the equations."""

    def __init__(self, path: Path, joint: Any, friction: Any) -> None:
        self.joint, self.friction = joint, friction
        self.model = mujoco.MjModel.from_xml_path(str(path))
        off = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT
        self.model.opt.disableflags |= int(off)
        self.data = mujoco.MjData(self.model)

    def acceleration(self, q: np.ndarray, w: np.ndarray, torque: np.ndarray) -> np.ndarray:
        self.data.qpos[:], self.data.qvel[:], self.data.qfrc_applied[:] = q, w, torque
        mujoco.mj_forward(self.model, self.data)
        return self.data.qacc

    def gravity(self, q: np.ndarray) -> np.ndarray:
        """Torque on the joints that holds the links still at q."""
        self.acceleration(q, np.zeros_like(q), np.zeros_like(q))
        return self.data.qfrc_bias.copy()

    def rates(self, _: float, state: np.ndarray, tau_m: np.ndarray, tau_ext: np.ndarray) -> np.ndarray:
        q, w, theta, v, z = state.reshape(5, -1)
        z_rate, tau_f = lugre(v, z, self.friction, np.exp)
        tau_j = self.joint.stiffness * (theta - q) + self.joint.damping * (v - w)
        w_rate = self.acceleration(q, w, tau_j + tau_ext)
        return np.concatenate([w, w_rate, v, (tau_m + tau_f - tau_j) / self.joint.motor_inertia, z_rate])


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
    start: np.ndarray,
    tau_ext: np.ndarray,
    *,
    method: str = "LSODA",
    rtol: float = RTOL,
    atol: float = ATOL,
) -> np.ndarray:
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


def _period(plant: Any, state: np.ndarray, held: tuple, dt: float, method: str, rtol: float, atol: float) -> np.ndarray:
    x = state.ravel()
    if method == "LSODA":  # `odeint` is the same code as solve_ivp's LSODA, with a loop that is not in Python
        end = odeint(plant.rates, x, [0.0, dt], args=held, rtol=rtol, atol=atol, tfirst=True, tcrit=[dt])[-1]
    else:
        solution = solve_ivp(plant.rates, (0.0, dt), x, method=method, args=held, rtol=rtol, atol=atol)
        assert solution.success, solution.message
        end = solution.y[:, -1]
    return end.reshape(state.shape)


def continuous(plant: SingleLink, gains: Control, times: np.ndarray, rtol: float = 1e-9) -> np.ndarray:
    """Motor angle at `times` under continuous-time control from rest, (len(times),); `gains.dt` plays no part."""
    B = gains.motor_inertia

    def rates(t: float, x: np.ndarray) -> list[float]:
        q, w, theta, v, _, theta_n, w_n, integral = x.tolist()
        e, e_rate = theta_n - theta, w_n - v
        position, velocity = (theta_n, w_n) if gains.nominal else (theta, v)
        tau_c = -gains.k_p * (position - gains.theta_d) - gains.k_d * velocity
        tau_f_hat = -B * gains.L * (e_rate + gains.L_p * e + gains.L_i * integral)
        tau_j = plant.joint.stiffness * (theta - q) + plant.joint.damping * (v - w)
        motion = plant.rates(t, x[:5], np.float64(tau_c - tau_f_hat), np.float64(0.0))
        return [*motion, w_n, (tau_c - tau_j) / B, e]

    solution = odeint(rates, np.zeros(8), times, rtol=rtol, atol=1e-3 * rtol, tfirst=True, mxstep=100_000)
    return solution[:, 2]


def dense_inertia(arm: Arm, q: np.ndarray) -> np.ndarray:
    """M(q) column by column: a unit torque's acceleration less none's is a column of its inverse."""
    still = np.zeros_like(q)
    free = arm.acceleration(q, still, still).copy()
    return np.linalg.inv(np.array([arm.acceleration(q, still, unit) - free for unit in np.eye(len(q))]).T)
