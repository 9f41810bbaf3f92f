"""The other friction laws, held against SciPy, against each other and against what each of them is known for."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import FRICTION
from fo_gym.certificate.law import SOLVER, creep, settles, solver_error
from fo_gym.certificate.presliding import PIECES, friction_on, tendons_on, vibrated, way
from fo_gym.certificate.statement import Finding, Measure, at_least, at_most, check, near
from fo_gym.certificate.subject import Subject
from fo_gym.friction import Dahl, ElastoPlastic, FrictionLaw, MaxwellSlip
from fo_gym.micro_steps import DEFAULT_PHYSICS_DT

Array = NDArray[np.float64]

MAXWELL = MaxwellSlip.like(FRICTION)
LAWS: dict[str, FrictionLaw] = {
    "dahl": Dahl.like(FRICTION),
    "elasto-plastic": ElastoPlastic.like(FRICTION),
    "maxwell-slip": MAXWELL,
}
"""Beside LuGre, like the paper's, by the names in the table."""

EVERY: dict[str, FrictionLaw] = {"lugre": FRICTION, **LAWS}

HOLD = ("elasto-plastic", "maxwell-slip")
"""Those that do not drift under a vibrating load."""

STICTION = float(FRICTION.f_s)

EQUATIONS = "LSODA on the law's equations, stopped where they change"

_NEAR, _BACK, _FAR = 2e-5, 1.2e-5, 6e-5
"""Turning points of a way below break-away [m]."""

_solver_error = cache(solver_error)


def _follows(name: str) -> Measure:
    def _measured(subject: Subject) -> Finding:
        error, size = _solver_error(LAWS[name], subject.physics_dt)
        return at_most(error, SOLVER, "m", f"largest distance of link and motor from the solver, of {size:.2g} m")

    return _measured


for _name in LAWS:
    check(
        f"law-{_name}-solver",
        source=EQUATIONS,
        text=f"Under {_name} friction the paper's single link (pid-low, pulled by 4 N at 1 Hz: it sticks, slips and "
        "reverses) follows the solver for 2 s within 2 um.",
    )(_follows(_name))


@check(
    "law-order",
    source=EQUATIONS,
    text="There the error of the laws with one bristle falls with the square of the micro-step.",
)
def law_order(subject: Subject) -> Finding:
    """The observed order farthest from 2, over a halving of the micro-step."""
    h, orders = subject.physics_dt or DEFAULT_PHYSICS_DT, {}
    for name in ("dahl", "elasto-plastic"):
        errors = [_solver_error(LAWS[name], subject.physics_dt)[0], _solver_error(LAWS[name], h / 2)[0]]
        orders[name] = float(np.log2(errors[0] / errors[1]))
    worst = max(orders, key=lambda name: abs(orders[name] - 2.0))
    values = ", ".join(f"{name} {order:.2f}" for name, order in orders.items())
    return near(orders[worst], 2.0, 0.2, "", f"order over a halving of the micro-step; {values}")


@check(
    "law-steady",
    source="each law's steady curve",
    text="At a constant velocity of up to 100 m/s, where a bristle relaxes thousands of times within a micro-step, "
    "every law comes to its steady friction within a part in 1e6.",
)
def law_steady(subject: Subject) -> Finding:
    """The worst of the laws."""
    found = {name: settles(law).number for name, law in EVERY.items()}
    worst = max(found, key=lambda name: found[name])
    return at_most(found[worst], 1e-6, "", f"largest relative difference, {worst}")


@check(
    "law-creep",
    source="the laws' equations: what is stuck holds any force below break-away",
    text="Under half of Coulomb friction, held, a motor does not creep by any law: less than 1e-15 m/s.",
)
def law_creep(subject: Subject) -> Finding:
    """The law that creeps fastest."""
    found = {name: creep(law, subject.physics_dt).number for name, law in EVERY.items()}
    worst = max(found, key=lambda name: found[name])
    return at_most(found[worst], 1e-15, "m/s", f"largest mean speed over 10 s, {worst}")


