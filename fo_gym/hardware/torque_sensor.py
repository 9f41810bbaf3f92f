"""The joint torque sensor: noise, a zero that is off, a bandwidth."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE_OR_INFINITE, Value, check_numbers, check_values
from fo_gym.hardware.effect import Effect, Episodes, Readings
from fo_gym.hardware.low_pass import weight
from fo_gym.parameters import check_joints

Array = NDArray[np.float64]

__all__ = ["TorqueSensor"]


@dataclass(frozen=True, eq=False)
class TorqueSensor(Effect):
    """Noise, a zero that is off, and a bandwidth.

    The zero is off by an offset. Where it is nulled, as laboratories do before they start, the average reading over
    some time at rest, less the load that the joints are known to carry there, is taken for the offset. What is left is
    the noise of that average and the error of the known load, and then the drift since.

    Origin: strain gauges of torque-controlled arms are accurate to about 2 % of their range (published for a 7-joint
    arm; uncertain), which is taken for the offset. The zero of good strain-gauge transducers drifts by 0.05 % of the
    range per 10 K (HBM), which the 20 K by which a joint warms up make 0.1 %. Noise and bandwidth are ours.

    Attributes:
        noise: standard deviation, white at the control rate [N | N m], at least 0.
        offset: largest offset, drawn per episode in +-offset [N | N m], at least 0.
        cutoff: of its first-order low-pass [rad/s], above 0; infinity for none.
        nulled: time at rest over which the average is taken before the start [s], at least 0; 0 leaves the offset.
        load_error: largest error of the known load, as a share of the load, drawn per episode and joint, at least 0.
        drift: largest drift since it was nulled, drawn per episode in +-drift [N | N m], at least 0.
    """

    noise: Value
    offset: Value
    cutoff: Value = math.inf
    nulled: float = 0.0
    load_error: float = 0.0
    drift: Value = 0.0
    noisy: ClassVar[bool] = True

    def __post_init__(self) -> None:
        check_numbers(self, nulled=NOT_NEGATIVE, load_error=NOT_NEGATIVE)
        levels = dict.fromkeys(("noise", "offset", "drift"), NOT_NEGATIVE)
        check_values(self, **levels, cutoff=POSITIVE_OR_INFINITE)

    @property
    def raw(self) -> TorqueSensor:
        """The same where nobody nulls it."""
        return replace(self, nulled=0.0)

    def check_joints(self, dof: int) -> None:
        """See Effect."""
        check_joints(self, dof)

    def draw(self, dof: int, generator: np.random.Generator) -> Mapping[str, Array]:
        """See Effect: offset and drift [N | N m], share of the load by which it is off, and the average's noise [1]."""
        offset = generator.uniform(-1.0, 1.0, dof) * self.offset
        drift = generator.uniform(-1.0, 1.0, dof) * self.drift
        load = generator.uniform(-1.0, 1.0, dof) * self.load_error
        return {"offset": offset, "drift": drift, "load": load, "average": generator.standard_normal(dof)}

    def begin(self, episodes: Episodes) -> Mapping[str, Array]:
        """See Effect."""
        drawn, load = episodes.drawn, episodes.truth.tau_j
        zero = drawn["offset"]
        if self.nulled > 0.0:
            readings = max(1, round(self.nulled / episodes.control_dt))
            zero = drawn["load"] * load - drawn["average"] * self.noise / math.sqrt(readings)
        return {"filtered": load, "zero": zero + drawn["drift"]}

    def measure(self, readings: Readings, episodes: Episodes) -> Readings:
        """See Effect."""
        before = episodes.memory["filtered"]
        filtered = before + weight(self.cutoff, episodes.control_dt) * (readings.tau_j - before)
        episodes.memory["filtered"] = filtered
        tau_j = filtered + episodes.memory["zero"]
        silent = self.noise == 0.0 if isinstance(self.noise, float) else not self.noise.any()
        return readings._replace(tau_j=tau_j if silent else tau_j + self.noise * episodes.standard_normal())
