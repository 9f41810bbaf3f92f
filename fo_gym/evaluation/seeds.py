"""Disjoint seeds: what is trained or tuned on is never what is scored."""

from __future__ import annotations

LEADERBOARD_SEEDS = range(1_000)
VALIDATION_SEEDS = range(1_000_000, 1_001_000)
TRAINING_SEEDS = range(2_000_000, 2**31)

__all__ = ["LEADERBOARD_SEEDS", "TRAINING_SEEDS", "VALIDATION_SEEDS", "first"]


def first(seeds: range, count: int) -> tuple[int, ...]:
    """The first `count` of a range of seeds.

    Raises:
        ValueError: `count` is below 1 or above the number of seeds.
    """
    if not 1 <= count <= len(seeds):
        raise ValueError(f"{count} seeds were asked for; give a number from 1 to {len(seeds)}")
    return tuple(seeds[:count])
