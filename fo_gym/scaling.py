"""Signals in units of a joint's own friction: what policies see, whatever the size of the joint."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import POSITIVE, number
from fo_gym.signals import SIGNALS, Signals

Array = NDArray[np.float64]

FRICTION_SHARE = 0.02
"""A small friction torque s, the unit of torques, as a share of a joint's torque limit."""

VELOCITY_GAIN, POSITION_GAIN = 100.0, 20.0
"""L and L_p of the observer whose torques positions and velocities are measured by [1/s]: the paper's high gains."""

LARGEST = 10.0
"""Bound of every scaled value; arsinh reaches it at 11013 units."""

ACTION_SHARES = {"compensation": 0.3, "torque": 1.0}
"""What the action 1 means, by action mode, as a share of the torque limit."""

ROWS = ("distance", "velocity", "lag", "rate", "drive", "tau_c", "tau_m", "theta_d")
"""Blocks of a scaled observation, each of length dof; one value of time and the task's reference follow."""

__all__ = [
    "ACTION_SHARES",
    "FRICTION_SHARE",
    "LARGEST",
    "POSITION_GAIN",
    "ROWS",
    "VELOCITY_GAIN",
    "Ratios",
    "scaled",
    "torque_ratios",
    "torque_share",
]


class Ratios(NamedTuple):
    """Signals as ratios of torques, (..., dof) each; see `torque_ratios`."""

    distance: Array
    velocity: Array
    lag: Array
    rate: Array
    drive: Array


def torque_ratios(signals: Signals, unit: Array, position_gain: float, torque: Array) -> Ratios:
    """What an observer of gains L, L_p would make of the signals, over a torque s: odd functions of them, linear.

        distance  B L L_p (theta - theta_d) / s        velocity  B L theta' / s
        lag       B L L_p (theta_n - theta) / s        rate      B L (theta_n' - theta') / s
        drive     (tau_c - tau_j) / s

    Args:
        signals: of the joints.
        unit: B L / s [s/m | s/rad], broadcast against (..., dof).
        position_gain: L_p [1/s].
        torque: s [N | N m], likewise.
    """
    lever = unit * position_gain
    return Ratios(
        lever * (signals.theta - signals.theta_d),
        unit * signals.theta_dot,
        lever * (signals.theta_n - signals.theta),
        unit * (signals.theta_n_dot - signals.theta_dot),
        (signals.tau_c - signals.tau_j) / torque,
    )


def scaled(signals: Signals, motor_inertia: Array, torque_limit: Array) -> NDArray[np.float32]:
    """The observation of an agent, (..., 8 dof + 1 + k), k the length of the task's reference.

    Blocks as in ROWS, then time and reference. Of the `torque_ratios`, of tau_c / s and tau_m / s, and of time [s]
    the arsinh, which is linear for small values and keeps the digits of all; theta_d [m | rad] and the reference [m]
    as they are; everything clipped to +-LARGEST. What needs a signal that the sensors do not provide is zero.

    Args:
        signals: of the joints.
        motor_inertia, torque_limit: of JointInfo, broadcast against (..., dof).
    """
    torque = FRICTION_SHARE * torque_limit
    ratios = torque_ratios(signals, (VELOCITY_GAIN / torque) * motor_inertia, POSITION_GAIN, torque)
    hidden = set(SIGNALS) - signals.available
    nothing = np.zeros_like(ratios.distance)
    if "theta_n" in hidden:
        ratios = ratios._replace(lag=nothing, rate=nothing)
    if "tau_j" in hidden:
        ratios = ratios._replace(drive=nothing)
    bent = np.arcsinh(np.concatenate([*ratios, signals.tau_c / torque, signals.tau_m / torque], axis=-1))
    together = np.concatenate([bent, signals.theta_d, np.arcsinh(signals.time), signals.reference], axis=-1)
    return np.clip(together, -LARGEST, LARGEST).astype(np.float32)


def torque_share(action_mode: str, share: float | None = None) -> float:
    """What the action 1 means, as a share of the torque limit.

    Args:
        action_mode: "compensation" or "torque".
        share: above 0, at most 1; None means that of ACTION_SHARES.

    Raises:
        ValueError: the share is out of bounds.
    """
    chosen = ACTION_SHARES[action_mode] if share is None else number("action_share", share, POSITIVE)
    if chosen > 1.0:
        raise ValueError(f"action_share is {chosen:g}; torques above the torque limit are clipped: give at most 1")
    return chosen
