"""What a robot's numbers mean for those who control it: conditions as a check list, each with value, bound and reason.

Conditions of arXiv:1907.00553 (Theorem 1), of Tomei 1991 for PD with gravity at the desired pose, of the micro-steps
(fo_gym.micro_steps), and what makes friction worth compensating.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import Value
from fo_gym.friction import FrictionLaw, LuGre
from fo_gym.micro_steps import DEFAULT_PHYSICS_DT, LIMITS, advise_steps
from fo_gym.parameters import FlexibleJoint, PDGains, packed
from fo_gym.robots.home import SINGULAR, conditioning, room
from fo_gym.robots.link_side import LinkSide
from fo_gym.robots.poses import Poses
from fo_gym.text import one_line

Array = NDArray[np.float64]

OBSERVERS = {"low": (50.0, 10.0, 25.0), "high": (100.0, 20.0, 100.0)}
"""L [1/s], L_p [1/s] and L_i [1/s^2] of the paper's two sets of gains."""

STEP = float(np.deg2rad(5.0))
"""The paper's step [rad, or natural units of a slide]."""

__all__ = ["Advice", "Condition", "advice"]


@dataclass(frozen=True)
class Condition:
    """One condition.

    Attributes:
        what: the quantity.
        value: of the joint where it is tightest.
        relation: "<=" or ">=".
        bound: what it should not exceed, or not fall below.
        unit: of both.
        joint: name of that joint, "" where the quantity is none of a joint.
        why: what happens otherwise.
    """

    what: str
    value: float
    relation: str
    bound: float
    unit: str
    joint: str
    why: str

    @property
    def met(self) -> bool:
        """Whether the condition holds; False where a number is not finite."""
        return bool(self.value <= self.bound if self.relation == "<=" else self.value >= self.bound)

    def __str__(self) -> str:
        mark = "met" if self.met else "NOT MET"
        numbers = f"{self.value:.4g} {self.relation} {self.bound:.4g} {self.unit}".rstrip()
        return f"{mark:<8} {self.what:<42} {numbers:<34} {one_line(self.joint, 24):<24} {self.why}".rstrip()


@dataclass(frozen=True)
class Advice:
    """A check list; `print` shows it as a table.

    Attributes:
        lines: a condition each.
    """

    lines: tuple[Condition, ...]

    @property
    def unmet(self) -> tuple[Condition, ...]:
        """What does not hold."""
        return tuple(line for line in self.lines if not line.met)

    def __str__(self) -> str:
        return "\n".join(map(str, self.lines))


@dataclass(frozen=True, eq=False)
class _Subject:
    """What the conditions look at, arrays (dof,)."""

    names: tuple[str, ...]
    joints: FlexibleJoint
    friction: FrictionLaw
    units: Array
    mobility: Array
    load: Array
    slope: Array

    def worst(self, what: str, value: Value, relation: str, bound: Value, unit: str, why: str) -> Condition:
        """The line of the joint where value / bound is farthest on the wrong side; unit "of a hinge | of a slide"."""
        values, bounds, _ = np.broadcast_arrays(value, bound, self.units)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(values == bounds, 1.0, values / bounds)
        j = int(np.argmax(share) if relation == "<=" else np.argmin(share))
        unit = unit.split(" | ")[-1 if self.units[j] != 1.0 else 0]
        return Condition(what, float(values[j]), relation, float(bounds[j]), unit, self.names[j], why)


def advice(
    link_side: LinkSide,
    joints: FlexibleJoint,
    friction: FrictionLaw,
    home: Array,
    gains: PDGains | None = None,
    control_dt: float = 1e-3,
) -> Advice:
    """The check list of a robot.

    Args:
        link_side: its links.
        joints, friction: of its motors, one value per joint.
        home: where it starts, (dof,) [m | rad].
        gains: of a motor PD, one value per joint; None leaves out what is about them.
        control_dt: control period [s].
    """
    model = link_side.model
    poses = Poses(model, link_side.tool)
    subject = _Subject(
        link_side.joints,
        joints,
        friction,
        poses.units,
        np.diag(np.linalg.inv(poses.inertia(home))),
        np.abs(poses.gravity(home)),
        poses.gravity_bound(),
    )
    lines = [*_steps(subject, control_dt), *_springs(subject), *_observers(control_dt), *_friction(subject)]
    if gains is not None:
        lines += _gains(subject, gains)
    return Advice((*lines, *_pose(subject, poses, home, link_side.tool)))


