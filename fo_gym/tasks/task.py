"""The task: what is asked of a robot, under which controller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, Value, check_ranges, check_values, instance, number, shown
from fo_gym.hardware import PushTime
from fo_gym.parameters import ImpedanceGains, PDGains
from fo_gym.robots import Robot
from fo_gym.tasks.hand import Hand
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.reference import Reference
from fo_gym.tasks.scenario import Push

Array = NDArray[np.float64]
Range = tuple[float, float]


__all__ = ["Task", "TaskLike", "made_for"]


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
        hand: the hand that guides the tool, or None.
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
    hand: Hand | None = None
    limit_cycle_window: Range | None = None
    randomization: Randomization = field(default_factory=Randomization)

    def __post_init__(self) -> None:
        instance("Task.reference", self.reference, Reference)
        number("Task.duration", self.duration, POSITIVE, "s")
        check_values(self, reward_scale=POSITIVE)
        for name, kind in (("push", Push), ("random_push", Push), ("push_time", PushTime), ("hand", Hand)):
            instance(f"Task.{name}", getattr(self, name), kind, none="none")
        instance("Task.randomization", self.randomization, Randomization)
        if self.limit_cycle_window is not None:
            check_ranges(self, limit_cycle_window=NOT_NEGATIVE)

    def fitted_to(self, robot: Robot) -> Task:
        """The same for one robot: reference, gains, pushes and hand have what its joints need.

        Raises:
            ValueError: the robot does not suit the reference or the hand, gains are of another kind than its controller
                takes, or something has values for another number of joints.
        """
        reference = self.reference.fitted_to(robot)
        hand = None if self.hand is None else self.hand.fitted_to(robot)
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
        return replace(self, reference=reference, gains=gains, hand=hand, **pushes)


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
