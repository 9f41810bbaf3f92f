"""The design by a Riccati equation, and the passivity condition of LuGre: matrices and numbers, no simulation.

With x = (e, e') or (int e, e, e') and u = tau_f_hat - tau_f plus what cancels B (L_p e' + L_i e), the error moves by
x' = A x + b u, and the observer's gain is R b' P x with P from A'P + P A - P b R b' P + Q = 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from fo_gym.certificate.cases import FRICTION
from fo_gym.certificate.oracle import lugre
from fo_gym.certificate.statement import Finding, at_least, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.claim import claim

Array = NDArray[np.float64]

_DRAWS = 1000
_CYCLE, _PULSE = 0.3, 1e-4
"""Of the velocity along which friction gives out energy [s]."""

__all__: list[str] = []


def _residual(A: Array, b: Array, P: Array, Q: Array, R: float) -> float:
    """Largest entry of A'P + P A - P b R b' P + Q, relative to the largest of its terms."""
    terms = (A.T @ P, P @ A, -R * np.outer(P @ b, P @ b), Q)
    return float(np.abs(sum(terms)).max() / max(np.abs(term).max() for term in terms))


def _pd(B: float, L_p: float, R: float, first: float) -> float:
    """Residual of the PD-type's identity with P_11 = first."""
    A = np.array([[0.0, 1.0], [0.0, -L_p]])
    P = np.array([[first, B * L_p], [B * L_p, B]])
    return _residual(A, np.array([0.0, 1.0 / B]), P, np.diag([R * L_p**2, R]), R)


def _pid(B: float, L_p: float, L_i: float, R: float) -> tuple[Array, Array, Array, Array]:
    """A, b, P and Q of the PID-type."""
    A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -L_i, -L_p]])
    gains = np.array([L_i, L_p, 1.0])
    P = B * np.outer(gains, gains)
    P[:2, :2] += R * np.array([[L_i * L_p, L_i], [L_i, L_p]])
    Q = R * np.diag([L_i**2, L_p**2 - 2.0 * L_i, 1.0])
    return A, np.array([0.0, 0.0, 1.0 / B]), P, Q


def _draws() -> list[tuple[float, float, float, float, float]]:
    """Random (B, L, L_p, L_i, R), with L_p^2 on either side of 2 L_i."""
    rng = np.random.default_rng(1907)
    low, high = np.log([[0.1, 10.0, 1.0, 0.1, 1.0], [10.0, 500.0, 50.0, 2e3, 1e3]])
    return [tuple(np.exp(rng.uniform(low, high)).tolist()) for _ in range(_DRAWS)]


@claim(
    "riccati-pid",
    source="design of the PID-type, Riccati identity",
    text="The PID-type's P solves the Riccati equation with Q = R diag(L_i^2, L_p^2 - 2 L_i, 1).",
)
def _riccati_pid(subject: Subject) -> Finding:
    worst = max(_residual(*_pid(B, L_p, L_i, R), R) for B, _, L_p, L_i, R in _draws())
    return at_most(worst, 1e-12, "", f"largest relative residual over {_DRAWS} random gains")


@claim(
    "riccati-pd-printed",
    source="design of the PD-type, Riccati identity as printed",
    text="The PD-type's P as printed, P_11 = L_p^2 + L_p R, solves the Riccati equation for Q = R diag(L_p^2, 1).",
    fails="P_11 lacks a factor B: as printed the identity holds for B = 1 only. See riccati-pd-corrected.",
)
def _riccati_pd_printed(subject: Subject) -> Finding:
    worst = max(_pd(B, L_p, R, L_p**2 + L_p * R) for B, _, L_p, _, R in _draws())
    unit = max(_pd(1.0, L_p, R, L_p**2 + L_p * R) for _, _, L_p, _, R in _draws())
    return at_most(worst, 1e-12, "", f"largest relative residual over {_DRAWS} random gains; with B = 1 {unit:.2g}")


@claim(
    "riccati-pd-corrected",
    source="design of the PD-type, Riccati identity, corrected",
    text="With P_11 = B L_p^2 + L_p R the PD-type's P solves the Riccati equation for every B.",
)
def _riccati_pd_corrected(subject: Subject) -> Finding:
    worst = max(_pd(B, L_p, R, B * L_p**2 + L_p * R) for B, _, L_p, _, R in _draws())
    return at_most(worst, 1e-12, "", f"largest relative residual over {_DRAWS} random gains")


