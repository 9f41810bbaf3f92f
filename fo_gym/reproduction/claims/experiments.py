"""The experiments on the arm, and tracking: what the observers do on seven joints of ours, not on the paper's robot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.statement import Finding, at_least, at_most, near
from fo_gym.certificate.subject import Subject
from fo_gym.compensators import NoCompensation
from fo_gym.parameters import FRICTIONLESS
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.loop import run_loop
from fo_gym.reproduction.runs import PAPER, long_hold, square
from fo_gym.reproduction.team import Run

Array = NDArray[np.float64]

_JOINT = 1
"""Joint 2, the one that the paper shows."""
_HOLD = (50.0, 60.0)
"""When the arm, pushed at 13 s, has long had time to come to rest [s]."""
_RESTS, _OSCILLATES = 0.01, 1.0
"""Peak to peak of a joint that rests, and of one that oscillates [mrad]."""
_BANDWIDTHS = (25.0, 50.0, 100.0, 200.0, 400.0)

__all__: list[str] = []


def _moves(subject: Subject, name: str) -> float:
    """Peak to peak of joint 2 in the end [mrad]."""
    run = long_hold(subject)[name]
    inside = (run.time >= _HOLD[0]) & (run.time <= _HOLD[1])
    return 1e3 * float(np.ptp(run.tick("theta", _JOINT)[inside]))


_SPAN = f"peak to peak of joint 2 over {_HOLD[0]:g}-{_HOLD[1]:g} s, after the push at 13 s"


@claim(
    "arm-pd-low-rests",
    source="regulation experiment, PD-type, low gains",
    text="On the arm the PD-type with low gains comes to rest.",
)
def _pd_low(subject: Subject) -> Finding:
    text = f"{_SPAN}; without friction the under-damped joint still rings by {_moves(subject, 'ideal'):.2g} mrad"
    return at_most(_moves(subject, "pd-low"), _RESTS, "mrad", text)


@claim(
    "arm-pid-low-oscillates",
    source="regulation experiment, PID-type, low gains",
    text="On the arm the PID-type with low gains oscillates.",
    fails="On our arm it comes to rest. The friction of the paper's robot is not published; ours was chosen to be "
    "plausible, not fitted to this curve.",
)
def _pid_low(subject: Subject) -> Finding:
    return at_least(_moves(subject, "pid-low"), _OSCILLATES, "mrad", _SPAN)


def _register_letien(gains: str, fails: str) -> None:
    @claim(
        f"arm-letien-{gains}-oscillates",
        source=f"regulation experiment, Le Tien, {gains} gain",
        text=f"On the arm Le Tien's observer with {gains} gain does not come to rest.",
        fails=fails,
    )
    def _letien(subject: Subject) -> Finding:
        return at_least(_moves(subject, f"letien-{gains}"), _OSCILLATES, "mrad", _SPAN)


_register_letien("low", "")
_register_letien(
    "high",
    "On our arm it rings longer than the others, and then comes to rest; the paper's experiment ends after 20 s.",
)


def _lost(run: Run, ideal: Run) -> float:
    """Root mean square distance of the tool from where it would be without friction [mm]."""
    return 1e3 * float(np.sqrt(np.square(run.tool() - ideal.tool()).sum(axis=1).mean()))


@claim(
    "square-everybody",
    source="square experiment",
    text="On the square every observer brings the tool closer to the friction-free motion.",
)
def _square(subject: Subject) -> Finding:
    runs = square(subject)
    lost = {name: _lost(run, runs["ideal"]) for name, run in runs.items()}
    worst = max(lost[name] for name in PAPER)
    text = f"worst observer's RMS distance from the ideal path over none's ({lost['none']:.3g} mm); "
    text += ", ".join(f"{name} {lost[name]:.3g}" for name in PAPER)
    return at_most(worst / lost["none"], 0.2, "", text)


@claim(
    "square-high-gains",
    source="square experiment",
    text="On the square higher gains are better for every observer, and the PID-type is the best of all.",
)
def _square_gains(subject: Subject) -> Finding:
    runs = square(subject)
    lost = {name: _lost(run, runs["ideal"]) for name, run in runs.items()}
    ratio = max(lost[f"{kind}-high"] / lost[f"{kind}-low"] for kind in ("pid", "pd", "letien"))
    best = min(PAPER, key=lambda name: lost[name])
    text = f"largest ratio of RMS distance, high over low gains, infinite if the best is not the PID-type; best: {best}"
    return at_most(ratio if best == "pid-high" else np.inf, 0.99, "", text)


def _tracking_errors(subject: Subject, name: str) -> list[float]:
    """RMS distance from the friction-free motion for each of _BANDWIDTHS, on a sine of 50 mm and 0.5 Hz [m]."""
    dt = subject.control_dt
    time = dt * np.arange(round(6.0 / dt))[:, None]
    target, late = 0.05 * np.sin(np.pi * time), len(time) // 3
    ideal = run_loop(
        NoCompensation(), target, 0.0 * target, dt=dt, physics_dt=subject.physics_dt, friction=FRICTIONLESS
    )
    errors = []
    for bandwidth in _BANDWIDTHS:
        observer = subject.make(name)
        observer.L = bandwidth  # type: ignore[attr-defined]
        motion = run_loop(observer, target, 0.0 * target, dt=dt, physics_dt=subject.physics_dt)
        errors.append(float(np.sqrt(np.square(motion.theta - ideal.theta)[late:].mean())))
    return errors


def _register_tracking(name: str, said: str) -> None:
    @claim(
        f"tracking-order-{name.partition('-')[0]}",
        source="performance: the larger L, the closer to the friction-free motion",
        text=f"In tracking, the distance from the friction-free motion falls as 1/L: {said}.",
    )
    def _order(subject: Subject) -> Finding:
        errors = _tracking_errors(subject, name)
        slope = float(np.polyfit(np.log(_BANDWIDTHS), np.log(errors), 1)[0])
        text = f"slope of log RMS over log L, L = {_BANDWIDTHS[0]:g} to {_BANDWIDTHS[-1]:g} 1/s; RMS "
        return near(slope, -1.0, 0.05, "", f"{text}{1e3 * errors[0]:.3g} to {1e3 * errors[-1]:.3g} mm")


_register_tracking("pid-low", "PID-type, L_p = 10, L_i = 25")
_register_tracking("pd-low", "PD-type, L_p = 10")
_register_tracking("letien-low", "Le Tien")
