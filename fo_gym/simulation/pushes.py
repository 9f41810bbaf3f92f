"""The external pushes of a batch: a sin^2 pulse per environment, or none."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.tasks.scenario import Push

Array = NDArray[np.float64]

__all__ = ["Pushes"]


class Pushes:
    """One pulse per environment; a pulse of length zero stands for none.

    Attributes:
        time, duration: start and length, (num_envs,), s.
        torque: peak, (num_envs, dof), N or N m.
    """

    def __init__(self, num_envs: int, dof: int) -> None:
        self.time = np.zeros(num_envs)
        self.duration = np.zeros(num_envs)
        self.torque = np.zeros((num_envs, dof))

    def set(self, i: int, push: Push | None) -> None:
        """Give environment i its push."""
        self.time[i] = push.time if push else 0.0
        self.duration[i] = push.duration if push else 0.0
        self.torque[i] = push.torque if push else 0.0
