"""The motivating example: what an observer does while the joint is stuck, and what feedback has to do with it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from fo_gym.certificate.cases import FRICTION, JOINT
from fo_gym.certificate.statement import Finding, at_least, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.compensators import Compensator
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.runs import STICTION, panels
from fo_gym.reproduction.team import Run, run_team

Array = NDArray[np.float64]

_SLIPS = 2.0 * float(FRICTION.v_s)
"""Speed from which on a joint has broken free [m/s]: at 2 v_s nearly all of the Stribeck curve lies behind it."""

_NOMINAL = ("pid-low", "pid-high", "pd-low", "pd-high")

__all__: list[str] = []


def _break_away(run: Run) -> tuple[int, float]:
    """Tick of the first break-away, and the largest |tau_f| until then [N]."""
    tick = int(np.argmax(np.abs(run.tick("theta_dot")) > _SLIPS))
    return tick, float(np.abs(run.period("tau_f")[:tick]).max(initial=0.0))


def _balance(run: Run) -> Array:
    """What friction would be at rest, tau_j - tau_m = tau_f_hat + tau_j - tau_c, mean over each period [N]."""
    tau_j = float(JOINT.stiffness) * (run.tick("theta") - run.tick("q"))
    return np.asarray((tau_j[:-1] + tau_j[1:]) / 2 - run.period("tau_m"))


@claim(
    "stuck-balance",
    source="motivating example",
    text="While the joint is at rest friction is tau_f = tau_f_hat + tau_j - tau_c: the estimate shifts it one to one.",
)
def _stuck_balance(subject: Subject) -> Finding:
    worst = 0.0
    for name in _NOMINAL:
        run = panels(subject)[name]
        around = round(0.05 / run.recording.dt)  # a joint that has just stopped still rings
        speed = maximum_filter1d(np.abs(run.tick("theta_dot")), around)[:-1]
        stuck = (speed < 0.1 * float(FRICTION.v_s)) & (run.time[:-1] > 10.0)
        worst = max(worst, float(np.abs(run.period("tau_f") - _balance(run))[stuck].max()))
    run = panels(subject)["pid-low"]
    tick, _ = _break_away(run)
    first = float(np.abs(run.period("tau_f") - _balance(run))[:tick].max())
    text = "largest |tau_f - (tau_f_hat + tau_j - tau_c)|, PID and PD, after 10 s where the speed stays below v_s / 10 "
    text += (
        f"for 50 ms; f_s = {float(FRICTION.f_s):g} N. Until the first break-away, where the motor is not at rest but "
    )
    return at_most(worst, 0.02, "N", f"{text}creeps, {first:.2g} N")


@claim(
    "break-away-force",
    source="motivating example",
    text="The joint breaks free when friction has reached f_s.",
    fails="LuGre breaks away below f_s, the more so the faster the force rises (Canudas de Wit et al. 1995, "
    "fig. on break-away force over force rate); here it first rises within hundredths of a second.",
)
def _break_away_force(subject: Subject) -> Finding:
    run = panels(subject)["pid-low"]
    share = _break_away(run)[1] / float(FRICTION.f_s)
    slow = np.abs(run.period("tau_f")[run.time[:-1] > 1.0]).max() / float(FRICTION.f_s)
    text = f"largest tau_f / f_s before |theta'| first passes {_SLIPS:g} m/s, PID, low gains; the largest after 1 s, "
    return at_least(share, 0.98, "", f"{text}where friction rises slowly towards each hop, is {slow:.3f}")


def _with_measured_feedback(compensator: Compensator) -> Compensator:
    compensator.feedback = "measured"
    return compensator


@lru_cache(maxsize=1)
def _measured(subject: Subject) -> dict[str, Run]:
    """The nominal-feedback observers with the controller on the measured motor: the ablation."""
    members = {name: _with_measured_feedback(subject.make(name)) for name in _NOMINAL}
    return run_team(members, STICTION, control_dt=subject.control_dt, physics_dt=subject.physics_dt)


def _late_span(run: Run) -> float:
    return float(np.ptp(run.tick("theta")[run.time >= 15.0]))


def _register(kind: str) -> None:
    name = f"{kind.upper()}-type"

    @claim(
        f"measured-feedback-{kind}",
        source="the paper's main point: nominal instead of measured feedback",
        text=f"The {name}, high gains, hunts with measured feedback, and hardly moves any more with nominal feedback.",
    )
    def _hunts(subject: Subject) -> Finding:
        measured = {gains: _late_span(_measured(subject)[f"{kind}-{gains}"]) for gains in ("low", "high")}
        nominal = _late_span(panels(subject)[f"{kind}-high"])
        text = f"peak to peak of theta over 15-20 s, high gains, nominal over measured feedback: {nominal:.2g} m over "
        text += f"{measured['high']:.3g} m; low gains, measured feedback, {measured['low']:.3g} m"
        return at_most(nominal / measured["high"], 0.01, "", text)


_register("pid")
_register("pd")
