"""Ways to simulate a case, one control period at a time: the plant, its MuJoCo twin, a solver of SciPy."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import PERIOD, Case
from fo_gym.certificate.oracle import ATOL, RTOL, sampled

Array = NDArray[np.float64]

Stepper = Callable[[Array], Array]
"""From the external torque over a control period, (dof,), to links and motors after it, (2, dof)."""

__all__ = ["Stepper", "motion", "plant", "solver", "twin"]


def plant(case: Case, step: float | None = None) -> Stepper:
    """The suite's plant at a micro-step [s]; None means its default."""
    body = case.plant(step)
    control = case.control(body.theta.copy())

    def period(push: Array) -> Array:
        body.step(control(body.theta, body.theta_dot, body.tau_j), push[None])
        return np.stack([body.q[0], body.theta[0]])

    return period


def twin(case: Case, step: float, integrator: str) -> Stepper:
    """The plant's MuJoCo twin at a time step [s]."""
    start = case.plant()
    model, data = start.to_mujoco(timestep=step, integrator=integrator)
    control, joint = case.control(start.theta[0].copy()), case.equations.joint
    position, velocity = data.qpos.reshape(2, -1), data.qvel.reshape(2, -1)  # views: links, then motors
    steps = round(PERIOD / step)

    def period(push: Array) -> Array:
        tau_j = joint.stiffness * (position[1] - position[0]) + joint.damping * (velocity[1] - velocity[0])
        data.ctrl[:] = control(position[1], velocity[1], tau_j)
        data.qfrc_applied[: case.robot.dof] = push
        mujoco.mj_step(model, data, steps)
        return position.copy()

    return period


def solver(case: Case, method: str = "LSODA", rtol: float = RTOL, atol: float = ATOL) -> Stepper:
    """A solver of SciPy on the equations; as it stands, the truth that the others are held against."""
    start = case.plant()
    control, still = case.control(start.theta[0].copy()), np.zeros(case.robot.dof)
    state = np.stack([start.q[0], still, start.theta[0], still, still])

    def period(push: Array) -> Array:
        nonlocal state
        state = sampled(case.equations, control, state, push[None], method=method, rtol=rtol, atol=atol)[-1]
        return state[[0, 2]]

    return period


def motion(case: Case, period: Stepper) -> Array:
    """Links and motors at the ticks of a whole case, after the first, (periods, 2, dof), m | rad."""
    return np.array([period(push) for push in case.tau_ext])