def _steps(subject: _Subject, control_dt: float) -> Iterator[Condition]:
    joints = subject.joints
    mode = np.sqrt(joints.stiffness * (1.0 / joints.motor_inertia + subject.mobility))
    limit = LIMITS["spring"][1] / DEFAULT_PHYSICS_DT
    why = "the default micro-step of 0.2 ms does not follow a faster one"
    yield subject.worst("fastest mode", mode, "<=", limit, "rad/s", why)
    dof, law = len(subject.names), subject.friction
    steps = advise_steps(subject.names, packed(joints, dof)[None], subject.mobility[None], law, law.packed(dof)[None])
    j = int(steps.physics_dt.argmin())
    why = f'else "auto" or a shorter physics_dt is needed: {steps.reasons[j]}'
    yield subject.worst("largest micro-step", 1e3 * steps.physics_dt, ">=", 1e3 * DEFAULT_PHYSICS_DT, "ms", why)
    sampled = control_dt * np.sqrt(joints.stiffness / joints.motor_inertia)
    why = "between two samples the spring's torque changes more than controllers can see"
    yield subject.worst("sqrt(K_j / B) dt", sampled, "<=", 0.5, "", why)


def _springs(subject: _Subject) -> Iterator[Condition]:
    why = "gravity turns a softer spring over: the links have more than one rest"
    yield subject.worst("K_j above |dg/dq|", subject.joints.stiffness, ">=", subject.slope, "N m/rad | N/m", why)
    share = subject.load / subject.joints.torque_limit
    yield subject.worst("gravity at home / torque limit", share, "<=", 0.7, "", "too little is left to move with")


def _observers(control_dt: float) -> Iterator[Condition]:
    for name, (bandwidth, proportional, integral) in OBSERVERS.items():
        why = "an observer that samples slower rings, or diverges"
        yield Condition(f"L dt, {name} gains", bandwidth * control_dt, "<=", 0.5, "", "", why)
        why = "Theorem 1 (Q > 0) of the PID-type observer"
        yield Condition(f"L_p^2 above 2 L_i, {name} gains", proportional**2, ">=", 2.0 * integral, "1/s^2", "", why)


def _friction(subject: _Subject) -> Iterator[Condition]:
    friction = subject.friction
    stiction = friction.level("stiction", friction.level("coulomb"))
    share = stiction / subject.joints.torque_limit
    yield subject.worst("stiction / torque limit", share, "<=", 0.5, "", "compensation itself meets the torque limit")
    if isinstance(friction, LuGre):
        excess = friction.sigma_2 - friction.passivity_margin()
        why = "LuGre may give out energy (sigma_2 above sigma_1 (f_s - f_c) / f_c suffices; measured joints fail it)"
        yield subject.worst("sigma_2, passive friction", friction.sigma_2, ">=", excess, "N m s/rad | N s/m", why)


def _gains(subject: _Subject, gains: PDGains) -> Iterator[Condition]:
    joints, friction = subject.joints, subject.friction
    viscous, coulomb = (friction.level(level) for level in ("viscous", "coulomb"))
    why = "PD with gravity at the desired pose has more than one rest (Tomei 1991)"
    yield subject.worst("K_p above |dg/dq|", gains.kp, ">=", subject.slope, "N m/rad | N/m", why)
    for name, (bandwidth, proportional, _) in OBSERVERS.items():
        # c_3 bounds the square of the viscous coefficient; the paper has B = 1, and units ask for c_3 / B.
        least = np.square(viscous) / (joints.motor_inertia * bandwidth)
        why = "Theorem 1: damping must outweigh what viscous friction is known too late"
        yield subject.worst(f"K_d above c_3 / L, {name} gains", gains.kd, ">=", least, "N m s/rad | N s/m", why)
        held = gains.kp / (joints.motor_inertia * bandwidth * proportional)
        why = "the PD-type observer holds the motor to the nominal one no tighter than the controller does"
        yield subject.worst(f"K_p / (B L L_p), {name} gains", held, "<=", 1.0, "", why)
    short = coulomb / (gains.kp * STEP * subject.units)
    why = "friction hardly shows: uncompensated, a step of 5 degrees stops nearer than that"
    yield subject.worst("f_c / K_p, as a share of a step", short, ">=", 0.05, "", why)
    asked = gains.kp * STEP * subject.units / np.maximum(joints.torque_limit - subject.load, 1e-300)
    yield subject.worst("torque of a step / what gravity leaves", asked, "<=", 0.8, "", "a step meets the torque limit")


def _pose(subject: _Subject, poses: Poses, home: Array, tool: str | None) -> Iterator[Condition]:
    why = "a step of 5 degrees may leave the joint's range"
    yield subject.worst("distance to a limit / what a step needs", room(poses.model, home), ">=", 1.0, "", why)
    if tool is not None and poses.model.nq >= 3:
        smallest = conditioning(poses, home, poses.reach())
        why = "near a singular pose the tool cannot follow a path"
        yield Condition("smallest singular value of J, scaled", smallest, ">=", SINGULAR, "", "", why)
