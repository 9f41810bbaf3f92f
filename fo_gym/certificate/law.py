"""Certify a friction law, one of a user's own included: its step against its equations, and what a law must do."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import JOINT, LINK, OBSERVERS, PERIOD
from fo_gym.certificate.experiments import SAMPLE, Joint
from fo_gym.certificate.law_oracle import LawLink, law_motion
from fo_gym.certificate.oracle import Control
from fo_gym.certificate.statement import Finding, at_most
from fo_gym.checks import instance
from fo_gym.friction import FrictionLaw
from fo_gym.micro_steps import micro_steps
from fo_gym.parameters import check_joints, one_joint
from fo_gym.plant import FlexibleJointPlant

Array = NDArray[np.float64]

SOLVER = 2e-6
"""Largest distance from SciPy, as a share of a motion of 1 m: 2 um on the paper's single link."""

_STEADY, _SETTLING = 1e-6, 4_000

__all__ = ["SOLVER", "certify", "creep", "follows", "settles", "solver_error"]


def _pull(law: FrictionLaw) -> Array:
    """Two seconds of a force on the link of four times Coulomb friction at 1 Hz: it sticks, slips and reverses [N]."""
    return np.asarray(4.0 * law.level("coulomb", 1.0) * np.sin(2 * np.pi * PERIOD * np.arange(2000)))


def solver_error(law: FrictionLaw, physics_dt: float | None = None, observer: str = "pid-low") -> tuple[float, float]:
    """(largest distance of plant and solver, size of the motion) [m], under one of OBSERVERS on the single link.

    Args:
        law: of one joint, with numbers for its arrays.
        physics_dt: micro-step [s]; None for the plant's default, "auto" is not for comparisons.
        observer: whose gains.
    """
    pull, gains = _pull(law), OBSERVERS[observer]
    theirs = law_motion(LawLink(JOINT, law), Control(PERIOD, **gains, theta_n=0.0), pull)
    plant = FlexibleJointPlant(LINK, 1, joints=JOINT, friction=law, control_dt=PERIOD, physics_dt=physics_dt)
    control, ours = Control(PERIOD, **gains, theta_n=0.0), np.empty_like(theirs)
    for k, force in enumerate(pull):
        tau_m = control(plant.theta[0, 0], plant.theta_dot[0, 0], plant.tau_j[0, 0])
        plant.step(np.array([[tau_m]]), np.array([[force]]))
        ours[k] = plant.q[0, 0], plant.theta[0, 0]
    return float(np.abs(ours - theirs).max()), float(np.ptp(theirs[:, 1]))


def follows(law: FrictionLaw, physics_dt: float | None = None) -> Finding:
    """Whether the plant follows the law's own equations."""
    error, size = solver_error(law, physics_dt)
    measured = (
        f"largest distance of link and motor from SciPy on the law's equations in 2 s, on a motion of {size:.2g} m"
    )
    return at_most(error, SOLVER, "m", measured)


def settles(law: FrictionLaw) -> Finding:
    """Whether friction at constant velocity comes to the steady curve, whatever the velocity times the step."""
    stribeck, worst = float(law.level("stribeck", 1e-3)), 0.0
    velocities = stribeck * np.array([-1e4, -10.0, -1.0, 0.5, 1.0, 2.0, 100.0, 1e5])
    for v in velocities.tolist():
        z, memory = np.zeros(law.states), np.zeros(max(1, law.memory))
        for _ in range(_SETTLING):
            law.respond(v, z, 2e-4, law, memory)
            tau_f = law.step(v, z, 2e-4, law, memory)
        steady = float(law.steady(v))
        worst = max(worst, abs(tau_f - steady) / max(abs(steady), 1e-300))
    measured = f"largest relative difference of friction and `steady` after 0.8 s at {len(velocities)} velocities"
    return at_most(worst, _STEADY, "", measured)


def creep(law: FrictionLaw, physics_dt: float | None = None, share: float = 0.5) -> Finding:
    """Whether a motor of 1 kg rests under a force of a share of Coulomb friction: its mean speed over 10 s of it."""
    joint, load = Joint(friction=law), share * float(law.level("coulomb", 1.0))
    steps = micro_steps(SAMPLE, physics_dt)
    for k in range(1000):
        joint.advance(load * (k + 0.5) / 1000, steps, SAMPLE / steps)
    joint.advance(load, 10_000 * steps, SAMPLE / steps)
    before = joint.theta
    joint.advance(load, 10_000 * steps, SAMPLE / steps)
    measured = f"mean speed over 10 s, 10 s after the force had come to {share:g} of Coulomb friction"
    return at_most(abs(joint.theta - before) / 10.0, 1e-15, "m/s", measured)


def certify(law: FrictionLaw, physics_dt: float | None = None) -> dict[str, Finding]:
    """What a law is found to do on the paper's single link; `Finding.holds` says whether that is what it should.

    Args:
        law: of one joint, in N, m, s.
        physics_dt: micro-step [s]; None for the plant's default.

    Returns:
        "solver": the compiled step follows the law's equations, which SciPy solves, within 2 um for 2 s.
        "steady": at constant velocity it comes to the curve `steady`.
        "creep": at half its Coulomb friction a motor rests; a law without stiction of its own fails that, and rightly.

    Raises:
        ValueError: it is no friction law, or of several joints, or the micro-step is too long for it.
    """
    instance("law", law, FrictionLaw)
    check_joints(law, 1)
    one: Any = one_joint(law)
    return {"solver": follows(one, physics_dt), "steady": settles(one), "creep": creep(one, physics_dt)}
