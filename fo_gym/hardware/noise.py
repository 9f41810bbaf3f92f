"""White noise of a batch of episodes, each from a random generator of its own, drawn ahead in blocks.

To ask every generator in every control period costs a batch more than its physics.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.generators import restored, states_of

Array = NDArray[np.float64]

_AHEAD = 64
"""Control periods in a block."""

_BLOCKS = 16
"""Blocks after which the generators' states are taken down anew: that takes longer than to draw a block."""

__all__ = ["Noise"]


class Noise:
    """Standard normal noise: the numbers that each generator gives when it is asked once per control period.

    Args:
        generators: one for each episode, which nobody else uses from then on; none where there is no noise.
        dof: numbers for each episode and period.
    """

    def __init__(self, generators: Iterable[np.random.Generator], dof: int) -> None:
        self._generators = list(generators)
        self._block, self._left = np.empty((_AHEAD, len(self._generators), dof)), 0
        # Periods since the states were taken down; the state of each generator then, or in the period of `_begins`.
        self._used = 0
        self._states = states_of(self._generators)
        self._begins = [0] * len(self._generators)

    def __len__(self) -> int:
        return len(self._generators)

    def standard_normal(self) -> Array:
        """New noise, (n, dof), not to be written into."""
        if self._left == 0:
            self._draw_block()
        noise = self._block[-self._left]
        noise.flags.writeable = False
        self._used += 1
        self._left -= 1
        return noise

    def _draw_block(self) -> None:
        if self._used == _BLOCKS * _AHEAD:
            self._states, self._begins, self._used = states_of(self._generators), [0] * len(self), 0
        self._block, self._left = np.empty_like(self._block), _AHEAD
        for i, generator in enumerate(self._generators):
            self._block[:, i] = generator.standard_normal((_AHEAD, self._block.shape[2]))

    @property
    def states(self) -> list[dict[str, Any]]:
        """The state of each generator if it had not been asked ahead."""
        now = restored(self._states)
        for generator, begins in zip(now, self._begins, strict=True):
            generator.standard_normal((self._used - begins, self._block.shape[2]))
        return states_of(now)

    def put(self, ids: Sequence[int] | NDArray[np.intp], other: Noise) -> None:
        """Let the noise of new episodes take the place of that in the named rows."""
        for i, state in zip(ids, other.states, strict=True):
            self._states[i], self._begins[i] = state, self._used
            (self._generators[i],) = restored([state])
            self._block[_AHEAD - self._left :, i] = self._generators[i].standard_normal(
                (self._left, self._block.shape[2])
            )
