"""The MuJoCo twin: the same flexible joints built from MuJoCo's own parts must converge to the plant."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import ARM, Case, arm_case, paper_case
from fo_gym.certificate.statement import Finding, at_most, check, near
from fo_gym.certificate.steppers import motion, plant, twin
from fo_gym.certificate.subject import Subject
from fo_gym.micro_steps import DEFAULT_PHYSICS_DT

Array = NDArray[np.float64]

SOURCE = "MuJoCo's own joints, springs and LuGre actuator (plant.to_mujoco)"
SEED = 20240612


def _link() -> Case:
    return paper_case("pid-low")


def _arm() -> Case:
    """A step of every joint and a push, under the PD-type observer."""
    return arm_case(ARM.link_side, ARM.home, np.random.default_rng(SEED), 2)


@lru_cache(maxsize=2)
def _fine(subject: Subject, robot: str) -> Array:
    """The plant at an eighth of its micro-step, so that its own error does not show."""
    case = _link() if robot == "link" else _arm()
    return motion(case, plant(case, (subject.physics_dt or DEFAULT_PHYSICS_DT) / 8))


def _distance(subject: Subject, case: Case, timestep: float, integrator: str, limit: float, unit: str) -> Finding:
    """Largest distance of twin and plant at the plant's own micro-step."""
    ours, theirs = motion(case, plant(case, subject.physics_dt)), motion(case, twin(case, timestep, integrator))
    moved = np.ptp(theirs, axis=0).max()
    measured = f"largest distance of links and motors, twin at {1e6 * timestep:g} us, on a motion of {moved:.2g} {unit}"
    return at_most(np.abs(ours - theirs).max(), limit, unit, measured)


def _order(ours: Array, case: Case, timesteps: tuple[float, ...], integrator: str, unit: str) -> Finding:
    """Slope of log(distance) over log(step of the twin); it should be 1."""
    errors = [np.abs(motion(case, twin(case, h, integrator)) - ours).max() for h in timesteps]
    slope = np.polyfit(np.log(timesteps), np.log(errors), 1)[0]
    steps = ", ".join(f"{1e6 * h:g}" for h in timesteps)
    values = ", ".join(f"{error:.1e}" for error in errors)
    return near(slope, 1.0, 0.2, "", f"slope over steps of {steps} us, where the distances are {values} {unit}")


@check(
    "twin-link-rk4",
    source=SOURCE,
    text="With RK4 at 25 us the twin of the single link (pid-low, 2 s) stays within 2 um of the plant.",
)
def twin_link_rk4(subject: Subject) -> Finding:
    """Single link, RK4."""
    return _distance(subject, _link(), 2.5e-5, "rk4", 2e-6, "m")


@check(
    "twin-link-rk4-order",
    source=SOURCE,
    text="With RK4 the twin's distance from the plant is proportional to its step: it converges to the plant.",
)
def twin_link_rk4_order(subject: Subject) -> Finding:
    """Observed order on the single link, RK4."""
    return _order(_fine(subject, "link"), _link(), (1e-4, 5e-5, 2.5e-5, 1.25e-5), "rk4", "m")


@check(
    "twin-link-implicitfast",
    source=SOURCE,
    text="With implicitfast at 6.25 us the twin of the single link (pid-low, 2 s) stays within 10 um of the plant.",
)
def twin_link_implicitfast(subject: Subject) -> Finding:
    """Single link, implicitfast."""
    return _distance(subject, _link(), 6.25e-6, "implicitfast", 1e-5, "m")


@check(
    "twin-link-implicitfast-order",
    source=SOURCE,
    text="With implicitfast at 12.5 us and below, too, the twin's distance from the plant is proportional to its step.",
)
def twin_link_implicitfast_order(subject: Subject) -> Finding:
    """Observed order on the single link, implicitfast."""
    return _order(_fine(subject, "link"), _link(), (1.25e-5, 6.25e-6, 3.125e-6), "implicitfast", "m")


@check(
    "twin-arm-rk4",
    source=SOURCE,
    text="With RK4 at 50 us the twin of the 7-joint arm stays within 20 urad of the plant in 1 s of a step and a push.",
)
def twin_arm_rk4(subject: Subject) -> Finding:
    """Arm, RK4."""
    return _distance(subject, _arm(), 5e-5, "rk4", 2e-5, "rad")


@check(
    "twin-arm-implicitfast-order",
    source=SOURCE,
    text="On the arm, with implicitfast, the twin's distance from the plant is proportional to its step.",
)
def twin_arm_implicitfast_order(subject: Subject) -> Finding:
    """Observed order on the arm, implicitfast."""
    return _order(_fine(subject, "arm"), _arm(), (1e-4, 5e-5, 2.5e-5), "implicitfast", "rad")
