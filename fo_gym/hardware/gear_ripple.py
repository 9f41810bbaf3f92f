"""The torque ripple of the gears."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, Value, check_values
from fo_gym.hardware.effect import Effect, Episodes
from fo_gym.parameters import check_joints

Array = NDArray[np.float64]

__all__ = ["GearRipple"]


@dataclass(frozen=True, eq=False)
class GearRipple(Effect):
    """A torque on the motor that goes round with it, amplitude sin(2 pi theta / period + phase), phase per episode.

    Origin: strain-wave gears ripple twice per turn of the wave generator, here 200 times per turn of the link: their
    losses vary periodically with rotation (Tuttle 1992), and motor and joint deflect periodically against each other in
    an arm with torque sensors (Chawda and Niemeyer, ICRA 2017). The amplitude is ours.

    Attributes:
        amplitude: [N | N m], at least 0.
        period: [m | rad], above 0.
    """

    amplitude: Value
    period: Value

    def __post_init__(self) -> None:
        check_values(self, amplitude=NOT_NEGATIVE, period=POSITIVE)

    def check_joints(self, dof: int) -> None:
        """See Effect."""
        check_joints(self, dof)

    def draw(self, dof: int, generator: np.random.Generator) -> Mapping[str, Array]:
        """See Effect: the phase [rad]."""
        return {"phase": generator.uniform(0.0, 2.0 * np.pi, dof)}

    def motor_torque(self, episodes: Episodes) -> Array:
        """See Effect."""
        turned = (2.0 * np.pi / np.asarray(self.period)) * episodes.truth.theta
        return np.asarray(self.amplitude * np.sin(turned + episodes.drawn["phase"]))
