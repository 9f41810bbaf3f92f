"""Every parameter of joint and friction matters, and by as much as the equations say."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import Case, paper_case
from fo_gym.certificate.oracle import SingleLink
from fo_gym.certificate.statement import Finding, Measure, at_least, check
from fo_gym.certificate.steppers import motion, plant, solver
from fo_gym.certificate.subject import Subject

Array = NDArray[np.float64]

FACTOR = 1.2
"""By which a parameter is changed."""

DAMPING = 20.0
"""What D_j is changed to from 0 [N s/m]."""

PARAMETERS = {
    "sigma_0": "bristle stiffness",
    "sigma_1": "bristle damping",
    "sigma_2": "viscous friction",
    "f_c": "Coulomb friction",
    "f_s": "stiction",
    "v_s": "the Stribeck velocity",
    "stiffness": "the spring's stiffness",
    "damping": "the spring's damping",
    "motor_inertia": "motor inertia",
    "mass": "link mass",
}


def _case(equations: SingleLink) -> Case:
    """Two seconds of pid-low on a link that a force of 4 N pulls to and fro at 1 Hz: it sticks, slips and reverses."""
    pull = 4.0 * np.sin(2 * np.pi * 1e-3 * np.arange(2000))
    return replace(paper_case("pid-low"), equations=equations, tau_ext=pull[:, None], mass_scale=equations.mass)


def _changed(name: str) -> SingleLink:
    """The paper's single link with one parameter changed, or as it is for ""."""
    link = paper_case("pid-low").equations
    assert isinstance(link, SingleLink)
    if name == "":
        return link
    if name == "mass":
        return replace(link, mass=FACTOR * link.mass)
    if name == "damping":
        return replace(link, joint=replace(link.joint, damping=DAMPING))
    part = "friction" if hasattr(link.friction, name) else "joint"
    owner = getattr(link, part)
    return replace(link, **{part: replace(owner, **{name: FACTOR * getattr(owner, name)})})


@cache
def _solved(name: str) -> Array:
    case = _case(_changed(name))
    return motion(case, solver(case))


@cache
def _stepped(name: str, physics_dt: float | None) -> Array:
    case = _case(_changed(name))
    return motion(case, plant(case, physics_dt))


def _measure(name: str) -> Measure:
    """The measurement for one parameter."""

    def _measured(subject: Subject) -> Finding:
        theirs = _solved(name) - _solved("")
        ours = _stepped(name, subject.physics_dt) - _stepped("", subject.physics_dt)
        change, error = np.abs(theirs).max(), np.abs(ours - theirs).max()
        measured = (
            "the solver's change of motion over the plant's error in it; "
            f"plant {1e6 * np.abs(ours).max():.2f} um, solver {1e6 * change:.2f} um, largest difference {error:.1e} m"
        )
        return at_least(change / error, 100.0, "", measured)

    return _measured


for _name, _words in PARAMETERS.items():
    _change = f"from 0 to {DAMPING:g} N s/m" if _name == "damping" else f"by {100 * (FACTOR - 1):.0f} %"
    check(
        f"sensitivity-{_name.replace('_', '-')}",
        source="LSODA on the equations",
        text=f"A change of {_words} {_change} moves link and motor at least 100 times as far as the plant errs in it.",
    )(_measure(_name))
