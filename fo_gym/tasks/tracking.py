"""Tracking: every joint follows a sinusoid, with reversals, which is where friction shows."""

from __future__ import annotations

from fo_gym.hardware import PushTime
from fo_gym.robots import Robot
from fo_gym.robots.poses import motion_units
from fo_gym.tasks.joint_path import JointPath
from fo_gym.tasks.push import fitted_torque
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.scenario import Push
from fo_gym.tasks.task import Task

__all__ = ["tracking"]


def tracking(robot: Robot) -> Task:
    """Swing about home for 10 s, amplitude, frequency and phase fitted to each joint; then hold for 2 s. Ours.

    Randomized episodes push the arm while it swings.
    """
    scale = motion_units(robot.link_side.model)
    return Task(
        JointPath(duration=10.0),
        duration=12.0,
        reward_scale=5e-3 * scale,
        random_push=Push(time=0.0, duration=0.5, torque=fitted_torque(robot)),
        push_time=PushTime((3.0, 8.0)),
        randomization=Randomization(start=0.02 * scale, push_time=(5.0, 6.0)),
    )
