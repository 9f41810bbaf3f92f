"""Cases that the plant and the solver both run: a robot from rest, under sampled control, with a push."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.oracle import Arm, Control, SingleLink
from fo_gym.friction import LuGre
from fo_gym.parameters import FlexibleJoint, one_joint, per_joint
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import LinkSide, robot_of

Array = NDArray[np.float64]

PERIOD = 1e-3
"""Control period of every case [s]."""

ARM = robot_of("miro_like")
_SINGLE = robot_of("single_link")
LINK = _SINGLE.link_side
JOINT: FlexibleJoint = one_joint(_SINGLE.flexible)
FRICTION: LuGre = one_joint(_SINGLE.friction)
"""The paper's single link."""

TWO_LINK = LinkSide(Path(__file__).with_name("two_link.xml"), joints=("shoulder", "elbow"))
"""A planar arm of two links in the vertical plane."""

WITHOUT_FRICTION = LuGre(sigma_0=0.0, sigma_1=0.0, sigma_2=0.0, f_c=1.0, f_s=1.0, v_s=1.0)
"""No friction for plant and solver alike: the solver divides by g(v), which must not be 0."""

OBSERVERS: dict[str, dict[str, Any]] = {
    "none": {},
    "letien-low": {"L": 50.0},
    "letien-high": {"L": 100.0},
    "pd-low": {"L": 50.0, "L_p": 10.0, "nominal": True},
    "pd-high": {"L": 100.0, "L_p": 20.0, "nominal": True},
    "pid-low": {"L": 50.0, "L_p": 10.0, "L_i": 25.0, "nominal": True},
    "pid-high": {"L": 100.0, "L_p": 20.0, "L_i": 100.0, "nominal": True},
}
"""No observer and the paper's six, by the fields of `Control`."""

__all__ = [
    "ARM",
    "FRICTION",
    "JOINT",
    "LINK",
    "OBSERVERS",
    "PERIOD",
    "TWO_LINK",
    "WITHOUT_FRICTION",
    "Case",
    "arm_case",
    "link_case",
    "paper_case",
]


@dataclass(frozen=True)
class Case:
    """A robot at rest, then under control.

    Attributes:
        robot: the link side as the plant loads it.
        equations: joints, friction and links as the solver knows them.
        pose: link positions at the start, (dof,), m | rad.
        gains: fields of the solver's `Control`.
        tau_ext: torque on the links over every control period, (periods, dof), N or N m.
        mass_scale: factor on the masses of the robot file.
    """

    robot: LinkSide
    equations: SingleLink | Arm
    pose: Array
    gains: dict[str, Any] = field(default_factory=dict)
    tau_ext: Array = field(default_factory=lambda: np.zeros((2000, 1)))
    mass_scale: float = 1.0

    def control(self, start: Array) -> Control:
        """The control law, its nominal motor at rest at `start`, (dof,)."""
        return Control(PERIOD, **self.gains, theta_n=start)

    def plant(self, physics_dt: float | None = None, control_dt: float = PERIOD) -> FlexibleJointPlant:
        """The suite's plant, at rest at the pose."""
        joint, friction = self.equations.joint, self.equations.friction
        plant = FlexibleJointPlant(
            self.robot, 1, joints=joint, friction=friction, control_dt=control_dt, physics_dt=physics_dt
        )
        only = np.array([0])
        plant.configure(only, joints=joint, friction=friction, mass_scale=self.mass_scale)
        plant.reset(only, self.pose)
        return plant


def paper_case(name: str) -> Case:
    """Two seconds of the paper's single link under one of OBSERVERS, or "no-friction"."""
    if name == "no-friction":
        return Case(LINK, SingleLink(JOINT, WITHOUT_FRICTION), np.zeros(1))
    return Case(LINK, SingleLink(JOINT, FRICTION), np.zeros(1), OBSERVERS[name])


