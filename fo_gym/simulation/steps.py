"""The micro-step of an environment, one for all episodes that it may draw."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fo_gym.micro_steps import PhysicsDt, auto_steps, is_auto
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot
from fo_gym.simulation.settings import Settings
from fo_gym.tasks.draw import draw_scenario
from fo_gym.tasks.task import Task

__all__ = ["followed_dt"]


def followed_dt(robot: Robot, task: Task, settings: Settings) -> PhysicsDt:
    """The micro-step that `settings` ask for [s]; None for the default.

    "auto" looks at the fastest joints within the variant's ranges, not at the draws of a batch: an environment takes
    the same steps whoever its neighbours are.

    Raises:
        ValueError: "auto" would take too many micro-steps.
    """
    if not is_auto(settings.physics_dt):
        return settings.physics_dt
    ranges = replace(task, randomization=task.randomization.fastest)
    fastest = draw_scenario(robot, ranges, settings.variant, np.random.default_rng(0))
    dt, only = settings.control_dt, np.zeros(1, dtype=np.intp)
    plant = FlexibleJointPlant(
        robot.link_side, 1, joints=fastest.joints, friction=fastest.friction, control_dt=dt, physics_dt="auto"
    )
    plant.configure(only, joints=fastest.joints, friction=fastest.friction, mass_scale=fastest.mass_scale)
    return dt / max(plant.steps, auto_steps(plant.advise(only, robot.home[None]), dt))
