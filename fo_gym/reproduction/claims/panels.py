"""The six panels of the simulation: who hunts, who settles, who stops off the target.

The paper shows curves, not numbers: what a panel shows is a verdict, and the bounds below are what it takes. A joint
hunts if it still moves by a tenth of a millimetre or more after ten seconds, rests if it moves by less than a
micrometre, and has settled if it stays within a hundredth of a millimetre of the target, a thousandth of the step.
"""

from __future__ import annotations

import numpy as np

from fo_gym.certificate.statement import Finding, at_least, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.runs import panels
from fo_gym.reproduction.team import Run

_HUNTS, _RESTS, _SETTLED = 1e-4, 1e-6, 1e-5
_SPAN = "peak to peak of theta over 10-20 s"

__all__: list[str] = []


def _error(run: Run) -> float:
    """What is left of theta - theta_d at the end [m]."""
    return float(run.tick("theta")[-1] - run.tick("theta_d")[-1])


def _span(run: Run, start: float = 10.0, end: float = 20.0) -> float:
    """Peak to peak of the motor from `start` to `end` [m]."""
    window = (run.time >= start - 1e-9) & (run.time <= end + 1e-9)
    return float(np.ptp(run.tick("theta")[window]))


def _hunting(subject: Subject, name: str) -> Finding:
    run = panels(subject)[name]
    size = _span(run)
    late = _span(run, 15.0)
    return at_least(
        size, _HUNTS, "m", f"{_SPAN}; over 15-20 s {late:.4g} m; theta(20 s) - theta_d = {_error(run):.4g} m"
    )


def _resting(subject: Subject, name: str) -> Finding:
    run = panels(subject)[name]
    return at_most(_span(run), _RESTS, "m", f"{_SPAN}; it rests at theta - theta_d = {_error(run):.4g} m")


@claim("panel-none", source="simulation", text="Without compensation the joint sticks short of its target.")
def _none(subject: Subject) -> Finding:
    run = panels(subject)["none"]
    ideal = abs(_error(panels(subject)["ideal"]))
    text = f"|theta - theta_d| at 20 s, of a step of 10 mm; without friction {ideal:.2g} m"
    return at_least(abs(_error(run)), 5e-3, "m", text)


@claim("panel-pid-low", source="simulation, PID-type, low gains", text="The PID-type with low gains oscillates.")
def _pid_low(subject: Subject) -> Finding:
    return _hunting(subject, "pid-low")


@claim(
    "panel-pid-high",
    source="simulation, PID-type, high gains",
    text="The PID-type with high gains settles at the target, without oscillation.",
)
def _pid_high(subject: Subject) -> Finding:
    run = panels(subject)["pid-high"]
    window = run.time >= 15.0
    worst = np.abs(run.tick("theta")[window] - run.tick("theta_d")[window]).max()
    return at_most(worst, _SETTLED, "m", f"largest |theta - theta_d| over 15-20 s; {_error(run):.3g} m at 20 s")


@claim(
    "panel-pd-low",
    source="simulation, PD-type, low gains",
    text="The PD-type with low gains does not oscillate: it comes to rest.",
)
def _pd_low(subject: Subject) -> Finding:
    return _resting(subject, "pd-low")


@claim(
    "panel-pd-low-error",
    source="simulation, PD-type, low gains",
    text="The PD-type with low gains rests visibly off the target.",
)
def _pd_low_error(subject: Subject) -> Finding:
    return at_least(abs(_error(panels(subject)["pd-low"])), _HUNTS, "m", "|theta - theta_d| at 20 s")


@claim(
    "panel-pd-high",
    source="simulation, PD-type, high gains",
    text="The PD-type with high gains comes to rest, too.",
)
def _pd_high(subject: Subject) -> Finding:
    return _resting(subject, "pd-high")


@claim(
    "panel-pd-gains",
    source="simulation, PD-type",
    text="Higher gains bring the PD-type's rest closer to the target.",
)
def _pd_gains(subject: Subject) -> Finding:
    high, low = (abs(_error(panels(subject)[name])) for name in ("pd-high", "pd-low"))
    return at_most(
        high / low, 0.5, "", f"|theta - theta_d| at 20 s, high gains over low: {high:.4g} m over {low:.4g} m"
    )


@claim("panel-letien-low", source="simulation, Le Tien, low gain", text="Le Tien's observer, low gain, oscillates.")
def _letien_low(subject: Subject) -> Finding:
    return _hunting(subject, "letien-low")


@claim("panel-letien-high", source="simulation, Le Tien, high gain", text="Le Tien's observer, high gain, oscillates.")
def _letien_high(subject: Subject) -> Finding:
    return _hunting(subject, "letien-high")


@claim(
    "panel-letien-gains",
    source="simulation, Le Tien",
    text="A higher gain makes Le Tien's oscillation smaller, but does not end it.",
)
def _letien_gains(subject: Subject) -> Finding:
    high, low = (_span(panels(subject)[name]) for name in ("letien-high", "letien-low"))
    text = f"{_SPAN}, high gain over low: {high:.4g} m over {low:.4g} m"
    return Finding(high / low, "", 0.1, 0.9, text)
