"""Means, intervals, differences and ranks: known answers, coverage, and where chance comes from."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import trim_mean

from fo_gym.evaluation.results.statistics import (
    bootstrap_interval,
    interquartile_mean,
    paired_difference,
    rank_intervals,
    stratified_difference,
    stratified_interval,
    stratified_mean,
)

SAMPLES = st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=30)


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([3.0], 3.0),
        ([1.0, 2.0], 1.5),
        ([0.0, 3.0, 9.0], 3.0 * 4 / 6 + 9.0 / 6),
        ([100.0, 1.0, 3.0, -50.0], 2.0),
        ([1.0, 2.0, 3.0, 4.0, 1e6], (0.75 * 2.0 + 3.0 + 0.75 * 4.0) / 2.5),
        ([math.nan, 1.0, math.nan, 2.0], 1.5),
    ],
)
def test_interquartile_mean(values: list[float], expected: float) -> None:
    assert interquartile_mean(values) == pytest.approx(expected, rel=1e-12)


def test_interquartile_mean_is_a_trimmed_mean_where_quarters_are_whole() -> None:
    values = rng().normal(size=20)
    assert interquartile_mean(values) == pytest.approx(trim_mean(values, 0.25), rel=1e-12)


@given(SAMPLES, st.randoms(use_true_random=False))
def test_interquartile_mean_ignores_order_and_stays_inside(values: list[float], random: Any) -> None:
    mean = interquartile_mean(values)
    shuffled = random.sample(values, len(values))
    assert interquartile_mean(shuffled) == mean
    assert min(values) <= mean <= max(values) + 1e-9


@given(SAMPLES)
def test_identical_values_are_their_own_mean_and_interval(values: list[float]) -> None:
    same = [values[0]] * len(values)
    assert interquartile_mean(same) == values[0]
    assert bootstrap_interval(same, rng()) == (values[0], values[0])


@pytest.mark.parametrize("values", [[], [math.nan], [math.nan, math.nan]])
def test_nothing_left_gives_nan(values: list[float]) -> None:
    assert math.isnan(interquartile_mean(values))
    assert np.isnan(bootstrap_interval(values, rng())).all()
    assert np.isnan(paired_difference(values, values, rng())).all()


def test_nan_is_left_out_of_the_interval() -> None:
    values = rng().normal(size=12)
    with_nan = np.insert(values, [0, 5, 12], math.nan)
    assert bootstrap_interval(with_nan, rng(1)) == bootstrap_interval(values, rng(1))


def test_interval_holds_the_mean_and_widens_with_the_level() -> None:
    values = rng().exponential(size=20)
    narrow, wide = bootstrap_interval(values, rng(1), level=0.5), bootstrap_interval(values, rng(1), level=0.99)
    assert wide[0] < narrow[0] < interquartile_mean(values) < narrow[1] < wide[1]


def test_more_resamples_agree_better() -> None:
    values = rng().normal(size=20)

    def spread(resamples: int) -> float:
        return float(np.std([bootstrap_interval(values, rng(seed), resamples=resamples)[0] for seed in range(20)]))

    assert spread(2000) < 0.5 * spread(50)


def binomial_tolerance(level: float, repeats: int) -> float:
    """Three standard errors of a share, and 0.01 that the percentile method misses with 20 seeds."""
    return 3 * math.sqrt(level * (1 - level) / repeats) + 0.01


DRAWS: dict[str, tuple[Callable[[np.random.Generator], np.ndarray], float]] = {
    "normal": (lambda source: source.normal(size=20), 0.0),
    "exponential": (
        lambda source: source.exponential(size=20),
        1 - 0.5 * math.log(27 / 16),
    ),  # 2 * integral of the quantile -log(1 - p)
}


@pytest.mark.parametrize("level", [0.5, 0.8, 0.95])
@pytest.mark.parametrize("name", DRAWS)
def test_intervals_cover_at_about_their_stated_rate(name: str, level: float) -> None:
    draw, truth = DRAWS[name]
    source = rng(1)
    repeats = 1000
    intervals = [bootstrap_interval(draw(source), source, level, resamples=300) for _ in range(repeats)]
    covered = np.mean([low <= truth <= high for low, high in intervals])
    assert abs(covered - level) < binomial_tolerance(level, repeats)


def test_the_seed_and_only_the_generator_decides() -> None:
    values = rng().normal(size=20)
    np.random.seed(1)  # noqa: NPY002
    first = bootstrap_interval(values, rng(5))
    np.random.seed(2)  # noqa: NPY002
    assert bootstrap_interval(values, rng(5)) == first
    assert bootstrap_interval(values, rng(6)) != first


def test_the_generator_moves_on() -> None:
    values, source = rng().normal(size=20), rng(5)
    assert bootstrap_interval(values, source) != bootstrap_interval(values, source)


def test_global_random_state_is_left_alone() -> None:
    before = np.random.get_state()[1].copy()  # noqa: NPY002
    values = rng().normal(size=20)
    bootstrap_interval(values, rng())
    paired_difference(values, values[::-1], rng())
    np.testing.assert_array_equal(np.random.get_state()[1], before)  # noqa: NPY002


@pytest.mark.parametrize("wrong", [None, 0, np.random.RandomState(0)])
def test_only_a_generator_will_do(wrong: Any) -> None:
    with pytest.raises(TypeError, match=r"numpy\.random\.Generator"):
        bootstrap_interval([1.0, 2.0], wrong)


@pytest.mark.parametrize("level", [0.0, 1.0, 95, math.nan])
def test_level_is_checked(level: float) -> None:
    with pytest.raises(ValueError, match="between 0 and 1"):
        bootstrap_interval([1.0, 2.0], rng(), level)


def test_resamples_are_checked() -> None:
    with pytest.raises(ValueError, match="at least 1"):
        bootstrap_interval([1.0, 2.0], rng(), resamples=0)


def test_values_are_one_per_seed() -> None:
    with pytest.raises(ValueError, match="one number per seed"):
        interquartile_mean(np.zeros((3, 2)))


def test_paired_difference_sees_what_the_spread_of_the_episodes_hides() -> None:
    hard = rng().normal(scale=10.0, size=20)
    a = hard + 1.0 + rng(1).normal(scale=0.1, size=20)
    mean, low, high = paired_difference(a, hard, rng(2))
    assert low < mean < high
    assert mean == pytest.approx(1.0, abs=0.1)
    assert low > 0.0
    unpaired = bootstrap_interval(a, rng(2))
    assert unpaired[0] < interquartile_mean(hard) < unpaired[1]


def test_paired_difference_is_antisymmetric_in_its_mean() -> None:
    a, b = rng().normal(size=(2, 15))
    assert paired_difference(a, b, rng())[0] == pytest.approx(-paired_difference(b, a, rng())[0])


def test_paired_difference_leaves_out_incomplete_pairs() -> None:
    mean, low, high = paired_difference([1.0, math.nan, 5.0], [0.5, 3.0, math.nan], rng())
    assert (mean, low, high) == (0.5, 0.5, 0.5)


def test_pairs_need_the_same_seeds() -> None:
    with pytest.raises(ValueError, match="same seeds"):
        paired_difference([1.0, 2.0], [1.0], rng())


def test_strata_count_the_same_whatever_their_size() -> None:
    strata = [[1.0, 1.0, 1.0, 1.0], [4.0], [math.nan, 7.0]]
    assert stratified_mean(strata) == pytest.approx(4.0)
    assert stratified_interval(strata, rng()) == (stratified_mean(strata),) * 2
    assert math.isnan(stratified_mean([[1.0], [math.nan]]))
    assert np.isnan(stratified_interval([[1.0], []], rng())).all()


def test_seeds_stay_in_their_stratum() -> None:
    """Strata far apart do not widen the interval; one of a single seed does not move."""
    values = rng().normal(size=20)
    alone = bootstrap_interval(values, rng(1))
    low, high = stratified_interval([values, [1000.0]], rng(1))
    assert (2 * low - 1000.0, 2 * high - 1000.0) == pytest.approx(alone, abs=0.05)


def test_stratified_intervals_cover_at_about_their_stated_rate() -> None:
    source, level, repeats = rng(2), 0.95, 1000
    truth = (DRAWS["normal"][1] + 5.0 + DRAWS["exponential"][1]) / 2
    covered = 0
    for _ in range(repeats):
        strata = [DRAWS["normal"][0](source) + 5.0, DRAWS["exponential"][0](source)]
        low, high = stratified_interval(strata, source, level, resamples=300)
        covered += low <= truth <= high
    assert abs(covered / repeats - level) < binomial_tolerance(level, repeats)


@pytest.mark.slow
def test_differences_of_equals_hold_zero_at_about_the_stated_rate() -> None:
    source, repeats = rng(3), 1000
    same = 0
    for _ in range(repeats):
        hard = source.normal(size=(2, 20))
        one, other = (list(hard + 0.1 * source.normal(size=hard.shape)) for _ in range(2))
        _, low, high = stratified_difference(one, other, source)
        same += low <= 0.0 <= high
    assert abs(same / repeats - 0.95) < binomial_tolerance(0.95, repeats)


def test_rank_intervals_hold_the_true_rank_at_least_at_the_stated_rate() -> None:
    source, repeats = rng(4), 500
    strengths, truth = np.array([0.6, 0.3, 0.28, 0.0]), np.array([1, 2, 3, 4])
    held, widths = np.zeros(4), np.zeros(4)
    for _ in range(repeats):
        hard = source.normal(size=(20, 1))
        ranks = rank_intervals([hard + strengths + 0.15 * source.exponential(size=(20, 4))], source, resamples=300)
        held += (ranks[:, 0] <= truth) & (truth <= ranks[:, 1])
        widths += ranks[:, 1] - ranks[:, 0]
    assert (held / repeats > 0.95 - binomial_tolerance(0.95, repeats)).all()
    # Who is far from the others has one rank, the close two have both.
    assert (widths / repeats)[[0, 3]].max() < 0.1
    assert (widths / repeats)[[1, 2]].min() > 0.5


def test_ranks_where_the_answer_is_known() -> None:
    strata = [np.array([[3.0, 1.0, 2.0, 1.0]]), np.array([[3.0, 1.0, 2.0, 1.0], [math.nan, 9.0, 9.0, 9.0]])]
    assert rank_intervals(strata, rng()).tolist() == [[1, 1], [3, 3], [2, 2], [3, 3]]
    assert rank_intervals([np.array([[math.nan, 1.0]])], rng()).tolist() == [[1, 2], [1, 2]]


def test_ranks_compare_seed_by_seed() -> None:
    """A steady distance decides, although it drowns in the spread between the episodes."""
    hard = rng().normal(size=(20, 1))
    assert rank_intervals([hard + np.array([0.0, 0.01])], rng()).tolist() == [[2, 2], [1, 1]]


def test_differences_need_the_same_strata() -> None:
    with pytest.raises(ValueError, match="shorter"):
        stratified_difference([[1.0], [2.0]], [[1.0]], rng())
