"""The task: robot, joints, controller gains and what is asked of them; and the draw of an episode."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, check_numbers, check_ranges
from fo_gym.hardware import Hardware, draw_hardware
from fo_gym.parameters import FlexibleJoint, ImpedanceGains, LuGre, PDGains, per_joint
from fo_gym.plant import Robot
from fo_gym.tasks.path import SquarePath
from fo_gym.tasks.scenario import Push, Scenario

Array = NDArray[np.float64]
Range = tuple[float, float]


__all__ = ["Randomization", "Task", "draw_scenario"]


@dataclass(frozen=True)
class Randomization:
    """Ranges of the "randomized" variant. Factors are drawn log-uniformly, per joint unless noted.

    Attributes:
        friction: factor on f_c.
        stiction: factor on the excess of stiction, f_s - f_c, after `friction`.
        stribeck: factor on v_s.
        bristle: factor on sigma_0; sigma_1 gets its square root, which keeps the bristle's damping ratio.
        viscous: factor on sigma_2.
        motor_inertia, stiffness: factors on B and K_j.
        mass: factor on the masses of the robot file, one for all links.
        start: largest offset of each joint at reset [m | rad], uniform.
        step: factor on the size of the target's step, uniform, with a random sign per joint.
        push_time: start of the push [s], uniform.
        push: factor on the push, uniform, with a random sign.
    """

    friction: Range = (0.6, 1.6)
    stiction: Range = (0.5, 1.5)
    stribeck: Range = (0.5, 2.0)
    bristle: Range = (0.5, 2.0)
    viscous: Range = (0.5, 2.0)
    motor_inertia: Range = (0.75, 1.33)
    stiffness: Range = (0.7, 1.4)
    mass: Range = (0.8, 1.25)
    start: float = 0.0
    step: Range = (0.5, 1.5)
    push_time: Range = (0.0, 0.0)
    push: Range = (0.5, 1.5)

    @property
    def fastest(self) -> Randomization:
        """Ranges without width, from which only the fastest joints and bristles are drawn, at the nominal start."""
        ends = {name: (getattr(self, name)[1],) * 2 for name in ("stiction", "bristle", "viscous", "stiffness")}
        ends |= {name: (getattr(self, name)[0],) * 2 for name in ("motor_inertia", "mass")}
        return replace(self, start=0.0, **ends)

    def __post_init__(self) -> None:
        check_numbers(self, start=NOT_NEGATIVE)
        check_ranges(self, step=NOT_NEGATIVE, push=NOT_NEGATIVE, push_time=NOT_NEGATIVE)
        check_ranges(self, friction=POSITIVE, stiction=POSITIVE, stribeck=POSITIVE, bristle=POSITIVE, viscous=POSITIVE)
        check_ranges(self, motor_inertia=POSITIVE, stiffness=POSITIVE, mass=POSITIVE)


@dataclass(frozen=True, eq=False)
class Task:
    """What a robot has to do. Arrays have one value per joint.

    Attributes:
        robot: the link side.
        joint_unit: "m" or "rad".
        joints, friction, gains: nominal parameters; PDGains ask for motor PD, ImpedanceGains for impedance.
        duration: length of an episode [s].
        accuracy: distance at which the reward's first term is one half [m | rad, or m of the tool].
        q_start: links at reset [m | rad].
        step, step_time: jump of the target [m | rad] and when [s]; None where a path is followed.
        path: the tool's path, or None.
        push: the push of the nominal variant, or None.
        random_push: the push that "randomized" varies.
        limit_cycle_window: (start, end) [s] where limit cycles are looked for, or None.
        randomization: ranges of the "randomized" variant.
        hardware: effects of the "hardware" variant, which are added to those draws.
    """

    robot: Robot
    joint_unit: str
    joints: FlexibleJoint
    friction: LuGre
    gains: PDGains | ImpedanceGains
    duration: float
    accuracy: float
    q_start: Array
    step: Array | None
    step_time: float | None
    path: SquarePath | None
    push: Push | None
    random_push: Push
    limit_cycle_window: Range | None
    randomization: Randomization
    hardware: Hardware = field(default_factory=Hardware)

    @property
    def motion_window(self) -> Range | None:
        """(start, end) [s] in which the path moves, or None."""
        return None if self.path is None else (0.0, self.path.duration)


def _factor(rng: np.random.Generator, bounds: Range, size: int) -> Array:
    return np.exp(rng.uniform(math.log(bounds[0]), math.log(bounds[1]), size))


def _draw_friction(friction: LuGre, spread: Randomization, rng: np.random.Generator, dof: int) -> LuGre:
    nominal = per_joint(friction, dof)
    f_c = nominal.f_c * _factor(rng, spread.friction, dof)
    # The ratio f_s / f_c varies about its nominal value, and f_s never falls below f_c.
    excess = np.divide(nominal.f_s - nominal.f_c, nominal.f_c, out=np.zeros(dof), where=nominal.f_c > 0)
    f_s = f_c * (1.0 + excess * _factor(rng, spread.stiction, dof))
    bristle = _factor(rng, spread.bristle, dof)
    return LuGre(
        sigma_0=nominal.sigma_0 * bristle,
        sigma_1=nominal.sigma_1 * np.sqrt(bristle),
        sigma_2=nominal.sigma_2 * _factor(rng, spread.viscous, dof),
        f_c=f_c,
        f_s=f_s,
        v_s=nominal.v_s * _factor(rng, spread.stribeck, dof),
    )


def draw_scenario(
    task: Task,
    variant: str,
    joints: FlexibleJoint,
    friction: LuGre,
    rng: np.random.Generator,
    hardware: Hardware | None = None,
) -> Scenario:
    """One episode of `task`.

    "nominal" draws nothing. The others draw friction, inertia, stiffness, start, target and push, in this order
    and always all of them, so that an episode without friction has the same draws as one with it. What the hardware
    draws comes last.

    Args:
        task: what is varied.
        variant: one of VARIANTS.
        joints, friction: nominal parameters (the user's, or the task's).
        rng: the environment's generator.
        hardware: effects, or None.
    """
    scenario = _draw_plain(task, variant, joints, friction, rng)
    if hardware is None:
        return scenario
    drawn = draw_hardware(hardware, per_joint(scenario.joints, task.robot.dof), rng)
    push = scenario.push
    if push is not None and drawn.push_time is not None:
        push = replace(push, time=drawn.push_time)
    return replace(scenario, push=push, hardware=drawn)


def _draw_plain(task: Task, variant: str, joints: FlexibleJoint, friction: LuGre, rng: np.random.Generator) -> Scenario:
    dof = task.robot.dof
    target = None if task.step is None else task.q_start + task.step
    if variant == "nominal":
        return Scenario(friction, joints, 1.0, task.q_start, target, task.push)
    spread = task.randomization
    drawn_friction = _draw_friction(friction, spread, rng, dof)
    nominal = per_joint(joints, dof)
    drawn_joints = replace(
        nominal,
        motor_inertia=nominal.motor_inertia * _factor(rng, spread.motor_inertia, dof),
        stiffness=nominal.stiffness * _factor(rng, spread.stiffness, dof),
    )
    mass_scale = float(_factor(rng, spread.mass, 1)[0])
    q_start = task.q_start + rng.uniform(-spread.start, spread.start, dof)
    if task.step is not None:
        target = task.q_start + task.step * rng.uniform(*spread.step, dof) * rng.choice([-1.0, 1.0], dof)
    torque = task.random_push.torque * rng.uniform(*spread.push) * rng.choice([-1.0, 1.0])
    push = Push(float(rng.uniform(*spread.push_time)), task.random_push.duration, torque)
    return Scenario(drawn_friction, drawn_joints, mass_scale, q_start, target, push)
