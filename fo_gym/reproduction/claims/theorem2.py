"""Theorem 2's pair, (e', -tau_f_hat): passive for the PD-type, not for the PID-type.

For the PD-type -∫ e' tau_f_hat dt = B L (∫ e'^2 dt + L_p (e^2 - e(0)^2) / 2), never below minus what is stored in the
beginning, B L L_p e(0)^2 / 2. The PID-type's integral adds B L L_i ∫ e' (∫ e) dt: for e = A sin(w t) it outweighs the
first term where w^2 < L_i, by B L A^2 (w^2 - L_i) / 2 per second.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import FRICTION, JOINT
from fo_gym.certificate.statement import Finding, at_least, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.compensators import Compensator
from fo_gym.parameters import JointInfo
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.loop import run_loop
from fo_gym.reproduction.runs import GAINS
from fo_gym.signals import Signals

Array = NDArray[np.float64]

_DT = 1e-3
_AMPLITUDE = 5e-3
"""Of e(t), or of the moving target of a stuck motor [m]."""
_SLOW = 2.0
"""Frequency of the PID-type's counterexample [rad/s]: below sqrt(L_i) = 5 and 10 rad/s."""

__all__: list[str] = []


def _absorbed(observer: Compensator, e: Array, e_dot: Array) -> Array:
    """What the observer has taken up, -∫ e' tau_f_hat dt [J], at every tick of e (ticks, n), e' beside it."""
    ticks, n = e.shape
    zero, column = np.zeros((n, 1)), np.ones((n, 1))
    inertia, stiffness = JOINT.motor_inertia * column, JOINT.stiffness * column
    observer.reset(JointInfo(1, inertia, stiffness, np.inf * column, _DT), n)
    estimate = np.empty((ticks - 1, n))
    for k in range(ticks - 1):
        nominal, time = (e[k][:, None], e_dot[k][:, None]), np.full((n, 1), k * _DT)
        signals = Signals(zero, zero, zero, *nominal, zero, zero, zero, time, np.zeros((n, 0)))
        estimate[k] = observer.estimate(signals)[:, 0]
    return np.cumsum(-estimate * np.diff(e, axis=0), axis=0)


def _random_errors(n: int) -> tuple[Array, Array]:
    """Errors e and e', (ticks, n): ten sinusoids each of random size, frequency (0.02-20 Hz) and phase, over 20 s."""
    rng = np.random.default_rng(1907)
    time = _DT * np.arange(20_000)[:, None]
    e, e_dot = np.zeros((len(time), n)), np.zeros((len(time), n))
    for _ in range(10):
        omega = 2 * np.pi * np.exp(rng.uniform(np.log(0.02), np.log(20.0), n))
        size, phase = _AMPLITUDE * rng.normal(size=n) / omega, rng.uniform(0.0, 2 * np.pi, n)
        e += size * np.sin(omega * time + phase)
        e_dot += size * omega * np.cos(omega * time + phase)
    return e, e_dot


def _stored(gains: str, e: Array) -> Array:
    """B L L_p e^2 / 2 [J]."""
    return np.asarray(0.5 * JOINT.motor_inertia * GAINS[gains]["L"] * GAINS[gains]["Lp"] * np.square(e))


@claim(
    "theorem2-pd",
    source="Theorem 2, PD-type",
    text="The PD-type is passive in (e', -tau_f_hat): it never gives out more than was stored in the beginning.",
)
def _pd(subject: Subject) -> Finding:
    e, e_dot = _random_errors(subject.count(200))
    worst = np.inf
    for gains in GAINS:
        balance = _absorbed(subject.make(f"pd-{gains}"), e, e_dot) + _stored(gains, e[0])
        worst = min(worst, float((balance / _stored(gains, e).max(axis=0)).min()))
    text = f"least of (absorbed + stored at first), relative to the most stored, over {e.shape[1]} random e(t) of 20 s"
    return at_least(worst, 0.0, "", text)


@claim(
    "theorem2-pid",
    source="Theorem 2, PID-type",
    text="The PID-type is not: there is an e(t) along which it gives out energy without bound.",
)
def _pid(subject: Subject) -> Finding:
    time = _DT * np.arange(round(200 * np.pi / _SLOW / _DT) + 1)[:, None]
    e, e_dot = _AMPLITUDE * np.sin(_SLOW * time), _AMPLITUDE * _SLOW * np.cos(_SLOW * time)
    absorbed = _absorbed(subject.make("pid-low"), e, e_dot)[:, 0]
    largest = float(_stored("low", e).max())
    half = float(absorbed[len(absorbed) // 2])
    text = f"absorbed in 100 periods of e = A sin({_SLOW:g} t), low gains, over B L L_p A^2 / 2; in 50 periods "
    return at_most(float(absorbed[-1]) / largest, -10.0, "", f"{text}{half / largest:.4g}: it goes on in proportion")


def _stuck_work(subject: Subject, name: str) -> tuple[Array, Array]:
    """What the observer has absorbed at every tick [J], and e: a motor that cannot break free, a target that sways."""
    time = _DT * np.arange(60_000)[:, None]
    held = replace(FRICTION, f_c=100.0, f_s=150.0)
    target = _AMPLITUDE * np.sin(_SLOW * time)
    motion = run_loop(
        subject.make(name), target, np.zeros_like(target), dt=_DT, physics_dt=subject.physics_dt, friction=held
    )
    work = np.cumsum(-motion.tau_f_hat * np.diff(motion.e, axis=0), axis=0)
    return work[:, 0], motion.e[:, 0]


@claim(
    "theorem2-pd-stuck",
    source="Theorem 2, PD-type, on the stuck plant",
    text="While the motor is stuck and the nominal motor follows a swaying target, the PD-type stays passive.",
)
def _pd_stuck(subject: Subject) -> Finding:
    worst, end = np.inf, 0.0
    for gains in GAINS:
        work, e = _stuck_work(subject, f"pd-{gains}")
        worst, end = min(worst, float(work.min() / _stored(gains, e).max())), work[-1]
    text = f"least absorbed in 60 s, relative to the most stored, low and high gains, target {_AMPLITUDE:g} m at "
    return at_least(worst, -1e-3, "", f"{text}{_SLOW:g} rad/s; at the end, high gains, {end:.3g} J")


@claim(
    "theorem2-pid-stuck",
    source="Theorem 2, PID-type, on the stuck plant",
    text="On the same stuck motor the PID-type keeps giving out energy.",
)
def _pid_stuck(subject: Subject) -> Finding:
    work, e = _stuck_work(subject, "pid-low")
    largest = float(_stored("low", e).max())
    text = f"absorbed in 60 s, low gains, over B L L_p max(e)^2 / 2; in 30 s {work[len(work) // 2] / largest:.4g}"
    return at_most(work[-1] / largest, -10.0, "", text)
