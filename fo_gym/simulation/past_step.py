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
    def at_rest(cls, num_envs: int, dof: int) -> PastStep:
        """Nothing acted."""
        return cls(*np.zeros((len(fields(cls)), num_envs, dof)))

    def begin(self, ids: NDArray[np.intp], held: Array) -> None:
        """New episodes in the named environments, whose motors have been holding the springs, (n, dof)."""
        for array in vars(self).values():
            array[ids] = 0.0
        self.tau_m[ids] = held  # the first roughness counts from there

    def copy(self) -> PastStep:
        """A copy, of float64."""
        return PastStep(**{name: np.array(array, dtype=np.float64) for name, array in vars(self).items()})

    def check(self, shape: tuple[int, int]) -> None:
        """Raise ValueError where a field has another shape, or is not of finite numbers."""
        for name, array in vars(self).items():
            real_array(f"PastStep.{name}", array, shape)
