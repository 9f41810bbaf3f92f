"""From one number per seed to what is published: robust means, differences, their intervals, and ranks.

A *stratum* is one set of episodes (an environment in a variant). Its seeds are resampled on their own, so that every
resample has as many episodes of each stratum as there are, and every stratum counts the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import bootstrap, rankdata

from fo_gym.evaluation.episode.record import Array

__all__ = [
    "bootstrap_interval",
    "interquartile_mean",
    "paired_difference",
    "rank_intervals",
    "stratified_difference",
    "stratified_interval",
    "stratified_mean",
]


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


def stratified_mean(strata: Sequence[ArrayLike]) -> float:
    """Mean over the strata of their interquartile means.

    Not the interquartile mean of all values together: that would leave out just the environment in which somebody is
    far worse, or far better, than elsewhere.

    Args:
        strata: one array per stratum, one number per seed, (n_i,).

    Returns:
        The mean; NaN if a stratum has no value.
    """
    return float(np.mean([interquartile_mean(values) for values in strata]))


def bootstrap_interval(
    values: ArrayLike, rng: np.random.Generator, level: float = 0.95, resamples: int = 2000
) -> tuple[float, float]:
    """`stratified_interval` of a single stratum: bootstrap interval of the interquartile mean."""
    return stratified_interval([values], rng, level, resamples)


def stratified_interval(
    strata: Sequence[ArrayLike], rng: np.random.Generator, level: float = 0.95, resamples: int = 2000
) -> tuple[float, float]:
    """Bootstrap interval of `stratified_mean`; NaN values are left out.

    Percentile method: it covers as well as BCa here and exists for every sample. On normal, exponential and
    beta distributed values a 95 % interval holds the true value in 93 to 95 % of cases with 20 seeds, 90 % with 5.

    Args:
        strata: one array per stratum, one number per seed, (n_i,).
        rng: the only source of randomness; the same state gives the same interval.
        level: how often the interval should hold the true value, between 0 and 1.
        resamples: number of bootstrap samples.

    Returns:
        (low, high). Identical values, or a single one, are their own interval; (NaN, NaN) if a stratum has no value.

    Raises:
        TypeError: `rng` is not a numpy.random.Generator (a seed or None would not be reproducible as it looks).
        ValueError: `level` is not between 0 and 1, or `resamples` is below 1.
    """
    _check(rng, level, resamples)
    numbers = [_numbers(values) for values in strata]
    if not all(len(values) for values in numbers):
        return math.nan, math.nan
    if all(np.all(values == values[0]) for values in numbers):
        mean = stratified_mean(numbers)
        return mean, mean

    def statistic(*samples: Array, axis: int = -1) -> Array:
        mean: Array = np.mean([_interquartile_mean(sample, axis) for sample in samples], axis=0)
        return mean

    low, high = _percentiles(numbers, statistic, rng, level, resamples)
    return float(low), float(high)


def paired_difference(a: ArrayLike, b: ArrayLike, rng: np.random.Generator) -> tuple[float, float, float]:
    """`stratified_difference` of a single stratum: interquartile mean of a - b, with its 95 % bootstrap interval."""
    return stratified_difference([a], [b], rng)


def stratified_difference(
    a: Sequence[ArrayLike], b: Sequence[ArrayLike], rng: np.random.Generator
) -> tuple[float, float, float]:
    """`stratified_mean` of a - b over the same seeds, with its 95 % bootstrap interval.

    Differences are taken seed by seed, so that what an episode has easy or hard for everybody drops out. It is
    the interquartile mean of the differences, not the difference of two interquartile means. Seeds at
    which either is NaN are left out.

    Args:
        a: one array per stratum, one number per seed, (n_i,).
        b: the same strata and seeds in the same order.
        rng: the only source of randomness.

    Returns:
        (mean, low, high) of a - b; NaN if a stratum has no pair left.

    Raises:
        ValueError: two arrays are not of the same length, or `a` and `b` have not the same number of strata.
    """
    differences = []
    for one, other in zip(a, b, strict=True):
        left, right = np.asarray(one, dtype=np.float64), np.asarray(other, dtype=np.float64)
        if left.shape != right.shape:
            raise ValueError(f"a has shape {left.shape} and b {right.shape}; pairs need the same seeds in both")
        differences.append(left - right)
    return stratified_mean(differences), *stratified_interval(differences, rng)


def rank_intervals(
    strata: Sequence[Array], rng: np.random.Generator, level: float = 0.95, resamples: int = 2000
) -> NDArray[np.int64]:
    """Bootstrap interval of every competitor's rank by `stratified_mean`, highest first.

    All competitors are resampled with the same seeds, since they met the same episodes. Rounded outwards to whole
    ranks. Competitors that are equal in a resample share its better rank.

    Args:
        strata: one array per stratum, (seeds, competitors). Seeds at which any value is NaN are left out.
        rng, level, resamples: as for `stratified_interval`, with its errors.

    Returns:
        (competitors, 2): lowest and highest rank, 1 = best; all ranks where a stratum has no seed that everybody has.
    """
    _check(rng, level, resamples)
    whole = [values[~np.isnan(values).any(axis=1)] for values in strata]
    if not all(len(values) for values in whole):
        return np.tile(np.array([1, strata[0].shape[1]]), (strata[0].shape[1], 1))

    def ranks(*samples: Array, axis: int = -1) -> Array:
        drawn = zip(whole, samples, strict=True)
        means = [_interquartile_mean(values[seeds.astype(np.intp)], -2) for values, seeds in drawn]
        ranked: Array = rankdata(-np.mean(means, axis=0), method="min", axis=-1)
        return np.moveaxis(ranked, -1, 0).astype(np.float64)  # the resamples last, as `bootstrap` wants them

    seeds = [np.arange(len(values), dtype=np.float64) for values in whole]
    low, high = _percentiles(seeds, ranks, rng, level, resamples)
    return np.stack([np.floor(low), np.ceil(high)], axis=-1).astype(np.int64)


def _check(rng: np.random.Generator, level: float, resamples: int) -> None:
    """Raise TypeError or ValueError for arguments that no interval can be made with."""
    if not isinstance(rng, np.random.Generator):
        raise TypeError(f"rng is {rng!r}; hand over a numpy.random.Generator, such as numpy.random.default_rng(0)")
    if not 0.0 < level < 1.0:
        raise ValueError(f"level is {level}; it must be between 0 and 1, such as 0.95")
    if resamples < 1:
        raise ValueError(f"resamples is {resamples}; it must be at least 1")


def _percentiles(
    strata: Sequence[Array], statistic: Callable[..., Array], rng: np.random.Generator, level: float, resamples: int
) -> tuple[Any, Any]:
    """Ends of the percentile interval of a statistic of samples that are resampled each on its own."""
    # SciPy wants two values per sample: one value and the same again has the same resamples.
    samples = [np.repeat(values, 2) if len(values) == 1 else values for values in strata]
    result = bootstrap(
        samples, statistic, n_resamples=resamples, confidence_level=level, method="percentile", vectorized=True, rng=rng
    )
    return result.confidence_interval.low, result.confidence_interval.high


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
