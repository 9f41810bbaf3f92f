"""The motor encoder: positions in steps, velocities from their differences."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE_OR_INFINITE, Value, check_values
from fo_gym.hardware.effect import Effect, Episodes, Readings
from fo_gym.hardware.low_pass import weight
from fo_gym.parameters import check_joints

Array = NDArray[np.float64]

__all__ = ["MotorEncoder"]


@dataclass(frozen=True, eq=False)
class MotorEncoder(Effect):
    """Positions in steps; the velocity is their difference over a control period, low-passed.

    Origin: a 16-bit encoder on the motor behind a gear of 100:1 resolves 1e-6 rad of the link side; the
    cut-off is ours.

    Attributes:
        resolution: one step, on the link side [m | rad], at least 0.
        cutoff: of the first-order low-pass of the velocity [rad/s], above 0; infinity for none.
    """

    resolution: Value
    cutoff: Value = math.inf

    def __post_init__(self) -> None:
        check_values(self, resolution=NOT_NEGATIVE, cutoff=POSITIVE_OR_INFINITE)

    def check_joints(self, dof: int) -> None:
        """See Effect."""
        check_joints(self, dof)

    def begin(self, episodes: Episodes) -> Mapping[str, Array]:
        """See Effect."""
        theta = self._steps(episodes.truth.theta)
        return {"theta": theta, "theta_dot": np.zeros_like(theta)}

    def measure(self, readings: Readings, episodes: Episodes) -> Readings:
        """See Effect. A tachometer leaves the velocity as it is."""
        memory = episodes.memory
        before, theta = memory["theta"], self._steps(readings.theta)
        memory["theta"] = theta
        if episodes.tachometer:
            return readings._replace(theta=theta)
        difference = (theta - before) / episodes.control_dt
        share = weight(self.cutoff, episodes.control_dt)
        memory["theta_dot"] = memory["theta_dot"] + share * (difference - memory["theta_dot"])
        return readings._replace(theta=theta, theta_dot=memory["theta_dot"])

    def _steps(self, theta: Array) -> Array:
        step = self.resolution
        if isinstance(step, float):
            return np.rint(theta / step) * step if step > 0 else theta
        return np.where(step > 0, np.rint(theta / np.where(step > 0, step, 1.0)) * step, theta)
