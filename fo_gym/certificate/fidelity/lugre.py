"""The joint kernel in the LuGre experiments of Canudas de Wit et al. (1995), against the numbers of a stiff solver."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import odeint

from fo_gym.certificate import experiments
from fo_gym.certificate.experiments import SAMPLE, Trace
from fo_gym.certificate.oracle import lugre
from fo_gym.certificate.statement import Finding, at_most, check, near
from fo_gym.certificate.subject import Subject
from fo_gym.friction import LuGre

Array = NDArray[np.float64]

SOURCE = "stiff solver on the experiment of Canudas de Wit et al. 1995"

TOLERANCE = 0.02
"""Share that a result may be off: the solver's numbers have three digits, and its forces are not held for 1 ms."""

LAG = {1.0: 1.389, 10.0: 1.378, 25.0: 1.344}
"""Largest friction [N] in the lag experiment by angular frequency [rad/s]."""

BREAK_AWAY = {1.0: 1.432, 2.0: 1.394, 5.0: 1.313, 10.0: 1.220, 20.0: 1.099, 30.0: 1.024, 40.0: 0.989, 50.0: 0.968}
"""Largest friction [N] before the motor slides by rate of the force [N/s]."""

_presliding = lru_cache(maxsize=1)(experiments.presliding)
_stick_slip = lru_cache(maxsize=1)(experiments.stick_slip)
_hunting = lru_cache(maxsize=1)(experiments.hunting)


def _held(subject: Subject, end: float, expected: float) -> Finding:
    """Displacement at the end of a hold."""
    position = 1e6 * _presliding(subject.physics_dt).position[round(end / SAMPLE) - 1]
    return near(position, expected, TOLERANCE, "um", f"displacement at {end:g} s, the end of the hold")


@check(
    "presliding-forward",
    source=SOURCE,
    text="A force raised to 1.425 N at 0.1425 N/s and held for 5 s, below break-away, bends the bristles by 45.3 um.",
)
def presliding_forward(subject: Subject) -> Finding:
    """Displacement at the end of the first hold."""
    return _held(subject, 15.0, 45.3)


@check(
    "presliding-back",
    source=SOURCE,
    text="Reversed to -1.425 N and held for 5 s, the motor lies at -10.0 um: presliding has hysteresis.",
)
def presliding_back(subject: Subject) -> Finding:
    """Displacement at the end of the second hold."""
    return _held(subject, 40.0, -10.0)


@check(
    "presliding-loop",
    source="LSODA on the equations",
    text="The whole presliding loop follows the solver within 0.02 % of the largest displacement.",
)
def presliding_loop(subject: Subject) -> Finding:
    """Largest distance of kernel and solver over 40 s."""
    friction, force = LuGre(**experiments.PAPER), experiments.presliding_force

    def rates(t: float, x: Array) -> list[float]:
        z_rate, tau_f = lugre(x[1].item(), x[2].item(), friction)
        return [x[1], force(t) + tau_f, z_rate]

    trace = _presliding(subject.physics_dt)
    times = np.append(0.0, trace.time)
    options: dict[str, Any] = {"rtol": 1e-9, "atol": 1e-13, "tcrit": [10.0, 15.0, 35.0, 40.0], "mxstep": 10_000}
    theirs = odeint(rates, np.zeros(3), times, tfirst=True, **options)[1:, 0]
    error, largest = np.abs(trace.position - theirs).max(), np.abs(theirs).max()
    measured = f"largest distance from the solver over 40 s, {1e9 * error:.2g} nm of {1e6 * largest:.1f} um"
    return at_most(100 * error / largest, 0.02, "%", measured)


def _worst(name: str, unit: str, found: dict[float, float], expected: dict[float, float]) -> Finding:
    """The largest deviation of several results."""
    shares = {key: 100 * abs(found[key] / expected[key] - 1) for key in expected}
    worst = max(shares, key=lambda key: shares[key])
    values = ", ".join(f"{found[key]:.3f}" for key in expected)
    places = ", ".join(f"{key:g}" for key in expected)
    measured = f"largest deviation, at {worst:g} {unit}; {name} {values} N at {places} {unit}"
    return at_most(shares[worst], 100 * TOLERANCE, "%", measured)


@check(
    "frictional-lag",
    source=SOURCE,
    text="Largest friction while the velocity oscillates at 1, 10 and 25 rad/s: 1.389, 1.378 and 1.344 N within 2 %.",
)
def frictional_lag(subject: Subject) -> Finding:
    """The worst of three frequencies."""
    found = {omega: experiments.frictional_lag(omega, subject.physics_dt).friction.max() for omega in LAG}
    return _worst("friction", "rad/s", found, LAG)


