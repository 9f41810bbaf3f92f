"""How far a way to simulate a case is off, and how long it takes; and the arm's case."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import ARM, OBSERVERS, PERIOD, Case
from fo_gym.certificate.oracle import Arm
from fo_gym.certificate.steppers import Stepper, motion
from fo_gym.parameters import PDGains
from fo_gym.tasks.regulation import regulation

Array = NDArray[np.float64]

__all__ = ["Point", "arm_step", "measure"]


@dataclass(frozen=True)
class Point:
    """A method at one setting.

    Attributes:
        error: largest distance of links and motors from the truth, at the ticks [m | rad].
        seconds: time spent per simulated second, the median of the repeats.
    """

    error: float
    seconds: float


def measure(case: Case, truth: Array, start: Callable[[], Stepper], repeats: int) -> Point:
    """Run a method on a case `repeats` times; `truth` is what `motion` of it should be."""
    spent = []
    for _ in range(repeats):
        period = start()
        begin = time.perf_counter()
        moved = motion(case, period)
        spent.append(time.perf_counter() - begin)
    error = float(np.abs(moved - truth).max())
    return Point(error, float(np.median(spent)) / (PERIOD * len(case.tau_ext)))


def arm_step(periods: int) -> Case:
    """The suite's arm from home: a step of -5 degrees on every joint, under the PID-type observer at low gains."""
    task = regulation(ARM).fitted_to(ARM)
    assert isinstance(task.gains, PDGains)
    target = task.reference.target(ARM.home)
    assert target is not None
    arm = Arm(ARM.link_side.model, ARM.flexible, ARM.friction)
    gravity = arm.gravity(target).copy()
    gains = OBSERVERS["pid-low"] | {
        "motor_inertia": ARM.flexible.motor_inertia,
        "k_p": task.gains.kp,
        "k_d": task.gains.kd,
        "theta_d": target + gravity / ARM.flexible.stiffness,
        "feedforward": gravity,
    }
    return Case(ARM.link_side, arm, ARM.home, gains, np.zeros((periods, ARM.dof)))
