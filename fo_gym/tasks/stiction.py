"""Stiction: one joint, a step of one centimetre. The simulation of arXiv:1907.00553, section V."""

from __future__ import annotations

import numpy as np

from fo_gym.hardware import PushTime
from fo_gym.robots import Robot
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.scenario import Push
from fo_gym.tasks.step import Step
from fo_gym.tasks.task import Task

__all__ = ["stiction"]


def stiction(robot: Robot) -> Task:
    """A step of 10 mm from the start. The step is the paper's; the ranges and pushes of the variants are ours.

    Raises:
        ValueError: the robot is not a single slide.
    """
    if robot.units != ("m",):
        raise ValueError(
            f"robot {robot.name!r} has joints in {', '.join(robot.units)}; this task is a step of 10 mm of one slide: "
            "give such a robot, or take FJRRegulation-v0"
        )
    return Task(
        Step(size=0.01),
        duration=20.0,
        reward_scale=1e-3,
        random_push=Push(time=0.0, duration=0.5, torque=np.array([1.5])),
        push_time=PushTime((3.5, 6.0)),
        limit_cycle_window=(10.0, 20.0),
        randomization=Randomization(start=0.002, push_time=(4.0, 5.5)),
    )
