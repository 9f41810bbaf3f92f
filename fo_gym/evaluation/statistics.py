"""From one number per seed to what is published: a robust mean, its interval, and who beats whom."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import bootstrap

from fo_gym.evaluation.record import Array

__all__ = ["bootstrap_interval", "interquartile_mean", "paired_difference", "tied"]


def interquartile_mean(values: ArrayLike) -> float:
    """Mean of the middle half of the values; NaN values are left out.

    Exactly the middle half: of n sorted values the i-th stands for the share [i/n, (i+1)/n], and its weight is the
    part of that share between 1/4 and 3/4. Where 4 divides n this is the mean without the lowest and the highest
    quarter (a 25 % trimmed mean); elsewhere nothing is cut by rounding, so that the mean does not jump when one
    value more is excluded.

    Args:
        values: one number per seed, (n,).

    Returns:
        The interquartile mean; NaN if no value is left.
    """
    numbers = _numbers(values)
    return float(_interquartile_mean(numbers)) if len(numbers) else math.nan


def bootstrap_interval(
    values: ArrayLike, rng: np.random.Generator, level: float = 0.95, resamples: int = 2000
) -> tuple[float, float]:
    """Bootstrap interval of the interquartile mean; NaN values are left out.

    Percentile method: it covers as well as BCa here and exists for every sample. On normal, exponential and
    beta distributed values a 95 % interval holds the true value in 93 to 95 % of cases with 20 seeds, 90 % with 5.

    Args:
        values: one number per seed, (n,).
        rng: the only source of randomness; the same state gives the same interval.
        level: how often the interval should hold the true value, between 0 and 1.
        resamples: number of bootstrap samples.

    Returns:
        (low, high). Identical values, or a single one, are their own interval; (NaN, NaN) if no value is left.

    Raises:
        TypeError: `rng` is not a numpy.random.Generator (a seed or None would not be reproducible as it looks).
        ValueError: `level` is not between 0 and 1, or `resamples` is below 1.
    """
    if not isinstance(rng, np.random.Generator):
        raise TypeError(f"rng is {rng!r}; hand over a numpy.random.Generator, such as numpy.random.default_rng(0)")
    if not 0.0 < level < 1.0:
        raise ValueError(f"level is {level}; it must be between 0 and 1, such as 0.95")
    if resamples < 1:
        raise ValueError(f"resamples is {resamples}; it must be at least 1")
    numbers = _numbers(values)
    if not len(numbers):
        return math.nan, math.nan
    if np.all(numbers == numbers[0]):
        return float(numbers[0]), float(numbers[0])
    result = bootstrap(
        (numbers,),
        _interquartile_mean,
        n_resamples=resamples,
        vectorized=True,
        axis=-1,
        confidence_level=level,
        method="percentile",
        rng=rng,
    )
    return float(result.confidence_interval.low), float(result.confidence_interval.high)


def paired_difference(a: ArrayLike, b: ArrayLike, rng: np.random.Generator) -> tuple[float, float, float]:
    """Interquartile mean of a - b over the same seeds, with its 95 % bootstrap interval.

    Differences are taken seed by seed, so that what an episode has easy or hard for everybody drops out. It is
    the interquartile mean of the differences, not the difference of two interquartile means. Seeds at
    which either is NaN are left out.

    Args:
        a: one number per seed, (n,).
        b: the same seeds in the same order, (n,).
        rng: the only source of randomness.

    Returns:
        (interquartile mean, low, high) of a - b; NaN if no pair is left.

    Raises:
        ValueError: `a` and `b` are not of the same length.
    """
    left, right = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    if left.shape != right.shape:
        raise ValueError(f"a has shape {left.shape} and b {right.shape}; pairs need the same seeds in both")
    difference = left - right
    return interquartile_mean(difference), *bootstrap_interval(difference, rng)


def tied(low: float, high: float) -> bool:
    """Whether the interval of a difference holds zero, ends included; False for NaN."""
    return low <= 0.0 <= high


def _numbers(values: ArrayLike) -> Array:
    """The values that are not NaN, (n,)."""
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 1:
        raise ValueError(f"values have shape {array.shape}; give one number per seed, (n,)")
    return array[~np.isnan(array)]


def _interquartile_mean(values: Array, axis: int = -1) -> Array:
    """Interquartile mean along one axis, which goes."""
    ordered = np.sort(values, axis=axis)
    count = values.shape[axis]
    weights = np.diff(np.clip(4 * np.arange(count + 1), count, 3 * count))  # shares of 1/(4 n), whole numbers
    lowest = np.min(values, axis=axis, keepdims=True)
    mean: Array = np.squeeze(lowest, axis) + np.average(ordered - lowest, axis=axis, weights=weights)
    return np.minimum(mean, np.max(values, axis=axis))  # rounding must not carry it past the largest value
