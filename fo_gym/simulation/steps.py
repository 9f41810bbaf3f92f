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

__all__ = ["followed_dt", "plant_of"]


def plant_of(
    robot: Robot, task: Task, num_envs: int, settings: Settings, num_threads: int | None
) -> FlexibleJointPlant:
    """The plant of a batch; see `followed_dt` for its micro-step, FlexibleJointPlant for `num_threads`."""
    return FlexibleJointPlant(
        robot.link_side,
        num_envs,
        joints=robot.flexible,
        friction=robot.friction,
        control_dt=settings.control_dt,
        physics_dt=followed_dt(robot, task, settings),
        num_threads=num_threads,
    )


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
    joints, friction = fastest.joints, fastest.friction
    plant = FlexibleJointPlant(
        robot.link_side, 1, joints=joints, friction=friction, control_dt=dt, physics_dt="auto", num_threads=1
    )
    plant.configure(only, joints=joints, friction=friction, mass_scale=fastest.mass_scale)
    return dt / max(plant.steps, auto_steps(plant.advise(only, robot.home[None]), dt))
