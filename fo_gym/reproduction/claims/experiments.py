"""The experiments on the arm, and tracking: what the observers do on seven joints of ours, not on the paper's robot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.compensators import NoCompensation
from fo_gym.parameters import FRICTIONLESS
from fo_gym.reproduction.loop import run_loop
from fo_gym.reproduction.runs import PAPER, regulation, square
from fo_gym.reproduction.statement import Finding, at_least, at_most, claim, near
from fo_gym.reproduction.subject import Subject
from fo_gym.reproduction.team import Run

Array = NDArray[np.float64]

_JOINT = 1
"""Joint 2, the one that the paper shows."""
_BEFORE, _AFTER = (12.0, 13.0), (19.0, 20.0)
"""The last second before the push, and the last of all [s]."""
_SLOW = (11.0, 13.0)
"""Long enough for a slow oscillation [s]."""
_BANDWIDTHS = (25.0, 50.0, 100.0, 200.0, 400.0)

__all__: list[str] = []


def _moves(run: Run, window: tuple[float, float]) -> float:
    """Peak to peak of joint 2 [mrad]."""
    inside = (run.time >= window[0]) & (run.time <= window[1])
    return 1e3 * float(np.ptp(run.tick("theta", _JOINT)[inside]))


def _movement(subject: Subject, name: str) -> str:
    runs = regulation(subject)
    before, after, ideal_before, ideal_after = (
        _moves(runs[who], window) for who in (name, "ideal") for window in (_BEFORE, _AFTER)
    )
    rings = f"without friction the under-damped joint rings by {ideal_before:.3g} and {ideal_after:.3g}"
    return f"before the push {before:.3g} mrad, at the end {after:.3g}; {rings}"


@claim(
    "arm-pd-low-rests",
    source="regulation experiment, PD-type, low gains",
    text="The PD-type with low gains comes to rest, before and after the push.",
)
def _pd_low(subject: Subject) -> Finding:
    run = regulation(subject)["pd-low"]
    text = f"peak to peak of joint 2 over one second, {_movement(subject, 'pd-low')}"
    return at_most(max(_moves(run, _BEFORE), _moves(run, _AFTER)), 0.2, "mrad", text)


@claim(
    "arm-pid-low-oscillates",
    source="regulation experiment, PID-type, low gains",
    text="The PID-type with low gains oscillates.",
    fails="On our arm it creeps to the target instead. The friction of the paper's robot is not published; ours was "
    "chosen to be plausible, not fitted to this curve.",
)
def _pid_low(subject: Subject) -> Finding:
    run = regulation(subject)["pid-low"]
    text = f"peak to peak of joint 2 over one second, {_movement(subject, 'pid-low')}"
    return at_least(max(_moves(run, _BEFORE), _moves(run, _AFTER)), 1.0, "mrad", text)


@claim(
    "arm-letien-moves",
    source="regulation experiment, Le Tien",
    text="Le Tien's observer does not come to rest, with either gain.",
)
def _letien(subject: Subject) -> Finding:
    least = min(_moves(regulation(subject)[f"letien-{gains}"], _SLOW) for gains in ("low", "high"))
    ideal = _moves(regulation(subject)["ideal"], _SLOW)
    text = "peak to peak of joint 2 over 11-13 s, the smaller of both gains; without friction the under-damped joint "
    text += f"rings by {ideal:.3g}"
    return at_least(least, 1.0, "mrad", text)


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
    ideal = run_loop(NoCompensation(), target, 0.0 * target, dt=dt, friction=FRICTIONLESS)
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
