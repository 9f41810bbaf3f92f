"""The errors of what is believed about a robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import POSITIVE, check_ranges
from fo_gym.hardware.effect import Drawn, Effect
from fo_gym.parameters import FlexibleJoint

Range = tuple[float, float]

__all__ = ["ModelError"]


@dataclass(frozen=True)
class ModelError(Effect):
    """What controller, nominal motor and `JointInfo` believe, as factors on the truth, drawn per episode.

    Origin: ours; data sheets and identification are rarely better than some per cent, and a payload is rarely known.

    Attributes:
        motor_inertia, stiffness: ranges of the factors on B and K_j, per joint.
        mass: range of the factor on the masses, one for all links: below 1 is a payload that nobody told of.
    """

    motor_inertia: Range = (0.9, 1.1)
    stiffness: Range = (0.9, 1.1)
    mass: Range = (0.9, 1.0)

    def __post_init__(self) -> None:
        check_ranges(self, motor_inertia=POSITIVE, stiffness=POSITIVE, mass=POSITIVE)

    def draw(self, dof: int, generator: np.random.Generator) -> Mapping[str, NDArray[np.float64] | float]:
        """See Effect: the factors."""
        inertia, stiffness = generator.uniform(*self.motor_inertia, dof), generator.uniform(*self.stiffness, dof)
        return {"motor_inertia": inertia, "stiffness": stiffness, "mass": generator.uniform(*self.mass)}

    def believe(self, joints: FlexibleJoint, mass: float, drawn: Drawn) -> tuple[FlexibleJoint, float]:
        """See Effect."""
        inertia, stiffness = (getattr(joints, name) * drawn[name] for name in ("motor_inertia", "stiffness"))
        return replace(joints, motor_inertia=inertia, stiffness=stiffness), mass * float(drawn["mass"])
