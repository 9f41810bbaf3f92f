"""Who is apart: p-values, Holm's correction, the smallest difference that counts, and the letters of the tied."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fo_gym.evaluation.results.statistics import stratified_difference
from fo_gym.evaluation.results.ties import (
    LEVEL,
    RELEVANT,
    Difference,
    compared_pairs,
    holm,
    paired_p,
    tied_groups,
)


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


# p-values


def signed_rank_p(differences: np.ndarray) -> float:
    """Wilcoxon's p by counting: how many of all ways to put the signs have a rank sum as far from the middle."""
    ranks = np.argsort(np.argsort(np.abs(differences))) + 1
    sums = np.array(list(product([0, 1], repeat=len(ranks)))) @ ranks
    middle = ranks.sum() / 2
    seen = abs(ranks[differences > 0].sum() - middle)
    return float(np.mean(np.abs(sums - middle) >= seen))


@pytest.mark.parametrize("count", [2, 3, 10])
def test_p_is_wilcoxons(count: int) -> None:
    values = rng(1).normal(0.3, 1.0, count)
    assert paired_p([values], [np.zeros(count)]) == pytest.approx(signed_rank_p(values), rel=1e-9)
    assert paired_p([values + 5.0], [np.full(count, 5.0)]) == pytest.approx(signed_rank_p(values), rel=1e-9)


def test_p_of_strata_is_that_of_their_mean() -> None:
    a, b = rng(3).normal(size=(2, 6))
    assert paired_p([a, b], [np.zeros(6)] * 2) == paired_p([(a + b) / 2], [np.zeros(6)])
    assert paired_p([a, b[:4]], [np.zeros(6), np.zeros(4)]) == paired_p([(a + b)[:4]], [np.zeros(4)])


def test_who_is_lost_in_every_episode_is_apart_by_whatever_amount() -> None:
    lost = -(10.0 ** rng(6).uniform(-2.0, 2.0, 20))
    assert paired_p([lost], [np.ones(20)]) < 1e-5


def test_p_where_nothing_is_left_to_chance() -> None:
    same = np.array([0.5, 0.7, 0.9])
    assert paired_p([same], [same]) == 1.0
    assert paired_p([[0.5]], [[0.6]]) == 0.0
    assert paired_p([[0.5]], [[0.5]]) == 1.0
    assert math.isnan(paired_p([[0.5], [math.nan]], [[0.6], [0.6]]))


def test_p_leaves_out_incomplete_pairs() -> None:
    a, b = rng(4).normal(size=(2, 8))
    holes = np.insert(a, [0, 4], math.nan), np.insert(b, [0, 4], 7.0)
    assert paired_p([holes[0]], [holes[1]]) == paired_p([a], [b])


# Holm


HOLM = [
    # By hand: 0.01 x 4, 0.013 x 3 (below 0.04, so 0.04), 0.02 x 2 (so 0.04), 0.5 x 1.
    ([0.02, 0.01, 0.5, 0.013], [0.04, 0.04, 0.5, 0.04]),
    ([0.01, 0.04, 0.03, 0.005], [0.03, 0.06, 0.06, 0.02]),
    ([0.4, 0.6], [0.8, 0.8]),
    ([0.9, 0.8, 0.7], [1.0, 1.0, 1.0]),
    ([math.nan, 0.02, 0.01], [math.nan, 0.02, 0.02]),
    ([], []),
]


@pytest.mark.parametrize(("values", "expected"), HOLM)
def test_holm(values: list[float], expected: list[float]) -> None:
    np.testing.assert_allclose(holm(values), expected, rtol=1e-12)


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=12), st.floats(0.01, 0.2))
def test_holm_rejects_what_the_step_down_procedure_does(values: list[float], level: float) -> None:
    """From the smallest on, p against level / (number left), until one is not below."""
    order = np.argsort(values, kind="stable")
    rejected = set[int]()
    for step, place in enumerate(order):
        if values[place] * (len(values) - step) >= level:
            break
        rejected.add(int(place))
    assert {i for i, p in enumerate(holm(values)) if p < level} == rejected


