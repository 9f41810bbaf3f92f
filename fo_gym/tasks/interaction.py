"""Interaction: a hand grips the tool, guides it, and lets it go. The third demonstration of arXiv:1907.00553."""

from __future__ import annotations

from fo_gym.robots import Robot
from fo_gym.robots.poses import motion_units
from fo_gym.tasks.hand import Hand
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.task import Task
from fo_gym.tasks.tool_hold import ToolHold

__all__ = ["interaction"]


def interaction(robot: Robot) -> Task:
    """Hold the tool at home, softly; a hand grips it at 1 s, guides it three strokes, and lets it go at the far end.

    That a human guides the arm under lowered gains is the paper's; it shows this in a video, without numbers: those are
    ours.
    """
    scale = motion_units(robot.link_side.model)
    return Task(
        ToolHold(),
        duration=12.0,
        reward_scale=2e-3,
        hand=Hand(),
        limit_cycle_window=(10.0, 12.0),
        randomization=Randomization(start=0.02 * scale),
    )
