"""Friction of loaded gears."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, check_numbers
from fo_gym.hardware.effect import Effect, Episodes, FrictionChange

Array = NDArray[np.float64]

__all__ = ["LoadFriction"]


@dataclass(frozen=True)
class LoadFriction(Effect):
    """Dry friction grows with what the gear carries, on either side; it acts on any friction law's levels.

        Coulomb friction and stiction  + |motor tau_m + gain tau_j|
        stiction alone                 + |stiction_motor tau_m + stiction_load tau_j| + Q
        Q = quadratic_load tau_j^2 where |tau_m| > |tau_j|, else quadratic_motor tau_m^2; 0 where tau_m tau_j < 0:
            the motor does not drive against its load then

    With `gain` alone both grow by gain |tau_j|. A law without stiction has no use for what is stiction's.

    Origin: model M6 of Rhoban BAM (arXiv:2410.08650), whose external torque is -tau_j; gains of 0.063 and 0.166
    identified on two servo joints.

    Attributes:
        gain: of the joint's torque on both [1], at least 0.
        motor: of the motor's torque on both [1], at least 0.
        stiction_load, stiction_motor: likewise, on stiction alone [1], at least 0.
        quadratic_load, quadratic_motor: likewise, of the square [1/N | 1/(N m)], at least 0.
    """

    gain: float = 0.0
    motor: float = 0.0
    stiction_load: float = 0.0
    stiction_motor: float = 0.0
    quadratic_load: float = 0.0
    quadratic_motor: float = 0.0

    def __post_init__(self) -> None:
        check_numbers(self, **dict.fromkeys(vars(self), NOT_NEGATIVE))

    def begin(self, episodes: Episodes) -> Mapping[str, Array]:
        """See Effect: the motors' torque, which holds the springs [N | N m]."""
        return {"tau_m": episodes.truth.tau_j}

    def command(self, tau_m: Array, episodes: Episodes) -> Array:
        """See Effect: as it is, but noted."""
        episodes.memory["tau_m"] = tau_m
        return tau_m

    def friction(self, episodes: Episodes) -> FrictionChange:
        """See Effect."""
        tau_j, tau_m = episodes.truth.tau_j, episodes.memory["tau_m"]
        both = np.abs(self.motor * tau_m + self.gain * tau_j)
        stiction: Array | float = 0.0
        if self.stiction_motor or self.stiction_load:
            stiction = np.abs(self.stiction_motor * tau_m + self.stiction_load * tau_j)
        if self.quadratic_motor or self.quadratic_load:
            holds = np.abs(tau_m) > np.abs(tau_j)
            squared = np.where(holds, self.quadratic_load * tau_j**2, self.quadratic_motor * tau_m**2)
            stiction = stiction + np.where(tau_m * tau_j > 0.0, squared, 0.0)
        return FrictionChange(added=both, stiction=stiction)
