"""Tracking on the single link: what the observers leave of friction while the target moves."""

from __future__ import annotations

import numpy as np

from fo_gym.certificate.statement import Finding, near
from fo_gym.certificate.subject import Subject
from fo_gym.compensators import NoCompensation
from fo_gym.friction import FRICTIONLESS
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.loop import run_loop

_BANDWIDTHS = (25.0, 50.0, 100.0, 200.0, 400.0)

__all__: list[str] = []


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
