"""What is stored in the joints when a push begins: as much the arm may give back without producing energy."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from fo_gym.simulation.simulation import Simulation

Array = NDArray[np.float64]

_PROBE = 1e-6
"""Step of the differences that give the controller's and gravity's stiffness [m | rad]."""

__all__ = ["stored_energy"]


def stored_energy(simulation: Simulation, ticks: Mapping[str, Array]) -> Array:
    """Energy stored in each episode when its push begins, (num_envs,), J; NaN without a push within it.

        S = (q_dot' M q_dot + theta_dot' B theta_dot + F' H^-1 F) / 2

    Kinetic energy of links and motors, and what springs, gravity and the controller hold above the pose in which they
    are in equilibrium: F is their static force on (q, theta), H the stiffness of both, so that the last term is exact
    for linear springs. Under nominal feedback the controller is a spring on theta_n instead of theta: S is the larger
    of the two that come of taking either for the motor. What a compensator keeps in its own states is its own, and
    does not count.

    Args:
        simulation: after its episodes; its reference is moved back to the pushes.
        ticks: theta, theta_dot, q, q_dot, theta_n and theta_n_dot as they truly were, (ticks, num_envs, dof).
    """
    starts = np.array([_start(simulation, i, len(ticks["q"])) for i in range(simulation.num_envs)])
    pushed = starts >= 0
    if not pushed.any():
        return np.full(simulation.num_envs, math.nan)
    at = {name: values[np.maximum(starts, 0), np.arange(simulation.num_envs)] for name, values in ticks.items()}
    simulation.control.ticks = np.maximum(starts, 0) * simulation.settings.decimation
    with np.errstate(over="ignore", invalid="ignore"):  # an episode may have ended before, anywhere
        stored = _energy(simulation, at["q"], at["q_dot"], at["theta"], at["theta_dot"])
        if simulation.settings.feedback == "nominal":
            stored = np.maximum(stored, _energy(simulation, at["q"], at["q_dot"], at["theta_n"], at["theta_n_dot"]))
    return np.where(pushed, stored, math.nan)


def _start(simulation: Simulation, i: int, ticks: int) -> int:
    """The last tick before the push of an episode; -1 where it has none."""
    push = simulation.scenarios[i].push
    tick = -1 if push is None else math.floor(push.time / simulation.settings.step_dt + 1e-9)
    return tick if tick < ticks else -1


def _energy(simulation: Simulation, q: Array, q_dot: Array, theta: Array, theta_dot: Array) -> Array:
    """The energy of links and motors in these states, (n, dof) each -> (n,)."""
    body, control = simulation.plant.body, simulation.control
    inertia, spring = simulation.plant.motor_inertia, simulation.plant.stiffness
    still = np.zeros_like(theta)
    tau_j = spring * (theta - q)
    force = np.concatenate([tau_j - body.gravity(q), control.torque(theta, still) - tau_j], axis=1)
    diagonal = spring[:, :, None] * np.eye(q.shape[1])
    gravity = _slope(body.gravity, q)
    controller = -_slope(lambda motor: control.torque(motor, still), theta)
    stiffness = np.block([[diagonal + gravity, -diagonal], [-diagonal, diagonal + controller]])
    kinetic = np.einsum("ni,nij,nj->n", q_dot, body.dense_inertia(q), q_dot) + np.sum(inertia * theta_dot**2, axis=1)
    return np.asarray(kinetic + [_held(*each) for each in zip(force, stiffness, strict=True)]) / 2.0


def _held(force: Array, stiffness: Array) -> float:
    """F' H^-1 F; directions without stiffness hold nothing, and what is not finite has no energy to speak of."""
    if not np.isfinite(force).all() or not np.isfinite(stiffness).all():
        return math.nan
    return max(float(force @ np.linalg.pinv(stiffness, hermitian=True) @ force), 0.0)


def _slope(function: Callable[[Array], Array], at: Array) -> Array:
    """Symmetric part of the derivative of a torque (n, dof) by positions (n, dof), (n, dof, dof)."""
    columns = []
    for joint in range(at.shape[1]):
        step = np.zeros(at.shape[1])
        step[joint] = _PROBE
        columns.append((function(at + step) - function(at - step)) / (2.0 * _PROBE))
    slope = np.stack(columns, axis=-1)
    return (slope + np.swapaxes(slope, 1, 2)) / 2.0
