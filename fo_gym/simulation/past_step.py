"""What acted on a batch of joints in the past step."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import real_array

Array = NDArray[np.float64]

__all__ = ["PastStep"]


@dataclass(frozen=True)
class PastStep:
    """Torques on the joints, means over the past step, (num_envs, dof) each, N or N m; before the first one as at rest.

    Attributes:
        tau_m, tau_ext: of the motors, and from outside, as applied.
        tau_f: friction.
        tau_dist: all that disturbs the motors: friction, gear ripple, torques of effects.
        tau_f_hat: what the controller subtracted: the action, clipped to +-torque_limit, or zeros where it is tau_m.
    """

    tau_m: Array
    tau_ext: Array
    tau_f: Array
    tau_dist: Array
    tau_f_hat: Array

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Of the attributes, in the order of TAU_M, TAU_EXT, ... in fo_gym.simulation.kernels."""
        return tuple(each.name for each in fields(cls))

    def check(self, shape: tuple[int, int]) -> None:
        """Raise ValueError where a field has another shape, or is not of finite numbers."""
        for name, array in vars(self).items():
            real_array(f"PastStep.{name}", array, shape)
