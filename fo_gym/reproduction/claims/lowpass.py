"""Each observer is a low-pass of friction: its frequency response, identified on the stick-slipping plant."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from fo_gym.certificate.cases import JOINT
from fo_gym.certificate.statement import Finding, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.parameters import FlexibleJoint
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.loop import run_loop
from fo_gym.reproduction.runs import GAINS

Array = NDArray[np.float64]

_DRAWS, _SECONDS, _SETTLE, _SEGMENT = 16, 14.0, 2.0, 12.0
_DAMPED = replace(JOINT, damping=20.0)
"""The paper's joint with a damped spring. The observer sees tau_j as it was at the tick, half a period late on average:
at the resonance of an undamped spring this shows, see lowpass-undamped."""
_RESONANCE = 15.0
"""Width of the undamped spring's resonance, to either side [rad/s]."""
_LOWEST = 2.0
"""From here up to L [rad/s]: below it the segments are too short."""

__all__: list[str] = []


def _transfer(kind: str, L: float, L_p: float, L_i: float) -> tuple[list[float], list[float]]:
    """Numerator and denominator of tau_f_hat / tau_f as the paper states it."""
    if kind == "pid":
        return [L, L * L_p, L * L_i], [1.0, L, L * L_p, L * L_i]
    if kind == "pd":
        return [L, L * L_p], [1.0, L, L * L_p]
    return [L], [1.0, L]


def _pushes(dt: float) -> Array:
    """Slow random pushes on the link, (ticks, draws) [N]: eight sinusoids of 2 N from 0.25 to 2 Hz, random phases.

    They turn the motion around a few times a second; each time friction jumps, which is what excites the observer up
    to L. Faster pushes would excite the spring instead.
    """
    rng = np.random.default_rng(1907)
    frequencies = 0.25 * np.arange(1, 9)
    phases = rng.uniform(0.0, 2.0 * np.pi, (len(frequencies), _DRAWS))
    time = dt * np.arange(round(_SECONDS / dt))
    return np.asarray(
        sum(2.0 * np.cos(2 * np.pi * f * time[:, None] + p) for f, p in zip(frequencies, phases, strict=True))
    )


def _ratio(subject: Subject, name: str, joint: FlexibleJoint) -> tuple[Array, Array]:
    """Measured over stated tau_f_hat / tau_f, complex, and its frequencies from _LOWEST to L [rad/s]."""
    kind, gains = name.split("-")
    values, dt = GAINS[gains], subject.control_dt
    pushes = _pushes(dt)
    still = np.zeros_like(pushes)
    motion = run_loop(subject.make(name), still, pushes, dt=dt, physics_dt=subject.physics_dt, joint=joint)
    friction, estimate = (x[round(_SETTLE / dt) :].T for x in (motion.tau_f, motion.tau_f_hat))
    frequency, cross = signal.csd(friction, estimate, fs=1.0 / dt, nperseg=round(_SEGMENT / dt))
    _, power = signal.welch(friction, fs=1.0 / dt, nperseg=round(_SEGMENT / dt))
    omega = 2.0 * np.pi * frequency
    band = (omega >= _LOWEST) & (omega <= values["L"])
    _, stated = signal.freqs(*_transfer(kind, values["L"], values["Lp"], values["Li"]), omega[band])
    return np.asarray((cross.mean(axis=0) / power.mean(axis=0))[band] / stated), omega[band]


@lru_cache(maxsize=3)
def _ratios(subject: Subject, kind: str) -> dict[str, tuple[Array, Array]]:
    return {gains: _ratio(subject, f"{kind}-{gains}", _DAMPED) for gains in GAINS}


_WHERE = f"from {_LOWEST:.1f} rad/s to L, low and high gains, spring damped by 20 N s/m"


def _magnitude(subject: Subject, kind: str) -> Finding:
    errors = {gains: np.abs(np.abs(ratio) - 1.0) for gains, (ratio, _) in _ratios(subject, kind).items()}
    worst = max(errors, key=lambda gains: float(errors[gains].max()))
    omega = _ratios(subject, kind)[worst][1]
    place = f"{worst} gains at {omega[errors[worst].argmax()]:.0f} rad/s"
    text = f"largest relative error of |tau_f_hat / tau_f| {_WHERE} ({place})"
    return at_most(np.max([error.max() for error in errors.values()]), 0.02, "", text)


def _phase(subject: Subject, kind: str) -> Finding:
    worst = np.max([np.abs(np.angle(ratio, deg=True)).max() for ratio, _ in _ratios(subject, kind).values()])
    return at_most(worst, 2.0, "degree", f"largest phase error of tau_f_hat / tau_f {_WHERE}")


def _register(kind: str, name: str, order: str) -> None:
    said = f"{name}'s estimate is {order} of the friction torque"
    source = f"friction observer, {name}"
    claim(f"lowpass-{kind}-magnitude", source=source, text=f"{said}: magnitude.")(
        lambda subject: _magnitude(subject, kind)
    )
    claim(f"lowpass-{kind}-phase", source=source, text=f"{said}: phase.")(lambda subject: _phase(subject, kind))


_register("pid", "PID-type", "the (3,2)-order low-pass L (s^2 + L_p s + L_i) / (s^3 + L s^2 + L L_p s + L L_i)")
_register("pd", "PD-type", "the (2,1)-order low-pass L (s + L_p) / (s^2 + L s + L L_p)")
_register("letien", "Le Tien", "the first-order low-pass L / (s + L)")


@claim(
    "lowpass-undamped",
    source="friction observer, PID-type",
    text="On the paper's undamped spring, too, the PID-type's estimate is its low-pass within 2 %, sampled at 10 kHz.",
    fails="The observer knows tau_j as it was at the tick, half a period late on average. At the resonance of the "
    "undamped spring tau_j is so much larger than friction that this alone exceeds 2 %; elsewhere it does not show.",
)
def _undamped(subject: Subject) -> Finding:
    ratio, omega = _ratio(subject, "pid-high", JOINT)
    error = np.abs(np.abs(ratio) - 1.0)
    away = error[np.abs(omega - omega[error.argmax()]) > _RESONANCE].max()
    text = f"largest relative error of |tau_f_hat / tau_f| from {_LOWEST:.1f} rad/s to L, high gains, at "
    text += f"{omega[error.argmax()]:.0f} rad/s; more than {_RESONANCE:g} rad/s away from there {away:.2g}"
    return at_most(error.max(), 0.02, "", text)
