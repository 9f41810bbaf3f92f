"""Where the PD-type rests on the arm, where gravity pulls."""

from __future__ import annotations

import numpy as np

from fo_gym.certificate.statement import Finding, at_least, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.plant.links import Links
from fo_gym.reproduction.arms import ARM, FRICTION, Arm
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.runs import GAINS
from fo_gym.reproduction.sensitivity import AS_IT_IS, held_arms
from fo_gym.tasks.regulation import regulation

_JOINT = 1
"""Joint 2, the one that the paper shows."""

__all__: list[str] = []


def _pd_low(subject: Subject) -> Arm:
    return held_arms(subject)[AS_IT_IS.name]["pd-low"]


@claim(
    "pd-rest-gravity",
    source="corollary on the PD-type at rest, with gravity",
    text="With gravity, too, theta_n rests at theta_d, so that theta - theta_d is -e.",
    fails="The controller compensates g(q_d), while the links weigh g(q): theta_n rests where "
    "K_p (theta_n - theta_d) = g(q_d) - g(q).",
)
def _gravity(subject: Subject) -> Finding:
    assert ARM.pd_gains is not None
    arm, links = _pd_low(subject), Links(ARM.link_side)
    target = regulation(ARM).fitted_to(ARM).reference.target(ARM.home)
    assert target is not None
    sag = (links.gravity(target[None]) - links.gravity(arm.q[-1:]))[0] / ARM.pd_gains.kp
    off, off_n = arm.error[-1, _JOINT], arm.error_n[-1, _JOINT]
    text = "|theta_n - theta_d| / |theta - theta_d| at joint 2 after 60 s, low gains; theta_n - theta_d is "
    text += f"{1e3 * off_n:.4g} mrad, (g(q_d) - g(q)) / K_p {1e3 * sag[_JOINT]:.4g} mrad"
    return at_most(abs(off_n / off), 0.01, "", text)


@claim(
    "pd-rest-bound-arm",
    source="corollary on the PD-type at rest, bound, with gravity",
    text="On the arm the PD-type rests within f_s / (B L L_p) of the target, gravity or not.",
)
def _bound(subject: Subject) -> Finding:
    stiffness = ARM.flexible.motor_inertia * GAINS["low"]["L"] * GAINS["low"]["Lp"]
    shares = np.abs(_pd_low(subject).error[-1]) * stiffness / FRICTION.f_s
    text = f"largest |theta - theta_d| B L L_p / f_s over joints after 60 s, low gains: joint {np.argmax(shares) + 1}"
    return at_most(float(shares.max()), 1.0, "", text)


@claim(
    "pd-rest-chance",
    source="regulation experiment, PD-type, low gains",
    text="Where the PD-type rests depends on how it got there: the error differs before and after the push.",
)
def _chance(subject: Subject) -> Finding:
    before, after = (float(_pd_low(subject).errors(end - 0.1, end, _JOINT).mean()) for end in (13.0, 20.0))
    text = f"|difference| at joint 2: {before:.3g} mrad before, {after:.3g} after (the paper's own arm: 3.6 and 1.9)"
    return at_least(abs(after - before), 0.3, "mrad", text)
