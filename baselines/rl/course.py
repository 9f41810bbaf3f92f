"""What a policy is trained on: episodes with wide draws, and how long and how precise they are."""

from __future__ import annotations

from dataclasses import dataclass

from fo_gym import Randomization

__all__ = ["COURSES", "Course", "course_of"]


@dataclass(frozen=True)
class Course:
    """Training episodes of one environment.

    Attributes:
        joints: of the robot.
        duration: length of an episode [s].
        randomization: ranges of the draws.
        resolution: error of the motor at which the reward's logarithm bends [m | rad].
    """

    joints: int
    duration: float
    randomization: Randomization
    resolution: float


# Wider than the "randomized" variant, which is what is scored. A policy for one joint must expect any joint: light
# links (the arm's wrist), strong viscous friction, Stribeck velocities and bristles of another order.
_JOINT = {
    "friction": (0.4, 2.5),
    "stiction": (0.3, 2.0),
    "stribeck": (0.3, 10.0),
    "bristle": (0.05, 2.0),
    "viscous": (0.2, 15.0),
    "motor_inertia": (0.5, 1.5),
    "stiffness": (0.5, 2.0),
}
_LINK = Randomization(**_JOINT, mass=(0.1, 2.0), start=0.002, step=(0.3, 3.0), push_time=(2.0, 8.0), push=(0.3, 2.0))
# The arm has light joints already, its friction is strong, and its gravity is scaled with its mass.
_ARM = Randomization(friction=(0.4, 2.5), stribeck=(0.3, 3.0), start=0.02, push_time=(5.0, 7.0))

COURSES = {
    "FJRStiction-v0": Course(joints=1, duration=8.0, randomization=_LINK, resolution=1e-4),
    "FJRRegulation-v0": Course(joints=7, duration=8.0, randomization=_ARM, resolution=5e-4),
    "FJRSquare-v0": Course(joints=7, duration=8.0, randomization=_ARM, resolution=5e-4),
}


def course_of(env_id: str) -> Course:
    """The training episodes of an environment.

    Raises:
        ValueError: there are none for it.
    """
    if env_id not in COURSES:
        raise ValueError(f"there is no training course for {env_id!r}; there is one for {', '.join(COURSES)}")
    return COURSES[env_id]