def _drift(name: str) -> Measure:
    def _measured(subject: Subject) -> Finding:
        speed = 1e6 * vibrated(EVERY[name], FRICTION, subject.physics_dt)
        measured = f"mean speed over 10 s, 2 s after the start; {10 * speed:.3g} um in that time"
        return at_most(speed, 1e-6, "um/s", measured) if name in HOLD else at_least(speed, 10.0, "um/s", measured)

    return _measured


for _name in EVERY:
    check(
        f"law-{_name}-vibration",
        source="Dupont et al. 2002: elasto-plastic presliding does not drift, LuGre's does",
        text=f"Under a load of (0.4 + 0.2 sin 20 pi t) f_c, below break-away, {_name} friction "
        + ("holds: less than 1 pm/s." if _name in HOLD else "lets the motor drift, by more than 10 um/s."),
    )(_drift(_name))


def _forgets(name: str) -> Measure:
    def _measured(subject: Subject) -> Finding:
        straight, by_way = way(_NEAR, _FAR), way(_NEAR, _BACK, _NEAR, _FAR)
        beyond = [friction_on(EVERY[name], positions)[-PIECES:] for positions in (straight, by_way)]
        share = 100 * float(np.abs(beyond[1] - beyond[0]).max()) / STICTION
        measured = "largest difference of friction beyond the reversal point, as a share of stiction"
        return at_most(share, 1e-6, "%", measured) if name == "maxwell-slip" else at_least(share, 5.0, "%", measured)

    return _measured


for _name in EVERY:
    check(
        f"law-{_name}-memory",
        source="nonlocal memory, Al-Bender, Lampaert, Swevers 2005",
        text=f"After an inner loop below break-away {_name} friction "
        + (
            "goes on as if there had been none: it remembers the reversal point."
            if _name == "maxwell-slip"
            else "does not find back: it is off by more than 5 % of stiction."
        ),
    )(_forgets(_name))


@check(
    "law-maxwell-slip-reversal",
    source="Masing's rule: a reversal curve is the first curve twice as large",
    text="From a reversal point Maxwell-slip friction falls along its first curve, twice as large, within 0.1 % of "
    "stiction.",
)
def maxwell_reversal(subject: Subject) -> Finding:
    """Largest difference along the whole of a reversal."""
    positions = way(_FAR, -_FAR)
    friction = friction_on(MAXWELL, positions)
    turn, back = friction[PIECES - 1], positions[PIECES:]
    first = np.interp(0.5 * (_FAR - back), np.append(0.0, positions[:PIECES]), np.append(0.0, friction[:PIECES]))
    share = 100 * float(np.abs(friction[PIECES:] - (turn - 2.0 * first)).max()) / STICTION
    return at_most(share, 0.1, "%", "largest difference on the way back, as a share of stiction")


@check(
    "law-maxwell-slip-presliding",
    source="LuGre's first presliding curve, f_s (1 - exp(-sigma_0 x / f_s))",
    text="Four springs fitted to it yield along LuGre's first presliding curve within 3 % of stiction.",
)
def maxwell_presliding(subject: Subject) -> Finding:
    """Largest difference of the two curves."""
    positions = way(1.2e-4)
    curve = -STICTION * np.expm1(-float(FRICTION.sigma_0) * positions / STICTION)
    share = 100 * float(np.abs(friction_on(MAXWELL, positions) - curve).max()) / STICTION
    return at_most(share, 3.0, "%", "largest difference over 0.12 mm, as a share of stiction")


@check(
    "law-maxwell-slip-tendons",
    source="MuJoCo's yielding springs: fixed tendons side by side with `springyield`",
    text="Through an inner loop and a full one Maxwell-slip friction is the force of as many yielding tendons of "
    "MuJoCo within 0.5 % of stiction.",
)
def maxwell_tendons(subject: Subject) -> Finding:
    """Largest difference on a way with five turns."""
    positions = way(_NEAR, _BACK, _NEAR, _FAR, -_FAR, _FAR, pieces=10 * PIECES)
    difference = np.abs(friction_on(MAXWELL, positions) - tendons_on(MAXWELL, positions)).max()
    return at_most(100 * float(difference) / STICTION, 0.5, "%", "largest difference, as a share of stiction")
