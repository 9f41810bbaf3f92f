"""Twins: the same episodes from a start that is moved by next to nothing, which show what a last bit can do.

Where an episode is chaotic (an unstable observer on quantised, noisy signals), two processors give two motions, and so
do two twins on one processor. A published value that is out of tolerance is then held against the spread of some twins.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fo_gym.envs.vector import JointVectorEnv
from fo_gym.evaluation.runs.cloud import moved, sides
from fo_gym.evaluation.runs.episodes import EpisodeSet

SHIFT = 1e-12
"""How far the start of a twin is from that of its episode [m | rad]: some last bits of a position."""

TWINS = 10
"""How many twins say how far an episode may come out."""

WIDENED = 1.0
"""The spread of the twins counts with this share of itself added on either side: they are few."""

__all__ = ["SHIFT", "TWINS", "WIDENED", "TwinSet", "spread"]


@dataclass(frozen=True)
class TwinSet(EpisodeSet):
    """Episodes whose starts are moved; what is drawn from the seed is that of the episodes themselves.

    Attributes:
        number: which twin; 1, 2, ... have different starts.
        shift: how far each joint is moved [m | rad].
    """

    number: int = 1
    shift: float = SHIFT

    def start(self, env: JointVectorEnv) -> None:
        """See EpisodeSet."""
        super().start(env)
        simulation = env.simulation
        to = sides([np.random.default_rng([self.number, seed]) for seed in self.seeds], simulation.dof)
        simulation.set_state(moved(simulation.get_state(), to, self.shift))


@dataclass(frozen=True)
class Spread:
    """Where the values of an episode and of its twins lie.

    Attributes:
        low, high: the smallest and the largest, NaN where none is a number.
        absent: whether one of them is NaN: the metric does not apply.
    """

    low: float
    high: float
    absent: bool

    def holds(self, value: float, margin: float) -> bool:
        """Whether a value may be that of another twin: within the widened spread and a margin beyond that."""
        if math.isnan(value):
            return self.absent
        room = WIDENED * (self.high - self.low) + margin
        return self.low - room <= value <= self.high + room


def spread(values: Sequence[float]) -> Spread:
    """The spread of some values, those that are NaN apart."""
    numbers = [value for value in values if not math.isnan(value)]
    low, high = (min(numbers), max(numbers)) if numbers else (math.nan, math.nan)
    return Spread(low, high, len(numbers) < len(values))