@check(
    "break-away",
    source=SOURCE,
    text="Break-away force falls from 1.432 N at 1 N/s to 0.968 N at 50 N/s, at eight rates within 2 %.",
)
def break_away(subject: Subject) -> Finding:
    """The worst of eight rates."""
    found = {rate: experiments.break_away(rate, subject.physics_dt).friction.max() for rate in BREAK_AWAY}
    return _worst("friction", "N/s", found, BREAK_AWAY)


def _onsets(trace: Trace) -> NDArray[np.intp]:
    """Samples at which the motor starts to slip: its speed passes 10 mm/s."""
    fast = trace.velocity > 1e-2
    return np.flatnonzero(fast[1:] & ~fast[:-1])


def _mean_step(values: Array, expected: float, unit: str, what: str) -> Finding:
    """Mean difference of neighbours; NaN, and so no match, where there are none."""
    steps = np.diff(values)
    if len(steps) == 0:
        return near(np.nan, expected, TOLERANCE, unit, f"no {what}")
    measured = f"mean of {len(steps)} {what}, between {steps.min():.4g} and {steps.max():.4g} {unit}"
    return near(steps.mean(), expected, TOLERANCE, unit, measured)


@check("stick-slip-onset", source=SOURCE, text="Pulled over a soft spring, the motor first slips after 7.46 s.")
def stick_slip_onset(subject: Subject) -> Finding:
    """Time of the first slip."""
    trace = _stick_slip(subject.physics_dt)
    onsets = trace.time[_onsets(trace)]
    measured = f"start of the first of {len(onsets)} slips in 34 s"
    return near(onsets[0] if len(onsets) else np.nan, 7.46, TOLERANCE, "s", measured)


@check("stick-slip-period", source=SOURCE, text="Pulled over a soft spring, the motor slips every 6.36 s.")
def stick_slip_period(subject: Subject) -> Finding:
    """Mean time between slips."""
    trace = _stick_slip(subject.physics_dt)
    return _mean_step(trace.time[_onsets(trace)], 6.36, "s", "periods")


@check("stick-slip-distance", source=SOURCE, text="Pulled over a soft spring, the motor slips by 0.636 m each time.")
def stick_slip_distance(subject: Subject) -> Finding:
    """Mean distance from standstill to standstill."""
    trace = _stick_slip(subject.physics_dt)
    standing = trace.position[_onsets(trace) - round(1.0 / SAMPLE)]
    return _mean_step(standing, 0.636, "m", "slips, from 1 s before one to 1 s before the next")


@check("stick-slip-speed", source=SOURCE, text="Pulled over a soft spring, the motor slips at up to 0.37 m/s.")
def stick_slip_speed(subject: Subject) -> Finding:
    """Largest speed over all slips."""
    return near(_stick_slip(subject.physics_dt).velocity.max(), 0.37, TOLERANCE, "m/s", "largest speed in 34 s")


@check("hunting-peak", source=SOURCE, text="Under PID position control to 1 m the motor first overshoots to 1.50 m.")
def hunting_peak(subject: Subject) -> Finding:
    """Largest position."""
    return near(_hunting(subject.physics_dt).position.max(), 1.50, TOLERANCE, "m", "largest position in 120 s")


@check(
    "hunting-amplitude",
    source=SOURCE,
    text="Under PID position control the motor ends in a limit cycle of 0.0645 m to either side.",
)
def hunting_amplitude(subject: Subject) -> Finding:
    """Half the span of the second minute."""
    late = _hunting(subject.physics_dt).position[round(60.0 / SAMPLE) :] - 1.0
    measured = f"half the span of the second minute, which reaches {late.min():.4f} and {late.max():.4f} m"
    return near(np.ptp(late) / 2, 0.0645, TOLERANCE, "m", measured)


@check(
    "hunting-period", source=SOURCE, text="Under PID position control the motor's limit cycle has a period of 24.4 s."
)
def hunting_period(subject: Subject) -> Finding:
    """Time between the last two rising passages of the target."""
    trace = _hunting(subject.physics_dt)
    past = trace.position > 1.0
    rises = trace.time[np.flatnonzero(past[1:] & ~past[:-1])]
    period = rises[-1] - rises[-2] if len(rises) > 1 else np.nan
    return near(period, 24.4, TOLERANCE, "s", "time between the last two rising passages of the target")
