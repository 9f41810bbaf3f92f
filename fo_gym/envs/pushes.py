"""The external pushes of a batch: a pulse per environment."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.tasks.scenario import Push

Array = NDArray[np.float64]

__all__ = ["Pushes"]


class Pushes:
    """One sin^2 pulse per environment, or none."""

    def __init__(self, num_envs: int, dof: int) -> None:
        # A pulse of length zero stands for none.
        self._time = np.zeros((num_envs, 1))
        self._duration = np.zeros((num_envs, 1))
        self._torque = np.zeros((num_envs, dof))

    def set(self, i: int, push: Push | None) -> None:
        """Give environment i its push."""
        self._time[i] = push.time if push else 0.0
        self._duration[i] = push.duration if push else 0.0
        self._torque[i] = push.torque if push else 0.0

    def at(self, time: Array) -> Array:
        """External torque at `time` (num_envs,) [s]: (num_envs, dof), N or N m."""
        since = time[:, None] - self._time
        active = (since > 0.0) & (since < self._duration)
        if not active.any():
            return np.zeros_like(self._torque)
        share = np.divide(since, self._duration, out=np.zeros_like(since), where=active)
        # Plain zeros, not signed ones, where nobody pushes: what the neighbours do must not show.
        return np.where(active, self._torque * np.sin(np.pi * share) ** 2, 0.0)
