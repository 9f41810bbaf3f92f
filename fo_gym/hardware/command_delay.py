"""The delay of the motors' commands."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, check_numbers
from fo_gym.hardware.effect import Effect, Episodes

Array = NDArray[np.float64]

MAX_DELAY = 1000
"""Control periods of a delay at most: a second at 1 kHz."""

__all__ = ["MAX_DELAY", "CommandDelay"]


@dataclass(frozen=True)
class CommandDelay(Effect):
    """Commands reach the motor late.

    Origin: ours; on a 1 kHz bus readings take a cycle to the controller, and commands one back.

    Attributes:
        seconds: a whole number of control periods, from 0 to MAX_DELAY.
    """

    seconds: float

    def __post_init__(self) -> None:
        check_numbers(self, seconds=NOT_NEGATIVE)

    def ticks(self, control_dt: float) -> int:
        """The delay in control periods. Raises ValueError where it is no whole number of them, or above MAX_DELAY."""
        ticks = round(self.seconds / control_dt)
        if ticks > MAX_DELAY or abs(ticks * control_dt - self.seconds) > 1e-9:
            raise ValueError(
                f"CommandDelay.seconds is {self.seconds}; it must be a whole number of control_dt = {control_dt} s, "
                f"at most {MAX_DELAY} of them"
            )
        return ticks

    def begin(self, episodes: Episodes) -> Mapping[str, Array]:
        """See Effect: the commands on their way, the next one first, (n, ticks, dof); at first those that hold."""
        held = episodes.truth.tau_j
        return {"queue": np.repeat(held[:, None], self.ticks(episodes.control_dt), axis=1)}

    def command(self, tau_m: Array, episodes: Episodes) -> Array:
        """See Effect."""
        queue = episodes.memory["queue"]
        if queue.shape[1] == 0:
            return tau_m
        late = queue[:, 0].copy()
        queue[:, :-1] = queue[:, 1:]
        queue[:, -1] = tau_m
        return late
