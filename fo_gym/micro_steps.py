"""Which steps the plant can take: micro-steps that divide the control period, and no step too long for a joint.

What a micro-step h must follow was measured: some 6,500 random single links, parameters log-uniform over up to nine
decades (sigma_0, sigma_1, f_c, f_s / f_c, v_s, B, K_j, D_j, masses), under steps, ramps, sweeps and pushes of 30 to 500
ms, the kernel against LSODA. The error falls with the square of h, and these numbers predict it; it reaches 1e-3 of the
motion in a tenth of the cases where they are about

    h sqrt(sigma_0 / B)                         0.2     the bristle's mode
    h sqrt(sigma_0 / B)                         0.08    the same where sigma_1 is nearly 0: it rings, and out of phase
    h (sigma_1 + sigma_2) / B                   0.2     friction's damping
    h sqrt(sigma_0 / B (f_s - f_c) / f_c)       0.3     the Stribeck effect
    h sqrt(K_j (1/B + (M^-1)_jj))               0.5     the spring's mode

v_s is not among them, over seven decades: friction falls along the Stribeck curve at (f_s - f_c) / (B v_s), but not
faster than the bristle relaxes, sigma_0 v_s / f_c, and the slower of both is at most their geometric mean, the Stribeck
number. What LIMITS accept is within 1e-3 of the motion or, where that is more, within what torques wrong by 1e-3 would
change (tests/test_plant_accuracy.py); a motion counts as 100 f_s / sigma_0 at least: less is presliding, all bristle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import POSITIVE, number
from fo_gym.friction import FrictionLaw

Array = NDArray[np.float64]
PhysicsDt = float | Literal["auto"] | None

DEFAULT_PHYSICS_DT = 2e-4

MAX_MICRO_STEPS = 10_000
"""Most micro-steps in a control period: at 0.1 us a joint, a millisecond of a joint then takes one to compute."""

HEADROOM = 0.9
"""Share of the largest micro-step that "auto" takes, for other poses than the one it was chosen in."""

# What a joint's rate is called, the largest micro-step times that rate, and what else would help.
LIMITS: dict[str, tuple[str, float, str]] = {
    "spring": ("its fastest mode, sqrt(K_j (1/B + (M^-1)_jj))", 0.5, "a softer spring or more inertia"),
    "spring_damping": ("its spring's damping, D_j (1/B + (M^-1)_jj)", 0.2, "a smaller D_j or more inertia"),
    "bristle": ("its bristle's mode, sqrt(sigma_0 / B)", 0.125, "a smaller sigma_0 or more inertia"),
    "ringing": (
        "the ringing of its bristle, sigma_0 / max(sigma_1, 0.2 sqrt(sigma_0 B)),",
        0.25,
        "a larger sigma_1 or a smaller sigma_0",
    ),
    "friction_damping": ("its friction's damping, (sigma_1 + sigma_2) / B", 0.125, "a smaller sigma_1 and sigma_2"),
    "stribeck": ("its Stribeck effect, sqrt(sigma_0 / B (f_s - f_c) / f_c)", 0.25, "f_s nearer to f_c"),
}

__all__ = ["PhysicsDt", "StepAdvice", "advise_steps", "auto_steps", "check_steps", "is_auto", "micro_steps"]


def is_auto(physics_dt: object) -> bool:
    """Whether the plant is to choose its micro-step by itself."""
    return isinstance(physics_dt, str) and physics_dt == "auto"


def micro_steps(control_dt: float, physics_dt: PhysicsDt) -> int:
    """Number of micro-steps in a control period.

    Args:
        control_dt: control period [s], above 0.
        physics_dt: micro-step [s]; None means min(2e-4, control_dt).

    Raises:
        ValueError: a period is not positive, physics_dt is no number or does not divide control_dt (judged to 1e-9),
            or makes more than MAX_MICRO_STEPS.
    """
    number("control_dt", control_dt, POSITIVE, "s")
    if physics_dt is None:
        _refuse_many(control_dt / DEFAULT_PHYSICS_DT, f"control_dt {control_dt} s at the default micro-step of 2e-4 s")
        # The default adapts where 2e-4 does not divide: the largest step below it that does.
        return max(1, int(np.ceil(control_dt / DEFAULT_PHYSICS_DT - 1e-9)))
    if isinstance(physics_dt, str):
        raise ValueError(
            f'physics_dt is {physics_dt!r}; give a number of seconds, "auto", or None for min(2e-4, control_dt)'
        )
    physics_dt = number("physics_dt", physics_dt, POSITIVE, "s")
    _refuse_many(control_dt / physics_dt, f"physics_dt {physics_dt} s in control_dt {control_dt} s")
    steps = round(control_dt / physics_dt)
    if steps < 1 or abs(steps * physics_dt - control_dt) > 1e-9:
        nearest = control_dt / max(1, steps)
        raise ValueError(f"physics_dt {physics_dt} s does not divide control_dt {control_dt} s; {nearest:.9g} s would")
    return steps


def _refuse_many(steps: float, what: str, remedy: str = "a longer physics_dt") -> None:
    if not steps < MAX_MICRO_STEPS + 0.5:
        raise ValueError(
            f"{what} makes {steps:.4g} micro-steps in a control period; at most {MAX_MICRO_STEPS} are taken: "
            f"use {remedy} or a shorter control_dt"
        )


@dataclass(frozen=True)
class StepAdvice:
    """The largest micro-step of every joint, and what asks for it.

    Attributes:
        joints: their names.
        physics_dt: largest micro-step of each [s], (dof,); infinite where nothing moves by itself.
        reasons: what bounds it, with its rate [1/s].
        remedies: what else would help.
    """

    joints: tuple[str, ...]
    physics_dt: Array
    reasons: tuple[str, ...]
    remedies: tuple[str, ...]


def advise_steps(
    names: tuple[str, ...], joints: Array, mobility: Array, law: FrictionLaw, friction: NDArray[np.void]
) -> StepAdvice:
    """The largest micro-step that follows each joint in all of n environments.

    Args:
        names: the joints.
        joints: stiffness, damping and motor inertia, (n, dof, 3).
        mobility: (M^-1)_jj, (n, dof).
        law: says what the states of friction ask for.
        friction: its parameters, (n, dof), of its dtype.
    """
    stiffness, damping, inertia = np.moveaxis(joints, -1, 0)
    both = 1.0 / inertia + mobility
    rates = {"spring": np.sqrt(stiffness * both), "spring_damping": damping * both, **law.rates(friction, inertia)}
    with np.errstate(divide="ignore"):  # what has no rate has no longest step
        longest = np.array([LIMITS[name][1] / rate.max(axis=0) for name, rate in rates.items()])
    worst = [list(rates)[row] for row in longest.argmin(axis=0)]
    highest = [rates[name][:, joint].max() for joint, name in enumerate(worst)]
    reasons = tuple(f"{LIMITS[name][0]} is {rate:.4g} 1/s" for name, rate in zip(worst, highest, strict=True))
    return StepAdvice(names, longest.min(axis=0), reasons, tuple(LIMITS[name][2] for name in worst))


def auto_steps(advice: StepAdvice, control_dt: float) -> int:
    """Fewest micro-steps in a control period [s] that follow every joint, with HEADROOM.

    Raises:
        ValueError: control_dt is not positive, or they would be more than MAX_MICRO_STEPS.
    """
    micro_steps(control_dt, control_dt)
    joint = int(advice.physics_dt.argmin())
    steps = control_dt / (HEADROOM * advice.physics_dt[joint])
    who = f'physics_dt "auto" for joint {advice.joints[joint]!r} ({advice.reasons[joint]})'
    _refuse_many(steps, f"{who}, control_dt {control_dt} s,", advice.remedies[joint])
    return max(1, int(np.ceil(steps)))


def check_steps(advice: StepAdvice, *, physics_dt: float, control_dt: float) -> None:
    """Refuse what the step cannot follow, with the numbers.

    The two sweeps of the kick settle the springs' damping to 1e-6 where its number is below 0.2.

    Args:
        advice: the largest micro-steps.
        physics_dt, control_dt: micro-step and control period [s].

    Raises:
        ValueError: a step is too long for a joint.
    """
    joint = int(advice.physics_dt.argmin())
    longest = advice.physics_dt[joint]
    if not physics_dt <= longest:
        steps = np.ceil(control_dt / max(0.99 * longest, 1e-300))
        would = f'use a physics_dt of at most {control_dt / steps:.9g} s, "auto", or {advice.remedies[joint]}'
        if steps > MAX_MICRO_STEPS:
            would = f"no physics_dt of at most {MAX_MICRO_STEPS} micro-steps would do; use {advice.remedies[joint]}"
        raise ValueError(
            f"physics_dt {physics_dt:.3g} s is too long for joint {advice.joints[joint]!r}: "
            f"{advice.reasons[joint]}; {would}"
        )
