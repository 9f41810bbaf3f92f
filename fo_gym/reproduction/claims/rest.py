"""Where the observers rest: what the PD-type leaves, and friction that is constant in stiction."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fo_gym.certificate.cases import FRICTION
from fo_gym.certificate.statement import Finding, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.evaluation.episode.recorder import record
from fo_gym.evaluation.runs.seeds import VALIDATION_SEEDS, first
from fo_gym.friction import LuGre
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.loop import Motion, run_loop
from fo_gym.reproduction.runs import GAINS, STICTION, panels
from fo_gym.reproduction.team import Run

_TARGET, _SECONDS, _DT, _CONSTANT = 0.01, 20.0, 1e-3, 1.0
"""Step [m], duration [s], control period [s] and constant friction [N] of the runs under other friction."""

__all__: list[str] = []


def _stiffness(gains: str, motor_inertia: float = 1.0) -> float:
    """B L L_p of the PD-type [N/m | N m/rad]."""
    return motor_inertia * GAINS[gains]["L"] * GAINS[gains]["Lp"]


def _lag_and_friction(subject: Subject, gains: str) -> tuple[float, float]:
    """(B L L_p e, tau_f) of the PD-type at rest at 20 s [N]."""
    run = panels(subject)[f"pd-{gains}"]
    e = run.tick("theta_n")[-2] - run.tick("theta")[-2]
    return float(_stiffness(gains) * e), float(run.period("tau_f")[-1])


@claim(
    "pd-rest-size",
    source="corollary on the PD-type at rest, size",
    text="At rest the PD-type leaves an error e of the size of tau_f / (B L L_p).",
)
def _pd_rest_size(subject: Subject) -> Finding:
    pairs = [_lag_and_friction(subject, gains) for gains in GAINS]
    worst = max(abs(abs(lag / friction) - 1.0) for lag, friction in pairs)
    text = "largest | |B L L_p e / tau_f| - 1 | at 20 s, low and high gains; tau_f = "
    return at_most(worst, 1e-3, "", text + " and ".join(f"{friction:.4g} N" for _, friction in pairs))


@claim(
    "pd-rest-sign",
    source="corollary on the PD-type at rest, sign as printed",
    text="At rest the PD-type's error is e = + tau_f / (B L L_p).",
    fails="At rest tau_f_hat = tau_f, and tau_f_hat = - B L L_p e: the sign is minus, e = - tau_f / (B L L_p).",
)
def _pd_rest_sign(subject: Subject) -> Finding:
    ratios = [lag / friction for lag, friction in (_lag_and_friction(subject, gains) for gains in GAINS)]
    text = f"B L L_p e / tau_f at 20 s, low gains; high gains {ratios[1]:.4f}"
    return Finding(ratios[0], "", 0.99, 1.01, text)


def _rests_of_draws(subject: Subject, gains: str) -> list[float]:
    """|theta - theta_d| B L L_p / f_s of random joints of the single link at 20 s."""
    seeds = first(VALIDATION_SEEDS, subject.count(50))
    name = f"pd-{gains}"
    recording = record(subject.make(name), name, STICTION, "randomized", seeds, {"physics_dt": subject.physics_dt})
    shares = []
    for run in (Run(recording, row) for row in range(len(seeds))):
        error = abs(run.tick("theta")[-1] - run.tick("theta_d")[-1])
        shares.append(error * _stiffness(gains, run.parameter("motor_inertia")) / run.parameter("f_s"))
    return shares


@claim(
    "pd-rest-bound",
    source="corollary on the PD-type at rest, bound",
    text="Without gravity the PD-type rests within f_s / (B L L_p) of the target.",
)
def _pd_rest_bound(subject: Subject) -> Finding:
    shares = [share for gains in GAINS for share in _rests_of_draws(subject, gains)]
    text = f"largest |theta - theta_d| B L L_p / f_s at 20 s over {len(shares)} random joints, low and high gains"
    return at_most(max(shares), 1.0, "", text)


@lru_cache(maxsize=8)
def _under_constant_friction(subject: Subject, name: str) -> Motion:
    """tau_f = - sigma_2 v - c: viscous friction, and a constant force on the motor in place of dry friction."""
    viscous = LuGre(sigma_0=0.0, sigma_1=0.0, sigma_2=FRICTION.sigma_2, f_c=0.0, f_s=0.0, v_s=1.0)
    target = np.full((round(_SECONDS / _DT), 1), _TARGET)
    return run_loop(
        subject.make(name),
        target,
        np.zeros_like(target),
        dt=_DT,
        physics_dt=subject.physics_dt,
        friction=viscous,
        motor_offset=-_CONSTANT,
    )


@claim(
    "constant-pid",
    source="stiction analysis, friction constant in stiction",
    text="Under friction that is constant in stiction the PID-type settles at e = 0.",
)
def _constant_pid(subject: Subject) -> Finding:
    worst = max(abs(_under_constant_friction(subject, f"pid-{gains}").e[-1, 0]) for gains in GAINS)
    text = f"|e| at 20 s under tau_f = -sigma_2 v - {_CONSTANT:g} N, the larger of low and high gains"
    return at_most(worst, 1e-9, "m", text)


@claim(
    "constant-pd",
    source="stiction analysis, friction constant in stiction",
    text="Under friction that is constant in stiction the PD-type settles at e = - tau_f / (B L L_p).",
)
def _constant_pd(subject: Subject) -> Finding:
    ratios = {
        gains: _under_constant_friction(subject, f"pd-{gains}").e[-1, 0] * _stiffness(gains) / _CONSTANT
        for gains in GAINS
    }
    worst = max(abs(ratio - 1.0) for ratio in ratios.values())
    text = f"largest |-B L L_p e / tau_f - 1| at 20 s under tau_f = -sigma_2 v - {_CONSTANT:g} N, low and high gains"
    return at_most(worst, 1e-6, "", text)


@claim(
    "coulomb-pid",
    source="stiction analysis, no excess of stiction",
    text="Where stiction does not exceed Coulomb friction, f_s = f_c, the PID-type does not hunt.",
)
def _coulomb_pid(subject: Subject) -> Finding:
    target = np.full((round(_SECONDS / _DT), 1), _TARGET)
    spans = {}
    for gains in GAINS:
        motion = run_loop(
            subject.make(f"pid-{gains}"),
            target,
            np.zeros_like(target),
            dt=_DT,
            physics_dt=subject.physics_dt,
            friction=replace(FRICTION, f_s=FRICTION.f_c),
        )
        spans[gains] = (float(np.ptp(motion.theta[len(target) // 2 :])), abs(motion.e[-1, 0]))
    text = "peak to peak of theta over 10-20 s, the larger of low and high gains; still creeping, |e| at 20 s is "
    left = " and ".join(f"{e:.2g} m" for _, e in spans.values())
    return at_most(max(span for span, _ in spans.values()), 2e-5, "m", text + left)
