"""What a joint measures and computes: the observation, and its named views."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import real, whole_number

Array = NDArray[np.float64]

SIGNALS = ("theta", "theta_dot", "tau_j", "theta_n", "theta_n_dot", "theta_d", "tau_c", "tau_m")
"""Order of the observation's blocks, each of length dof; one value of time and the task's reference follow."""

TIERS = {
    "joint": frozenset(SIGNALS),
    "motor": frozenset(SIGNALS) - {"tau_j", "theta_n", "theta_n_dot"},
    "full": frozenset(SIGNALS),
}
"""Sensor equipment, and the signals that it gives.

"joint": motor encoder and joint torque sensor. "motor": no torque sensor, hence no nominal motor, which it drives.
"full": a tachometer as well, so that the motor's velocity is measured and not a difference of positions.
"""

__all__ = ["SIGNALS", "TIERS", "Signals"]


@dataclass(frozen=True, eq=False)
class Signals:
    """Named views of an observation, sampled at the coming tick. Arrays are (..., dof).

    Attributes:
        theta, theta_dot: measured motor position [m | rad] and velocity [m/s | rad/s].
        tau_j: measured joint torque, K_j (theta - q) [N | N m].
        theta_n, theta_n_dot: nominal motor, B theta_n'' + tau_j = tau_c [m | rad, m/s | rad/s].
        theta_d: desired motor position [m | rad].
        tau_c: control torque that the coming step applies [N | N m].
        tau_m: motor torque as applied, late and clipped as the motors take it, its mean over the past step [N | N m].
            At the first tick, what has been holding the joints in equilibrium.
        time: since the start of the episode, (..., 1) [s]; 0 at the first tick.
        reference: the task's own reference, (..., k): the desired tool position [m] on the square, else k = 0.
        available: names of the signals that the sensors provide; the others are zero.
        truth: how things really are, arrays (..., dof) by name, as `info` has them; for privileged compensators (see
            `fo_gym.Compensator`), and None for everybody else.
    """

    theta: Array
    theta_dot: Array
    tau_j: Array
    theta_n: Array
    theta_n_dot: Array
    theta_d: Array
    tau_c: Array
    tau_m: Array
    time: Array
    reference: Array
    available: frozenset[str] = field(default=frozenset(SIGNALS))
    truth: Mapping[str, Array] | None = None

    @classmethod
    def from_observation(cls, obs: Array, dof: int, available: frozenset[str] = frozenset(SIGNALS)) -> Signals:
        """Views into an observation (..., 8 dof + 1 + k), without copies; leading axes are kept.

        Args:
            obs: what the environment gave.
            dof: number of joints.
            available: names of the signals that the sensors provide, `env.unwrapped.available`.

        Raises:
            ValueError: the observation is too short for `dof` joints, or does not hold real numbers.
        """
        dof = whole_number("dof", dof, 1)
        obs = real("observation", obs)
        end, size = len(SIGNALS) * dof, obs.shape[-1] if obs.ndim else 0
        if size <= end:
            raise ValueError(
                f"observation has shape {obs.shape}, {size} values each; dof = {dof} needs at least {end + 1}"
            )
        blocks: dict[str, Any] = {name: obs[..., i * dof : (i + 1) * dof] for i, name in enumerate(SIGNALS)}
        blocks |= {"time": obs[..., end : end + 1], "reference": obs[..., end + 1 :]}
        return cls.of({**blocks, "available": available, "truth": None})

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Signals:
        """Of all attributes by name; a frozen class' constructor, which sets them singly, takes five times as long."""
        signals = object.__new__(cls)
        signals.__dict__.update(values)
        return signals

    def observation(self) -> Array:
        """A new array with what `from_observation` takes apart, (..., 8 dof + 1 + k)."""
        return np.concatenate([*(getattr(self, name) for name in SIGNALS), self.time, self.reference], axis=-1)
