"""What a batch keeps from tick to tick beside the plant: signals, and what acts; arrays that are allocated once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.hardware import Readings
from fo_gym.plant.kernel import MOTION
from fo_gym.signals import SIGNALS, TIERS, Signals
from fo_gym.simulation.kernels import TAU_M, record
from fo_gym.simulation.past_step import PastStep

Array = NDArray[np.float64]

_ACTED = PastStep.names()
_TRUTH = (*MOTION, "z", *_ACTED)

__all__ = ["Memory"]


class Memory:
    """Signals laid out as the observation has them, and torques.

    Args:
        num_envs: size of the batch.
        dof: number of joints.
        references: length of the task's own reference.
        sensors: which signals are seen, see `fo_gym.signals.TIERS`.

    Attributes:
        available: names of the signals that are seen.
        signals: at the coming tick, whether they are seen or not; views, to be written into.
        readings: those of them that sensors give; views.
        acting: what acts in the present control period, rows as in PastStep, (5, num_envs, dof), N or N m.
        past: its means over the past step, likewise.
    """

    def __init__(self, num_envs: int, dof: int, references: int, sensors: str) -> None:
        self.available = TIERS[sensors]
        self._dof = dof
        self._hidden = [place for place, name in enumerate(SIGNALS) if name not in self.available]
        self._seen = np.zeros((num_envs, len(SIGNALS) * dof + 1 + references))
        self.acting, self.past = np.zeros((2, len(_ACTED), num_envs, dof))
        self._name_parts()

    def _name_parts(self) -> None:
        self.signals = Signals.from_observation(self._seen, self._dof)
        self.readings = Readings(self.signals.theta, self.signals.theta_dot, self.signals.tau_j)

    def __setstate__(self, state: dict[str, Any]) -> None:
        # Pickling turns views into copies: make them views of the one array again.
        self.__dict__.update(state)
        self._name_parts()

    @property
    def size(self) -> int:
        """Length of one environment's observation."""
        return self._seen.shape[1]

    def begin(self, ids: NDArray[np.intp], held: Array) -> None:
        """New episodes in the named environments, whose motors have been holding the springs, (n, dof)."""
        self.past[:, ids] = self.signals.time[ids] = 0.0
        self.past[TAU_M, ids] = self.signals.tau_m[ids] = held  # the first roughness counts from there

    def observation(self) -> Array:
        """What is seen, (num_envs, size): a copy."""
        seen = self._seen.copy()
        for place in self._hidden:
            seen[:, place * self._dof : (place + 1) * self._dof] = 0.0
        return seen

    def past_step(self) -> PastStep:
        """What acted in the past step: a copy."""
        return PastStep(*self.past.copy())

    def truth(self, motion: Array, rows: int | slice) -> dict[str, Array]:
        """Of the named environments: what moves, of the plant's `motion`, and what acted in the past step: copies."""
        whole = np.empty((len(motion) + len(self.past), *motion.shape[1:]))
        record(motion, self.past, whole)
        parts = whole[:, rows]
        if len(parts) == len(_TRUTH):
            return dict(zip(_TRUTH, parts, strict=False))  # which takes half the time of a strict one
        z = np.moveaxis(parts[len(MOTION) : -len(_ACTED)], 0, -1)
        moving, acted = parts[: len(MOTION)], parts[-len(_ACTED) :]
        return dict(zip(_TRUTH, (*moving, z, *acted), strict=True))

    def set_past(self, step: PastStep) -> None:
        """Continue as after `step`."""
        self.past[:] = [getattr(step, name) for name in PastStep.names()]
        self.signals.tau_m[:] = step.tau_m
