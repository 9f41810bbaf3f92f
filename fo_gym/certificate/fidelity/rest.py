"""Holding and sliding: below break-away a joint stays where its bristles hold it; sliding, it feels steady friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import odeint

from fo_gym.certificate.cases import FRICTION, JOINT, LINK, PERIOD
from fo_gym.certificate.oracle import SingleLink
from fo_gym.certificate.statement import Finding, at_most, check
from fo_gym.certificate.subject import Subject
from fo_gym.plant import FlexibleJointPlant

Array = NDArray[np.float64]

LOADS = FRICTION.f_s * np.array([0.2, 0.5, 0.8, 0.93])
"""Motor forces that are held [N]."""

RAMP, HOLD = 1.0, 60.0
"""Time in which they are raised, and for which they are held [s]."""

DAMPING = 20.0
"""Damping of the spring where a link must come to rest [N s/m]; undamped, it swings for minutes on stuck bristles."""

DRIVES = np.array([1.8, 2.5, 5.0, 20.0])
"""Constant motor forces above break-away [N]."""


def _plant(subject: Subject, num_envs: int, damping: float = 0.0) -> FlexibleJointPlant:
    """The paper's single link, with a spring of some damping [N s/m]."""
    joint = replace(JOINT, damping=damping)
    return FlexibleJointPlant(
        LINK, num_envs, joints=joint, friction=FRICTION, control_dt=PERIOD, physics_dt=subject.physics_dt
    )


def _hold(subject: Subject, damping: float) -> tuple[Array, Array]:
    """Motor positions under every load, 10 s into the hold and at its end, (loads,) [m]."""
    plant, still = _plant(subject, len(LOADS), damping), np.zeros((len(LOADS), 1))
    early = np.zeros(len(LOADS))
    for k in range(round((RAMP + HOLD) / PERIOD)):
        if k == round((RAMP + 10.0) / PERIOD):
            early = plant.theta[:, 0].copy()
        share = min(1.0, (k + 0.5) * PERIOD / RAMP)  # the mean of the ramp over the period
        plant.step(share * LOADS[:, None], still)
    return early, plant.theta[:, 0].copy()


def _held_by_equations(load: float) -> float:
    """Motor position at the end of the hold by the solver [m]."""
    link, still = SingleLink(JOINT, FRICTION), np.float64(0.0)

    def rates(t: float, x: Array) -> list[float]:
        return link.rates(t, x, np.float64(load * min(1.0, t / RAMP)), still)

    times = [0.0, RAMP, RAMP + HOLD]
    solution = odeint(rates, np.zeros(5), times, rtol=1e-10, atol=1e-15, tfirst=True, tcrit=[RAMP], mxstep=500_000)
    return float(solution[-1, 2])


@check(
    "hold-displacement",
    source="LSODA on the equations",
    text="A motor force raised in 1 s to at most 0.93 f_s and held for 60 s moves the motor by LuGre's presliding "
    "displacement within 0.1 %.",
)
def hold_displacement(subject: Subject) -> Finding:
    """The load with the largest relative error."""
    ours, theirs = _hold(subject, 0.0)[1], np.array([_held_by_equations(load) for load in LOADS])
    values = ", ".join(f"{1e6 * x:.3f}" for x in ours)
    measured = f"largest deviation from the solver; displacements {values} um under {_list(LOADS)} N"
    return at_most(100 * np.abs(ours / theirs - 1).max(), 0.1, "%", measured)


@check(
    "hold-creep",
    source="LuGre's equations: a bristle at rest holds any force below break-away",
    text="Once held, and the link at rest on a damped spring, the motor does not creep: less than 1e-15 m/s.",
)
def hold_creep(subject: Subject) -> Finding:
    """Mean speed over the last 50 s of the hold, of the load that creeps fastest."""
    early, end = _hold(subject, DAMPING)
    speed = np.abs(end - early) / (HOLD - 10.0)
    return at_most(speed.max(), 1e-15, "m/s", f"largest mean speed over the last 50 s under {_list(LOADS)} N")


@check(
    "slide-steady",
    source="LuGre's steady curve, -sign(v) g(v) - sigma_2 v",
    text="Accelerated from rest by a constant force, faster than 100 v_s, the motor feels steady friction within 1 %.",
)
def slide_steady(subject: Subject) -> Finding:
    """Largest relative difference of the mean friction over a period and the curve at the mean velocity."""
    plant, still = _plant(subject, len(DRIVES)), np.zeros((len(DRIVES), 1))
    worst, fastest = 0.0, 0.0
    for _ in range(round(3.0 / PERIOD)):
        before = plant.theta.copy()
        plant.step(DRIVES[:, None], still)
        velocity = (plant.theta - before) / PERIOD
        fast = np.abs(velocity) > 100 * FRICTION.v_s
        steady = FRICTION.steady(velocity[fast])
        worst = max(worst, float(np.abs(plant.tau_f[fast] / steady - 1).max(initial=0.0)))
        fastest = max(fastest, float(np.abs(velocity).max()))
    measured = f"largest deviation of the mean friction over 1 ms, up to {fastest:.1f} m/s, under {_list(DRIVES)} N"
    return at_most(100 * worst, 1.0, "%", measured)


def _list(values: Array) -> str:
    return ", ".join(f"{value:.4g}" for value in values)
