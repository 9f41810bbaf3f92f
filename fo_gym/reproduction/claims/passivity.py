"""Passivity of the compensated joint at the port (tau_ext, q'): pushes of all kinds, and a damper that only takes.

Stored at the start, at rest with the target away from the joint: K_p theta_d^2 / 2 in the controller; springs,
bristles, motors and observer (e = e' = 0) are empty.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.statement import Finding, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.loop import GAINS as PD
from fo_gym.reproduction.loop import Motion, run_loop

Array = NDArray[np.float64]

_PUSHES, _SECONDS, _TARGET = 80, 10.0, 0.01
_PUSHED_DT, _DAMPED_DT = 2e-4, 1e-3
"""Control periods [s]; at 1 kHz the sampling itself gives a little energy to the shortest pushes."""
_DAMPER, _LONG = 0.2, 120.0
"""A light damper on the link [N s/m], and how long it is there [s]."""

__all__: list[str] = []


def _pushes(n: int) -> Array:
    """One to five pulses each, sin^2, 20 ms to 2 s long, of all strengths and both signs, (ticks, n) [N]."""
    rng = np.random.default_rng(1907)
    time = _PUSHED_DT * np.arange(round(_SECONDS / _PUSHED_DT))
    force = np.zeros((len(time), n))
    for i in range(n):
        for _ in range(rng.integers(1, 6)):
            length = np.exp(rng.uniform(np.log(0.02), np.log(2.0)))
            phase = (time - rng.uniform(0.0, _SECONDS - 1.0)) / length
            strength = rng.normal() * np.exp(rng.uniform(np.log(0.5), np.log(10.0)))
            force[:, i] += np.where((phase > 0.0) & (phase < 1.0), strength * np.sin(np.pi * phase) ** 2, 0.0)
    return force


def _given(motion: Motion) -> Array:
    """Energy that the joint has given to whoever pushes, at every tick, (ticks, n) [J]."""
    return np.cumsum(-motion.tau_ext * np.diff(motion.q, axis=0), axis=0)


def _stored(target: Array | float) -> Array:
    return np.asarray(0.5 * PD.kp * np.square(target))


def _under_pushes(subject: Subject, kind: str) -> Finding:
    pushes = _pushes(_PUSHES)
    # Log-uniform: where little was stored, little is needed to give out more.
    sizes = _TARGET * 10.0 ** np.random.default_rng(7).uniform(-2.0, 0.0, _PUSHES)
    target = np.tile(sizes, (len(pushes), 1))
    worst = -np.inf
    for gains in ("low", "high"):
        motion = run_loop(subject.make(f"{kind}-{gains}"), target, pushes, dt=_PUSHED_DT, physics_dt=subject.physics_dt)
        worst = max(worst, float((_given(motion).max(axis=0) / _stored(target[0])).max()))
    text = f"largest energy given out over the energy stored at the start, {_PUSHES} random pushes, low and high "
    text += "gains; a load made for it may get more, see passivity-damper"
    return at_most(worst, 1.0, "", text)


def _with_damper(subject: Subject, kind: str) -> Finding:
    target = np.full((round(_LONG / _DAMPED_DT), 1), _TARGET)
    still = np.zeros_like(target)
    motion = run_loop(
        subject.make(f"{kind}-low"), target, still, dt=_DAMPED_DT, physics_dt=subject.physics_dt, damper=_DAMPER
    )
    given = _given(motion)[:, 0]
    late = given[-1] - given[len(given) // 2]
    span = np.ptp(motion.theta[len(given) // 2 :])
    text = (
        f"given to a damper of {_DAMPER:g} N s/m on the link in the second of two minutes, low gains; theta moves by "
    )
    text += f"{span:.2g} m then; stored at the start {float(_stored(_TARGET)):.2g} J, given in all {given[-1]:.2g} J"
    return at_most(late, 1e-9, "J", text)


def _register_pushes(kind: str, name: str, source: str, fails: str = "") -> None:
    claim(
        f"passivity-pushes-{kind}",
        source=source,
        text=f"{name}: random pushes get no more out of the joint than was stored in it.",
        fails=fails,
    )(lambda subject: _under_pushes(subject, kind))


def _register_damper(kind: str, name: str, source: str, fails: str) -> None:
    claim(
        f"passivity-damper-{kind}",
        source=source,
        text=f"{name}: a damper, which can only take, is not fed for ever.",
        fails=fails,
    )(lambda subject: _with_damper(subject, kind))


_NOMINAL, _MEASURED = "passivity with nominal feedback", "Le Tien's observer, for comparison"
_HUNTING = (
    "A limit cycle that goes on under a small load is a source of energy: what the damper takes each minute is small, "
    "but without end, so that the joint is not passive."
)
_register_pushes("pid", "PID-type", _NOMINAL)
_register_pushes("pd", "PD-type", _NOMINAL)
_register_pushes(
    "letien",
    "Le Tien",
    _MEASURED,
    "It hunts: where next to nothing was stored, the hops that a push sets off give out many times that.",
)
_register_damper("pd", "PD-type", _NOMINAL, "")
_register_damper("pid", "PID-type", _NOMINAL, _HUNTING)
_register_damper("letien", "Le Tien", _MEASURED, _HUNTING)
