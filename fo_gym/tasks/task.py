"""The task: what is asked of a robot, under which controller; and the draw of an episode."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, check_ranges, check_values, instance, number, shown
from fo_gym.hardware import PushTime, draw_hardware
from fo_gym.parameters import ImpedanceGains, LuGre, PDGains, Value, per_joint
from fo_gym.robots import Robot
from fo_gym.tasks.reference import Reference
from fo_gym.tasks.scenario import Push, Scenario

Array = NDArray[np.float64]
Range = tuple[float, float]


__all__ = ["Randomization", "Task", "TaskLike", "draw_scenario", "made_for"]


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
        start: largest offset of each joint at reset [m | rad], uniform; one value or one per joint.
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
    start: Value = 0.0
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
        check_values(self, start=NOT_NEGATIVE)
        check_ranges(self, step=NOT_NEGATIVE, push=NOT_NEGATIVE, push_time=NOT_NEGATIVE)
        check_ranges(self, friction=POSITIVE, stiction=POSITIVE, stribeck=POSITIVE, bristle=POSITIVE, viscous=POSITIVE)
        check_ranges(self, motor_inertia=POSITIVE, stiffness=POSITIVE, mass=POSITIVE)


@dataclass(frozen=True, eq=False)
class Task:
    """What a robot has to do. Arrays have one value per joint; single numbers stand for all joints.

    Attributes:
        reference: the motion that is asked for.
        duration: length of an episode [s].
        reward_scale: distance at which the reward's first term is one half [m | rad, or m of the tool].
        gains: PDGains or ImpedanceGains of the reference's controller; None for the robot's own, or designed ones.
        push: the push of the nominal variant, or None.
        random_push: the push that "randomized" varies; None for none.
        push_time: when the "hardware" variant pushes; None as "randomized" does.
        limit_cycle_window: (start, end) [s] where limit cycles are looked for, or None.
        randomization: ranges of the "randomized" variant.
    """

    reference: Reference
    duration: float
    reward_scale: Value = 5e-3
    gains: PDGains | ImpedanceGains | None = None
    push: Push | None = None
    random_push: Push | None = None
    push_time: PushTime | None = None
    limit_cycle_window: Range | None = None
    randomization: Randomization = field(default_factory=Randomization)

    def __post_init__(self) -> None:
        instance("Task.reference", self.reference, Reference)
        number("Task.duration", self.duration, POSITIVE, "s")
        check_values(self, reward_scale=POSITIVE)
        for name, kind in (("push", Push), ("random_push", Push), ("push_time", PushTime)):
            instance(f"Task.{name}", getattr(self, name), kind, none="none")
        instance("Task.randomization", self.randomization, Randomization)
        if self.limit_cycle_window is not None:
            check_ranges(self, limit_cycle_window=NOT_NEGATIVE)

    def fitted_to(self, robot: Robot) -> Task:
        """The same for one robot: reference, gains and pushes have what its joints need.

        Raises:
            ValueError: the robot does not suit the reference, gains are of another kind than its controller takes, or
                something has values for another number of joints.
        """
        reference = self.reference.fitted_to(robot)
        designed = reference.designed_gains(robot)
        gains = designed if self.gains is None else self.gains
        if not isinstance(gains, type(designed)):
            raise ValueError(f"gains is {shown(gains)}; this task's controller takes {type(designed).__name__}(...)")
        pushes: dict[str, Any] = {
            name: _per_joint(f"Task.{name}", getattr(self, name), robot.dof) for name in ("push", "random_push")
        }
        for name, part in (("reward_scale", self.reward_scale), ("randomization.start", self.randomization.start)):
            if np.shape(part) not in ((), (1,), (robot.dof,)):
                raise ValueError(f"Task.{name} has shape {np.shape(part)}; give one value or {robot.dof}")
        return replace(self, reference=reference, gains=gains, **pushes)


TaskLike = Task | Callable[[Robot], Task]
"""A task, or a function that makes one for a robot."""


def made_for(robot: Robot, task: TaskLike) -> Task:
    """The task, made for a robot where it is a function. Raises ValueError where it is, or makes, no task."""
    made: Any = task(robot) if callable(task) else task
    if not isinstance(made, Task):
        what = "it makes" if callable(task) else "it is"
        raise ValueError(f"task: {what} {shown(made)}; give a fo_gym.Task, or a function from a Robot to one")
    return made


def _per_joint(name: str, push: Push | None, dof: int) -> Push | None:
    """The push with a torque for every joint of a robot."""
    if push is None or np.shape(push.torque) == (dof,):
        return push
    raise ValueError(f"{name}.torque has shape {np.shape(push.torque)}; give a value for each of the {dof} joints")


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


def draw_scenario(robot: Robot, task: Task, variant: str, rng: np.random.Generator) -> Scenario:
    """One episode of a task on a robot.

    "nominal" draws nothing. The others draw friction, inertia, stiffness, start, target and push, in this order
    and always all of them, so that an episode without friction has the same draws as one with it. What the hardware
    draws comes last.

    Args:
        robot: the nominal robot, with the hardware's effects, if there are any.
        task: what is varied.
        variant: one of VARIANTS.
        rng: the environment's generator.
    """
    scenario = _draw_plain(robot, task, variant, rng)
    if robot.hardware is None:
        return scenario
    drawn = draw_hardware(robot.hardware, per_joint(scenario.joints, robot.dof), rng)
    push = scenario.push
    if push is not None and drawn.push_time is not None:
        push = replace(push, time=drawn.push_time)
    return replace(scenario, push=push, hardware=drawn)


def _draw_plain(robot: Robot, task: Task, variant: str, rng: np.random.Generator) -> Scenario:
    dof, home = robot.dof, robot.home
    target = task.reference.target(home)
    if variant == "nominal":
        return Scenario(robot.friction, robot.flexible, 1.0, home, target, task.push)
    spread = task.randomization
    drawn_friction = _draw_friction(robot.friction, spread, rng, dof)
    nominal = per_joint(robot.flexible, dof)
    drawn_joints = replace(
        nominal,
        motor_inertia=nominal.motor_inertia * _factor(rng, spread.motor_inertia, dof),
        stiffness=nominal.stiffness * _factor(rng, spread.stiffness, dof),
    )
    mass_scale = float(_factor(rng, spread.mass, 1)[0])
    start = np.broadcast_to(spread.start, (dof,))
    q_start = home + rng.uniform(-start, start)
    if target is not None:
        target = task.reference.target(home, rng.uniform(*spread.step, dof) * rng.choice([-1.0, 1.0], dof))
    strength = rng.uniform(*spread.push) * rng.choice([-1.0, 1.0])
    time = float(rng.uniform(*spread.push_time))
    push = None
    if task.random_push is not None:
        push = Push(time, task.random_push.duration, task.random_push.torque * strength)
    return Scenario(drawn_friction, drawn_joints, mass_scale, q_start, target, push)