@claim(
    "condition-q",
    source="design of the PID-type, condition L_p^2 > 2 L_i",
    text="The Q that belongs to the PID-type's P is positive definite just where L_p^2 > 2 L_i.",
)
def _condition_q(subject: Subject) -> Finding:
    wrong = 0
    for B, _, L_p, L_i, R in _draws():
        A, b, P, _ = _pid(B, L_p, L_i, R)
        Q = R * np.outer(P @ b, P @ b) - A.T @ P - P @ A
        scale = np.diag(1.0 / np.sqrt(R * np.array([L_i**2, L_p**2 + 2.0 * L_i, 1.0])))
        wrong += (np.linalg.eigvalsh(scale @ Q @ scale).min() > 0) != (L_p**2 > 2.0 * L_i)
    return at_most(wrong, 0, "", f"random gains, of {_DRAWS} on both sides, where Q > 0 and the condition disagree")


@claim(
    "condition-stability",
    source="design of the PID-type, condition L_p^2 > 2 L_i",
    text="The low-pass itself does not need the condition: it is stable where L L_p > L_i.",
)
def _condition_stability(subject: Subject) -> Finding:
    beyond = [(L, L_p, L_i) for _, L, L_p, L_i, _ in _draws() if L_p**2 <= 2.0 * L_i < 2.0 * L * L_p]
    slowest = max(np.roots([1.0, L, L * L_p, L * L_i]).real.max() for L, L_p, L_i in beyond)
    text = f"largest real part of a pole over {len(beyond)} random gains with L_p^2 <= 2 L_i and L L_p > L_i"
    return Finding(float(slowest), "1/s", -np.inf, -1e-9, text)


@claim(
    "lugre-passivity",
    source="assumption: friction is passive in velocity",
    text="With the paper's parameters LuGre meets the sufficient condition for the passivity of v -> -tau_f, "
    "sigma_2 > sigma_1 (f_s - f_c) / f_c.",
    fails="sigma_2 is far too small; and friction does give out energy, see lugre-cycle. On the condition: Barabanov "
    "and Ortega, Necessary and sufficient conditions for passivity of the LuGre friction model, IEEE Trans. Automatic "
    "Control 45(4), 2000.",
)
def _lugre_passivity(subject: Subject) -> Finding:
    needed = float(FRICTION.sigma_2 - FRICTION.passivity_margin())
    ratio = float(FRICTION.sigma_2) / needed
    text = f"sigma_2 over sigma_1 (f_s - f_c) / f_c = {needed:.4g} N s/m: too small by a factor of {1 / ratio:.0f}"
    return at_least(ratio, 1.0, "", text)


def _creep_and_jerk(t: float) -> float:
    """A velocity that repeats every 0.3 s [m/s]: 0.2 mm/s, and at the end a pulse of 1 m/s that lasts 0.1 ms."""
    phase = (t % _CYCLE - (_CYCLE - _PULSE)) / _PULSE
    return 2e-4 + (np.sin(np.pi * phase) ** 2 if phase > 0.0 else 0.0)


@claim(
    "lugre-cycle",
    source="assumption: friction is passive in velocity",
    text="With the paper's parameters LuGre gives out no energy over a cycle of creep and jerk.",
    fails="The bristle that creep has bent pushes on during the jerk: friction is not passive in velocity, as the "
    "condition of lugre-passivity, which is not met, lets expect.",
)
def _lugre_cycle(subject: Subject) -> Finding:
    def rates(t: float, x: Array) -> list[float]:
        v = _creep_and_jerk(t)
        z_rate, tau_f = lugre(v, float(x[0]), FRICTION)
        return [z_rate, -tau_f * v]

    state, taken = np.zeros(2), []
    for cycle in range(3):
        for start, end in ((0.0, _CYCLE - _PULSE), (_CYCLE - _PULSE, _CYCLE)):
            span = (cycle * _CYCLE + start, cycle * _CYCLE + end - 1e-12)
            state = solve_ivp(rates, span, state, method="Radau", rtol=1e-9, atol=1e-13).y[:, -1]
        taken.append(float(state[1]))
    text = (
        f"energy that friction takes in the third cycle of {_CYCLE:g} s: 0.2 mm/s, then 1 m/s for {1e3 * _PULSE:g} ms"
    )
    return at_least(taken[2] - taken[1], 0.0, "J", text)
