"""The draw of an episode."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from fo_gym.friction import FrictionLaw
from fo_gym.generators import Streams
from fo_gym.hardware import draw_hardware
from fo_gym.parameters import FlexibleJoint, per_joint
from fo_gym.robots import Robot
from fo_gym.tasks.hand import Hand
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.scenario import Push, Scenario
from fo_gym.tasks.task import Task

Array = NDArray[np.float64]

__all__ = ["draw_scenario"]


def draw_scenario(robot: Robot, task: Task, variant: str, rng: np.random.Generator) -> Scenario:
    """One episode of a task on a robot.

    "nominal" draws nothing of its own. The others draw friction, inertia, stiffness, start, target and push, each from
    the random stream of its range's name, and each effect of the hardware from that of its own: an episode without
    friction, with another range, or with an effect more has the same other draws.

    Args:
        robot: the nominal robot, with the hardware's effects, if there are any.
        task: what is varied.
        variant: one of VARIANTS.
        rng: the environment's generator.
    """
    streams = Streams(rng)
    scenario = _draw_plain(robot, task, variant, streams)
    if robot.hardware is None:
        return scenario
    drawn = draw_hardware(robot.hardware, per_joint(scenario.joints, robot.dof), streams)
    push = scenario.push
    if push is not None and drawn.push_time is not None:
        push = replace(push, time=drawn.push_time)
    return replace(scenario, push=push, hardware=drawn)


def _draw_plain(robot: Robot, task: Task, variant: str, streams: Streams) -> Scenario:
    home, target = robot.home, task.reference.target(robot.home)
    if variant == "nominal":
        return Scenario(robot.friction, robot.flexible, 1.0, home, target, task.push, hand=task.hand)
    spread, dof = task.randomization, robot.dof
    friction = _draw_friction(robot.friction, spread, streams, dof)
    joints = _draw_joints(robot.flexible, spread, streams, dof)
    mass_scale = float(_factor("mass", spread, streams, 1)[0])
    start = np.broadcast_to(spread.start, (dof,))
    q_start = home + streams("start").uniform(-start, start)
    if target is not None:
        target = task.reference.target(home, _signed("step", spread, streams, dof))
    strength = float(_signed("push", spread, streams, 1)[0])
    time = float(streams("push_time").uniform(*spread.push_time))
    push = None
    if task.random_push is not None:
        push = Push(time, task.random_push.duration, task.random_push.torque * strength)
    hand = None if task.hand is None else _draw_hand(task.hand, spread, streams)
    return Scenario(friction, joints, mass_scale, q_start, target, push, hand=hand)


def _draw_friction(friction: FrictionLaw, spread: Randomization, streams: Streams, dof: int) -> FrictionLaw:
    names = ("friction", "stiction", "bristle", "viscous", "stribeck")
    nominal: FrictionLaw = per_joint(friction, dof)
    return nominal.drawn({name: _factor(name, spread, streams, dof) for name in names})


def _draw_joints(joints: FlexibleJoint, spread: Randomization, streams: Streams, dof: int) -> FlexibleJoint:
    nominal = per_joint(joints, dof)
    return replace(
        nominal,
        motor_inertia=nominal.motor_inertia * _factor("motor_inertia", spread, streams, dof),
        stiffness=nominal.stiffness * _factor("stiffness", spread, streams, dof),
    )


def _draw_hand(hand: Hand, spread: Randomization, streams: Streams) -> Hand:
    whole = cast("Any", hand)  # fitted: nothing of it is left open
    stroke, stiffness, speed = (
        float(_factor(name, spread, streams, 1)[0]) for name in ("hand_stroke", "hand_stiffness", "hand_speed")
    )
    turned = float(streams("hand_direction").uniform(0.0, 0.5 * math.pi))
    axes = np.array([whole.direction, whole.across])
    along, across = np.array([[math.cos(turned), math.sin(turned)], [-math.sin(turned), math.cos(turned)]]) @ axes
    return replace(
        hand,
        stroke=whole.stroke * stroke,
        speed=whole.speed * stroke * speed,
        stiffness=whole.stiffness * stiffness,
        damping=whole.damping * stiffness,
        direction=(*along.tolist(),),
        across=(*across.tolist(),),
    )


def _factor(name: str, spread: Randomization, streams: Streams, size: int) -> Array:
    """Factors from the range of this name, log-uniform, (size,)."""
    low, high = getattr(spread, name)
    return np.exp(streams(name).uniform(math.log(low), math.log(high), size))


def _signed(name: str, spread: Randomization, streams: Streams, size: int) -> Array:
    """Factors from the range of this name, uniform, each with a random sign, (size,)."""
    rng, (low, high) = streams(name), getattr(spread, name)
    return rng.uniform(low, high, size) * rng.choice([-1.0, 1.0], size)
