"""Sinusoids that an arm's joints can follow about its home."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.plant.rigid_body import RigidBody
from fo_gym.robots import Robot
from fo_gym.robots.poses import joint_range, natural_units

Array = NDArray[np.float64]

AMPLITUDE = 0.3
"""Largest amplitude [rad, or natural units of a slide]."""

ROOM_SHARE = 0.5
"""Share of the way to the nearer end of its range that a joint's amplitude takes; the rest is for overshoot."""

FREQUENCIES = (0.15, 0.3)
"""Of the first and of the last joint [Hz]; those between are spread evenly, so that reversals seldom coincide.
Three to six of them in 10 s, and below half of the 5 rad/s of the designed motor PD."""

TORQUE_SHARE = 0.5
"""Share of the torque limits that inertia and gravity may take in the motion; friction, which plays no part so that the
motion is the same without it, and what overshoots need the rest."""

SIZES = (1.0, 0.8, 0.6, 0.45, 0.3, 0.2, 0.1)
"""Shares of the amplitude that are tried."""

_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))
"""The golden angle: phases in steps of it never fall together."""

_TIMES = 200

__all__ = ["fitted_sinusoids"]


def fitted_sinusoids(
    robot: Robot, amplitude: Array | None, frequency: Array | None, phase: Array | None
) -> tuple[Array, Array, Array]:
    """Amplitude [m | rad], frequency [Hz] and phase [rad] of every joint, (dof,) each; what is given is kept.

    Frequencies by FREQUENCIES, phases in steps of the golden angle. The amplitude is AMPLITUDE, ROOM_SHARE where the
    range asks for less, and for all joints together the largest of SIZES at which the full swings take TORQUE_SHARE of
    the torque limits at most.

    Raises:
        ValueError: even the smallest takes more of a joint's torque limit than there is.
    """
    joint = np.arange(robot.dof)
    if frequency is None:
        frequency = FREQUENCIES[0] + (FREQUENCIES[1] - FREQUENCIES[0]) * joint / max(1, robot.dof - 1)
    if phase is None:
        phase = (joint * _GOLDEN) % (2.0 * np.pi)
    if amplitude is None:
        model = robot.link_side.model
        low, high = joint_range(model)
        room = np.minimum(robot.home - low, high - robot.home)
        widest = np.minimum(AMPLITUDE * natural_units(model), ROOM_SHARE * room)
        amplitude = _within_limits(robot, widest, frequency, phase)
    return amplitude, frequency, phase


def _within_limits(robot: Robot, widest: Array, frequency: Array, phase: Array) -> Array:
    limit = np.asarray(robot.flexible.torque_limit)
    body = RigidBody(robot.link_side, _TIMES)
    for size in SIZES:
        share = (_torque(body, robot, size * widest, frequency, phase) / limit).max(axis=0)
        if np.all(share <= TORQUE_SHARE):
            return np.asarray(size * widest)
    worst = int(np.argmax(share))
    if share[worst] > 1.0:
        raise ValueError(
            f"joint {robot.joints[worst]!r} of robot {robot.name!r} has no torque to swing about its home: the "
            f"smallest swing takes {share[worst]:.3g} of its limit of {limit[worst]:g}; give another home or a higher "
            "limit"
        )
    return np.asarray(SIZES[-1] * widest)


def _torque(body: RigidBody, robot: Robot, amplitude: Array, frequency: Array, phase: Array) -> Array:
    """Size of the motors' torque in the swing, (n, dof): (M + B) q'' + C q' + g."""
    time = np.linspace(0.0, 1.0 / frequency.min(), _TIMES)[:, None]
    rate = 2.0 * np.pi * frequency
    q = robot.home + amplitude * np.sin(rate * time + phase)
    velocity = amplitude * rate * np.cos(rate * time + phase)
    acceleration = -(rate**2) * (q - robot.home)
    _, bias = body.dynamics(q, velocity)
    inertia = body.dense_inertia(q) + np.diag(np.asarray(robot.flexible.motor_inertia))
    return np.abs(np.einsum("nij,nj->ni", inertia, acceleration) + bias)
