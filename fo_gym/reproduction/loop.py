"""A joint under motor PD and a compensator, with any target and any push: what the environments do not offer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import FRICTION, JOINT
from fo_gym.compensators import Compensator
from fo_gym.control.motor_pd import MotorPD
from fo_gym.control.nominal_motor import NominalMotor
from fo_gym.friction import LuGre
from fo_gym.parameters import FlexibleJoint, JointInfo, PDGains, one_joint
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import robot_of
from fo_gym.signals import Signals

Array = NDArray[np.float64]

LINK = robot_of("single_link")
assert LINK.pd_gains is not None
GAINS: PDGains = one_joint(LINK.pd_gains)

__all__ = ["GAINS", "Motion", "run_loop"]


@dataclass(frozen=True)
class Motion:
    """A batch of the paper's single link in motion; arrays (ticks + 1, n) at ticks, (ticks, n) over periods.

    Attributes:
        dt: control period [s].
        theta, theta_dot, q, q_dot, z, theta_n, theta_n_dot: at the ticks.
        tau_f_hat, tau_f, tau_j, tau_c, tau_m, tau_ext: estimate, mean friction, what was measured and commanded at
            the start of each period, and what pushed the link.
    """

    dt: float
    theta: Array
    theta_dot: Array
    q: Array
    q_dot: Array
    z: Array
    theta_n: Array
    theta_n_dot: Array
    tau_f_hat: Array
    tau_f: Array
    tau_j: Array
    tau_c: Array
    tau_m: Array
    tau_ext: Array

    @property
    def e(self) -> Array:
        """theta_n - theta at the ticks."""
        return np.asarray(self.theta_n - self.theta)

    @property
    def time(self) -> Array:
        """Time of the ticks, (ticks + 1,), s."""
        return np.asarray(self.dt * np.arange(len(self.theta)))


def run_loop(
    compensator: Compensator,
    theta_d: Array,
    tau_ext: Array,
    *,
    dt: float,
    physics_dt: float | None = None,
    joint: FlexibleJoint = JOINT,
    friction: LuGre = FRICTION,
    motor_offset: float = 0.0,
    damper: float = 0.0,
    start: float = 0.0,
) -> Motion:
    """The paper's single link, n times, from rest at `start`.

    Args:
        compensator: whose estimate is subtracted; its `feedback` chooses the motor that the controller sees.
        theta_d: target at every tick, (ticks, n) [m].
        tau_ext: external force on the link over every period, (ticks, n) [N].
        dt: control period [s].
        physics_dt: micro-step [s].
        joint: motor and spring.
        friction: of the motor.
        motor_offset: constant force on the motor that no controller knows of [N].
        damper: on the link, to the world; its force -damper q' is part of tau_ext [N s/m].
        start: position of motor and link at rest [m].
    """
    ticks, n = theta_d.shape
    plant = FlexibleJointPlant(LINK.link_side, n, joints=joint, friction=friction, control_dt=dt, physics_dt=physics_dt)
    everyone = np.arange(n)
    plant.reset(everyone, np.full((n, 1), start))
    nominal, law = NominalMotor(np.zeros((n, 1)), np.zeros((n, 1)), dt), MotorPD(GAINS, 1)
    nominal.reset(everyone, plant.theta, plant.theta_dot)
    limit = np.full((n, 1), np.inf)
    compensator.reset(JointInfo(1, plant.motor_inertia.copy(), plant.stiffness.copy(), limit, dt), n)
    at_tick = ("theta", "theta_dot", "q", "q_dot", "z")
    kept = {name: np.empty((ticks + 1, n)) for name in (*at_tick, "theta_n", "theta_n_dot")}
    held = {name: np.empty((ticks, n)) for name in ("tau_f_hat", "tau_f", "tau_j", "tau_c", "tau_m", "tau_ext")}
    zero, empty, tau_m = np.zeros((n, 1)), np.zeros((n, 0)), plant.tau_j
    for k in range(ticks + 1):
        for name in at_tick:
            kept[name][k] = getattr(plant, name)[:, 0]
        kept["theta_n"][k], kept["theta_n_dot"][k] = nominal.theta[:, 0], nominal.theta_dot[:, 0]
        if k == ticks:
            break
        motor = nominal if compensator.feedback == "nominal" else plant
        target, tau_j = theta_d[k][:, None], plant.tau_j
        tau_c = law.torque(motor.theta, motor.theta_dot, target, zero)
        motors = (plant.theta, plant.theta_dot, tau_j, nominal.theta, nominal.theta_dot)
        signals = Signals(*motors, target, tau_c, tau_m, np.full((n, 1), k * dt), empty)
        tau_f_hat = compensator.estimate(signals)
        tau_m = tau_c - tau_f_hat
        push = tau_ext[k][:, None] - damper * plant.q_dot
        plant.step(tau_m + motor_offset, push)
        nominal.step(tau_c, tau_j, plant.motor_inertia)
        values = (tau_f_hat, plant.tau_f, tau_j, tau_c, tau_m, push)
        for name, value in zip(held, values, strict=True):
            held[name][k] = value[:, 0]
    return Motion(dt=dt, **kept, **held)
