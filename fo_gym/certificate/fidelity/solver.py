"""The plant against an independent solver: SciPy's LSODA on the equations, with Pinocchio's rigid body."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import mujoco
import numpy as np
import pinocchio
from numpy.typing import NDArray

from fo_gym.certificate.cases import ARM, OBSERVERS, TWO_LINK, Case, arm_case, link_case, paper_case
from fo_gym.certificate.oracle import pinocchio_model
from fo_gym.certificate.statement import Finding, at_most, check, near
from fo_gym.certificate.steppers import motion, plant, solver
from fo_gym.certificate.subject import Subject
from fo_gym.micro_steps import DEFAULT_PHYSICS_DT
from fo_gym.plant.rigid_body import RigidBody
from fo_gym.robots import LinkSide

Array = NDArray[np.float64]

EQUATIONS = "LSODA on the equations"
RIGID_BODY = "LSODA on the equations, Pinocchio's rigid body"
SEED = 20240611
HALVINGS = (1.0, 0.5, 0.25)
TWO_LINK_HOME = np.array([0.5, -1.0])


def _worst_random(subject: Subject, full: int, limit: float, unit: str, draw: Callable[..., Case]) -> Finding:
    """Largest error over random cases; case i is the same however many are run."""
    errors, moved = [], np.inf
    for i in range(subject.count(full)):
        case = draw(np.random.default_rng([SEED, i]), i)
        theirs = motion(case, solver(case))
        moved = min(moved, float(np.ptp(theirs, axis=0).max()))
        errors.append(float(np.abs(motion(case, plant(case, subject.physics_dt)) - theirs).max()))
    measured = (
        f"largest distance of links and motors from the solver in {len(errors)} cases; "
        f"median {np.median(errors):.1e} {unit}; each case moves by at least {moved:.2g} {unit}"
    )
    return at_most(max(errors), limit, unit, measured)


@check(
    "solver-link",
    source=EQUATIONS,
    text="Random single links (friction, joint, mass, gains, observer, push) follow the solver for 2 s within 10 um.",
)
def solver_link(subject: Subject) -> Finding:
    """Random single links."""
    return _worst_random(subject, 20, 1e-5, "m", link_case)


@check(
    "solver-two-link",
    source=RIGID_BODY,
    text="A planar arm of two links with random joints, control and push follows the solver for 1 s within 20 urad.",
)
def solver_two_link(subject: Subject) -> Finding:
    """Random joints on two links."""
    return _worst_random(subject, 12, 2e-5, "rad", lambda rng, i: arm_case(TWO_LINK, TWO_LINK_HOME, rng, i))


@check(
    "solver-arm",
    source=RIGID_BODY,
    text="The 7-joint arm with random joints, control and push follows the solver for 1 s within 50 urad.",
)
def solver_arm(subject: Subject) -> Finding:
    """Random joints on the 7-joint arm."""
    return _worst_random(subject, 8, 5e-5, "rad", lambda rng, i: arm_case(ARM.link_side, ARM.home, rng, i))


@cache
def _paper_solved(name: str) -> Array:
    case = paper_case(name)
    return motion(case, solver(case))


def _paper_error(name: str, physics_dt: float | None) -> float:
    """Largest distance of plant and solver in a case of the paper [m]."""
    case = paper_case(name)
    return float(np.abs(motion(case, plant(case, physics_dt)) - _paper_solved(name)).max())


@check(
    "solver-paper",
    source=EQUATIONS,
    text="The paper's single link under its six observers, without one, and without friction follows the solver for "
    "2 s of control at 1 kHz within 2 um.",
)
def solver_paper(subject: Subject) -> Finding:
    """The worst of eight cases."""
    errors = {name: _paper_error(name, subject.physics_dt) for name in (*OBSERVERS, "no-friction")}
    worst = max(errors, key=lambda name: errors[name])
    values = ", ".join(f"{name} {error:.1e}" for name, error in errors.items())
    return at_most(errors[worst], 2e-6, "m", f"largest distance of link and motor from the solver, {worst}; {values} m")


def _order(subject: Subject, name: str) -> tuple[float, list[float]]:
    """Slope of log(error) over log(micro-step) and the errors, from the subject's micro-step down."""
    steps = [(subject.physics_dt or DEFAULT_PHYSICS_DT) * share for share in HALVINGS]
    errors = [_paper_error(name, h) for h in steps]
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0]), errors


@check(
    "order-smooth",
    source="theory of the symmetric splitting; " + EQUATIONS,
    text="Without friction the plant's error falls with the square of the micro-step.",
)
def order_smooth(subject: Subject) -> Finding:
    """Observed order without friction."""
    order, errors = _order(subject, "no-friction")
    measured = f"slope over two halvings of the micro-step; errors {', '.join(f'{error:.1e}' for error in errors)} m"
    return near(order, 2.0, 0.1, "", measured)


@check(
    "order-stick-slip",
    source="theory of the implicit midpoint rule; " + EQUATIONS,
    text="Through stiction and slips, too, its error falls with the square of the micro-step, under every observer.",
)
def order_stick_slip(subject: Subject) -> Finding:
    """The observed order farthest from 2."""
    orders = {name: _order(subject, name)[0] for name in OBSERVERS}
    worst = max(orders, key=lambda name: abs(orders[name] - 2.0))
    values = ", ".join(f"{name} {order:.2f}" for name, order in orders.items())
    return near(orders[worst], 2.0, 0.1, "", f"slope over two halvings of the micro-step, farthest from 2; {values}")


def _rigid_body_difference(robot: LinkSide, poses: int) -> tuple[float, float]:
    """Largest relative difference of M and of C q' + g between MuJoCo and Pinocchio, over random poses and speeds."""
    generator, still = np.random.default_rng(SEED), np.zeros(robot.dof)
    body = RigidBody(robot, 1)
    model = pinocchio_model(body.model)
    data, worst = model.createData(), np.zeros(2)
    for _ in range(poses):
        q, w = generator.uniform(-np.pi, np.pi, robot.dof), generator.uniform(-3.0, 3.0, robot.dof)
        bias = body.dynamics(q[None], w[None])[1][0]
        upper = np.triu(pinocchio.crba(model, data, q))  # Pinocchio fills the upper triangle only
        inertia, theirs = upper + np.triu(upper, 1).T, pinocchio.rnea(model, data, q, w, still)
        pairs = ((body.dense_inertia(q[None])[0], inertia), (bias, theirs))
        worst = np.maximum(worst, [np.abs(a - b).max() / np.abs(b).max() for a, b in pairs])
    return float(worst[0]), float(worst[1])


@check(
    "inverse-dynamics",
    source="Pinocchio",
    text="MuJoCo and Pinocchio agree on inertia and bias of the 7-joint arm and of the two links to 1e-9.",
)
def inverse_dynamics(subject: Subject) -> Finding:
    """The larger of the relative differences of M and bias."""
    poses = subject.count(500)
    found = np.max([_rigid_body_difference(robot, poses) for robot in (ARM.link_side, TWO_LINK)], axis=0)
    measured = (
        f"largest relative difference over {poses} random poses and velocities; inertia {found[0]:.1e}, "
        f"bias {found[1]:.1e} (MuJoCo {mujoco.__version__}, Pinocchio {pinocchio.__version__})"
    )
    return at_most(found.max(), 1e-9, "", measured)