def _observer(generator: np.random.Generator, turn: int) -> dict[str, Any]:
    """Random gains; none, Le Tien's, the PD- and the PID-type take turns, each stable at 1 kHz."""
    L, L_p, share = generator.uniform([40.0, 8.0, 0.1], [120.0, 20.0, 0.9])
    kinds: list[dict[str, Any]] = [
        {},
        {"L": L},
        {"L": L, "L_p": L_p, "nominal": True},
        {"L": L, "L_p": L_p, "L_i": share * L_p**2 / 2, "nominal": True},
    ]
    return kinds[turn % len(kinds)]


def link_case(generator: np.random.Generator, turn: int) -> Case:
    """Two seconds of a random single link: a step of 20 to 50 mm, and a push of 0.5 s."""
    spread = generator.uniform
    inertia, f_c, sigma_0, mass = spread(0.3, 2.0), spread(0.3, 2.0), 10 ** spread(4.0, 5.3), spread(0.5, 3.0)
    friction = LuGre(
        sigma_0=sigma_0,
        sigma_1=spread(0.5, 1.5) * (sigma_0 * inertia) ** 0.5,
        sigma_2=spread(0.0, 2.0),
        f_c=f_c,
        f_s=f_c * spread(1.0, 1.8),
        v_s=10 ** spread(-3.3, -2.0),
    )
    joint = FlexibleJoint(10 ** spread(3.0, 4.0), float(generator.choice([0.0, 5.0])), inertia, torque_limit=100.0)
    gains = _observer(generator, turn) | {"k_p": spread(30.0, 150.0), "k_d": spread(2.0, 10.0)}
    gains |= {"motor_inertia": inertia, "theta_d": generator.choice([-1.0, 1.0]) * spread(0.02, 0.05)}
    push = np.zeros((2000, 1))
    push[1000:1500] = spread(-3.0, 3.0)
    return Case(LINK, SingleLink(joint, friction, mass), np.zeros(1), gains, push, mass)


def arm_case(robot: LinkSide, home: Array, generator: np.random.Generator, turn: int) -> Case:
    """One second of an arm with random joints near the MIRO-like arm's: a step of every joint, and a push of 0.3 s."""
    spread, dof = generator.uniform, robot.dof
    like, usual = per_joint(ARM.flexible, ARM.dof), per_joint(ARM.friction, ARM.dof)
    inertia = like.motor_inertia[:dof] * spread(0.6, 1.6, dof)
    f_c = usual.f_c[:dof] * spread(0.5, 1.5, dof)
    sigma_0 = f_c / 10 ** spread(-4.2, -3.5, dof)
    friction = LuGre(
        sigma_0=sigma_0,
        sigma_1=spread(0.5, 1.5, dof) * np.sqrt(sigma_0 * inertia),
        sigma_2=spread(1.0, 8.0, dof),
        f_c=f_c,
        f_s=f_c * spread(1.0, 2.4, dof),
        v_s=10 ** spread(-2.8, -1.7, dof),
    )
    stiffness = like.stiffness[:dof] * spread(0.6, 1.5, dof)
    joint = FlexibleJoint(stiffness, generator.choice([0.0, 0.5]), inertia, torque_limit=200.0)
    model, mass = robot.model, spread(0.7, 1.5)
    model.body_mass *= mass
    model.body_inertia *= mass
    arm = Arm(model, joint, friction)
    pose = home + spread(-0.5, 0.5, dof)
    target = pose + generator.choice([-1.0, 1.0], dof) * spread(0.05, 0.15, dof)
    gravity = arm.gravity(target).copy()
    gains = _observer(generator, turn) | {"motor_inertia": inertia, "theta_d": target + gravity / stiffness}
    gains |= {"k_p": inertia * spread(30.0, 80.0), "k_d": inertia * spread(2.0, 8.0), "feedforward": gravity}
    push = np.zeros((1000, dof))
    push[500:800] = np.sin(np.pi * (np.arange(300) + 0.5)[:, None] / 300) ** 2 * f_c * spread(-3.0, 3.0, dof)
    return Case(robot, arm, pose, gains, push, mass)
