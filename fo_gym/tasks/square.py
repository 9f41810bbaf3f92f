"""The square: the tool draws it, then holds. The experiment of arXiv:1907.00553."""

from __future__ import annotations

from fo_gym.hardware import PushTime
from fo_gym.robots import Robot
from fo_gym.robots.poses import motion_units
from fo_gym.tasks.push import fitted_torque
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.scenario import Push
from fo_gym.tasks.task import Task
from fo_gym.tasks.tool_path import ToolPath

__all__ = ["square"]


def square(robot: Robot) -> Task:
    """A square of 15 cm in 5 s, smaller where the arm is, in a plane that suits it; then hold. Its size is the paper's.

    Randomized episodes push the arm while it holds, as hard as regulation does.
    """
    scale = motion_units(robot.link_side.model)
    return Task(
        ToolPath(duration=5.0),
        duration=8.0,
        reward_scale=2e-3,
        random_push=Push(time=0.0, duration=0.5, torque=fitted_torque(robot)),
        push_time=PushTime((5.2, 7.0)),
        randomization=Randomization(start=0.02 * scale, push_time=(5.5, 6.0)),
    )
