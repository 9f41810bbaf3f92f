"""Which steps the plant can take: micro-steps that divide the control period, and no step too long for a joint."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DEFAULT_PHYSICS_DT = 2e-4

__all__ = ["check_steps", "micro_steps"]


def micro_steps(control_dt: float, physics_dt: float | None) -> int:
    """Number of micro-steps in a control period.

    Args:
        control_dt: control period [s], above 0.
        physics_dt: micro-step [s]; None means min(2e-4, control_dt).

    Raises:
        ValueError: a period is not positive, or physics_dt does not divide control_dt (judged to 1e-9).
    """
    if not (np.isfinite(control_dt) and control_dt > 0):
        raise ValueError(f"control_dt is {control_dt} s; it must be finite and above 0")
    if physics_dt is None:
        # The default adapts where 2e-4 does not divide: the largest step below it that does.
        return max(1, int(np.ceil(control_dt / DEFAULT_PHYSICS_DT - 1e-9)))
    if not (np.isfinite(physics_dt) and physics_dt > 0):
        raise ValueError(f"physics_dt is {physics_dt} s; it must be finite and above 0")
    steps = round(control_dt / physics_dt)
    if steps < 1 or abs(steps * physics_dt - control_dt) > 1e-9:
        nearest = control_dt / max(1, steps)
        raise ValueError(f"physics_dt {physics_dt} s does not divide control_dt {control_dt} s; {nearest:.9g} s would")
    return steps


def check_steps(
    names: tuple[str, ...],
    *,
    mobility: Array,
    motor_inertia: Array,
    stiffness: Array,
    damping: Array,
    file_damping: Array,
    physics_dt: float,
    control_dt: float,
) -> None:
    """Refuse what the step cannot follow, with the numbers.

    The splitting is stable for h omega < 2; half of that keeps a margin for other poses, and accuracy. The two
    sweeps of the kick settle the springs' damping to 1e-6 where h D_j (1/B + (M^-1)_jj) is below 0.2. The file's
    own dampers act through the extrapolated velocity, stable for dt D / M below 1: half of that again.

    Args:
        names: the joints.
        mobility: (M^-1)_jj, (n, dof).
        motor_inertia, stiffness, damping: B, K_j, D_j, (n, dof).
        file_damping: dampers of the robot file, (dof,).
        physics_dt, control_dt: micro-step and control period [s].

    Raises:
        ValueError: a step is too long for a joint.
    """
    both = 1.0 / motor_inertia + mobility
    h, dt = ("physics_dt", physics_dt), ("control_dt", control_dt)
    _refuse_long(names, h, np.sqrt(stiffness * both), 1.0, "its fastest mode, sqrt(K_j (1/B + (M^-1)_jj))")
    _refuse_long(names, h, damping * both, 0.2, "its spring's damping, D_j (1/B + (M^-1)_jj)")
    _refuse_long(names, dt, file_damping * mobility, 0.5, "the file's own damping / M_jj")


def _refuse_long(names: tuple[str, ...], period: tuple[str, float], rates: Array, limit: float, what: str) -> None:
    """Raise ValueError where a period [s] times a rate (n, dof) [1/s] is above `limit`."""
    name, dt = period
    worst = np.unravel_index(rates.argmax(), rates.shape)
    if not dt * rates[worst] <= limit:
        raise ValueError(
            f"{name} {dt:.3g} s is too long for joint {names[int(worst[1])]!r}: {what} is {rates[worst]:.4g} 1/s; "
            f"use a {name} of at most {0.99 * limit / rates[worst]:.3g} s, a softer spring or more inertia"
        )
