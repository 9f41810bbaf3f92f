"""The joint torque sensor: noise, an offset, a bandwidth."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE_OR_INFINITE, check_values
from fo_gym.hardware.effect import Effect, Episodes, Readings
from fo_gym.hardware.low_pass import weight
from fo_gym.parameters import Value, check_joints

Array = NDArray[np.float64]

__all__ = ["TorqueSensor"]


@dataclass(frozen=True, eq=False)
class TorqueSensor(Effect):
    """Noise, an offset per episode, and a bandwidth.

    Origin: strain gauges of torque-controlled arms are accurate to about 2 % of their range (published for a 7-joint
    arm; uncertain); how that splits into offset and noise is ours, as is the bandwidth.

    Attributes:
        noise: standard deviation, white at the control rate [N | N m], at least 0.
        offset: largest offset, drawn per episode in +-offset [N | N m], at least 0.
        cutoff: of its first-order low-pass [rad/s], above 0; infinity for none.
    """

    noise: Value
    offset: Value
    cutoff: Value = math.inf
    noisy: ClassVar[bool] = True

    def __post_init__(self) -> None:
        check_values(self, noise=NOT_NEGATIVE, offset=NOT_NEGATIVE, cutoff=POSITIVE_OR_INFINITE)

    def check_joints(self, dof: int) -> None:
        """See Effect."""
        check_joints(self, dof)

    def draw(self, dof: int, generator: np.random.Generator) -> Mapping[str, Array]:
        """See Effect: the offset [N | N m]."""
        return {"offset": generator.uniform(-1.0, 1.0, dof) * self.offset}

    def begin(self, episodes: Episodes) -> Mapping[str, Array]:
        """See Effect."""
        return {"filtered": episodes.truth.tau_j}

    def measure(self, readings: Readings, episodes: Episodes) -> Readings:
        """See Effect."""
        before = episodes.memory["filtered"]
        filtered = before + weight(self.cutoff, episodes.control_dt) * (readings.tau_j - before)
        episodes.memory["filtered"] = filtered
        tau_j = filtered + episodes.drawn["offset"]
        silent = self.noise == 0.0 if isinstance(self.noise, float) else not self.noise.any()
        return readings._replace(tau_j=tau_j if silent else tau_j + self.noise * episodes.standard_normal())