def test_equal_competitors_are_seldom_apart() -> None:
    """Of tables of twelve that are all the same, on hard and easy episodes, at most one in twenty has a pair apart."""
    source, repeats, apart = rng(5), 150, 0
    for _ in range(repeats):
        frr = source.normal(size=20) + 0.1 * source.normal(size=(12, 20))
        p = [paired_p([frr[i]], [frr[j]]) for i in range(12) for j in range(i)]
        apart += bool(holm(p).min() < LEVEL)
    assert apart / repeats <= 0.05 + 3 * math.sqrt(0.05 * 0.95 / repeats)


# Ties


TIES = [
    (Difference(0.01, 0.005, 0.02, 0.001), False),
    (Difference(0.01, -0.001, 0.02, 0.001), True),  # the interval holds zero
    (Difference(0.01, 0.0, 0.02, 0.001), True),
    (Difference(0.01, 0.005, 0.02, LEVEL), True),  # too many pairs
    (Difference(0.0006, 0.0005, 0.9 * RELEVANT, 0.0), True),  # too small
    (Difference(0.0006, 0.0005, RELEVANT, 0.0), False),  # perhaps not too small
    (Difference(math.nan, math.nan, math.nan, math.nan), True),
    (Difference(), True),
]


@pytest.mark.parametrize(("difference", "tied"), TIES)
def test_who_is_tied(difference: Difference, tied: bool) -> None:
    assert difference.tied is tied
    assert difference.turned.tied is tied


LEVELS = {"a": 0.0, "b": 0.0, "c": 0.05}


def test_pairs_are_compared_either_way_round() -> None:
    hard = rng(6).normal(size=20)
    rows = {name: [hard + level + 0.01 * rng(i).normal(size=20)] for i, (name, level) in enumerate(LEVELS.items())}
    pairs = compared_pairs(rows, lambda one, other: rng(ord(one) + ord(other)))
    mean, low, high = stratified_difference(rows["a"], rows["c"], rng(ord("a") + ord("c")))
    assert (pairs["a", "c"].mean, pairs["a", "c"].low, pairs["a", "c"].high) == (mean, low, high)
    assert pairs["c", "a"] == pairs["a", "c"].turned
    assert [pairs["a", name].tied for name in "abc"] == [True, True, False]
    p = {pair: paired_p(rows[pair[0]], rows[pair[1]]) for pair in ("ab", "ac", "bc")}
    corrected = dict(zip(p, holm(list(p.values())), strict=True))
    assert {pair: pairs[pair[0], pair[1]].p for pair in p} == pytest.approx(corrected, rel=1e-12)


# Letters


GROUPS = [
    ([], ["a", "a", "a", "a"]),
    ([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)], ["a", "b", "c", "d"]),
    ([(0, 2), (0, 3), (1, 3)], ["a", "ab", "bc", "c"]),
    ([(0, 1), (0, 2), (0, 3)], ["a", "b", "b", "b"]),
    ([(1, 2)], ["ab", "a", "b", "ab"]),
]


@pytest.mark.parametrize(("apart", "letters"), GROUPS)
def test_tied_groups(apart: list[tuple[int, int]], letters: list[str]) -> None:
    ties = np.ones((4, 4), dtype=bool)
    for i, j in apart:
        ties[i, j] = ties[j, i] = False
    assert tied_groups(ties) == letters


@given(st.integers(0, 2**32 - 1))
def test_those_who_share_a_letter_are_those_who_are_tied(seed: int) -> None:
    ties = rng(seed).random((8, 8)) < 0.6
    ties = ties | ties.T | np.eye(8, dtype=bool)
    groups = [set(letters) for letters in tied_groups(ties)]
    assert np.array_equal([[bool(one & other) for other in groups] for one in groups], ties)
