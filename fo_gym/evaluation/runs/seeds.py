"""Disjoint seeds: what is trained or tuned on is never what is scored."""

from __future__ import annotations

from collections.abc import Iterable

from fo_gym.checks import shown
from fo_gym.tasks.variants import NOMINAL

# Small numbers are what everybody types: they are for training.
TRAINING_SEEDS = range(1_000_000_000)
VALIDATION_SEEDS = range(1_000_000_000, 1_000_001_000)
TUNING_SEEDS = range(1_500_000_000, 1_500_001_000)
LEADERBOARD_SEEDS = range(2_000_000_000, 2_000_001_000)

__all__ = [
    "LEADERBOARD_SEEDS",
    "TRAINING_SEEDS",
    "TUNING_SEEDS",
    "VALIDATION_SEEDS",
    "first",
    "seeds_for",
    "usual_count",
]


def first(seeds: range, count: int) -> tuple[int, ...]:
    """The first `count` of a range of seeds.

    Raises:
        ValueError: `count` is below 1 or above the number of seeds.
    """
    if not 1 <= count <= len(seeds):
        raise ValueError(f"{shown(count)} seeds were asked for; give a number from 1 to {len(seeds)}")
    return tuple(seeds[:count])


def seeds_for(variant: str, seeds: range, count: int) -> tuple[int, ...]:
    """The seeds that a variant runs: the first `count`; of the nominal one, which draws nothing from them, 0, 1, ...

    The nominal episode itself is seed 0, the others are its cloud, see `fo_gym.evaluation.runs.cloud`.

    Raises:
        ValueError: `count` is below 1 or above the number of seeds.
    """
    chosen = first(seeds, count)
    return tuple(range(count)) if variant == NOMINAL else chosen


def usual_count(variants: Iterable[str]) -> int:
    """How many episodes of each variant are run where nobody says: 20, and 1 where there is the nominal one alone."""
    return 1 if set(variants) == {NOMINAL} else 20
