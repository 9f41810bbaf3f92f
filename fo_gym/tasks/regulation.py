"""Regulation: hold, step by -5 degrees, be pushed. The experiment of arXiv:1907.00553."""

from __future__ import annotations

import numpy as np

from fo_gym.hardware import PushTime
from fo_gym.robots import Robot
from fo_gym.robots.poses import motion_units
from fo_gym.tasks.push import fitted_torque
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.scenario import Push
from fo_gym.tasks.step import Step
from fo_gym.tasks.task import Task

__all__ = ["regulation"]


def regulation(robot: Robot) -> Task:
    """Hold the home pose, step by -5 degrees on every joint at 3 s (a slide by -8.7 mm), be pushed at 13 s.

    Step, push and their times are the paper's; the push is as hard for other arms as 10 N m are at its joint 2. Where
    joints slide, 0.1 m stands for a radian. The paper's experiment ends at 20 s. Ours goes on until the joints, which
    are under-damped, have come to rest where they have no friction: what moves then is hunting. Without friction the
    shipped arm moves in the limit-cycle window by 0.03 mrad, at most 0.18 mrad in 20 randomized episodes; from 30 to
    40 s it would be 0.65 and 2.8 mrad, from 8 to 13 s 37 mrad.
    """
    scale = motion_units(robot.link_side.model)
    push = Push(time=13.0, duration=0.5, torque=fitted_torque(robot))
    return Task(
        Step(size=np.deg2rad(-5.0) * scale, time=3.0),
        duration=50.0,
        reward_scale=5e-3 * scale,
        push=push,
        random_push=push,
        push_time=PushTime((13.0, 16.0)),
        limit_cycle_window=(40.0, 50.0),
        randomization=Randomization(start=0.02 * scale, push_time=(13.0, 14.0)),
    )
