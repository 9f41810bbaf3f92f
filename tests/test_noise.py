"""Noise that is drawn ahead is the noise that each generator gives one period at a time."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from fo_gym.generators import restored
from fo_gym.hardware.noise import _AHEAD, _BLOCKS, Noise

DOF = 3
PERIODS = (_BLOCKS + 1) * _AHEAD + 5


def generators(*seeds):
    return [np.random.default_rng(seed) for seed in seeds]


def one_by_one(generator, periods):
    """What a generator gives when it is asked in every period."""
    return np.array([generator.standard_normal(DOF) for _ in range(periods)])


def test_it_is_each_generators_own_sequence():
    noise = Noise(generators(1, 2), DOF)
    drawn = np.array([noise.standard_normal() for _ in range(PERIODS)])
    for i, seed in enumerate((1, 2)):
        np.testing.assert_array_equal(drawn[:, i], one_by_one(np.random.default_rng(seed), PERIODS))


@pytest.mark.parametrize("periods", [0, 1, _AHEAD, PERIODS])
def test_its_states_are_those_of_generators_that_were_not_asked_ahead(periods):
    noise, alone = Noise(generators(7), DOF), np.random.default_rng(7)
    for _ in range(periods):
        noise.standard_normal()
    one_by_one(alone, periods)
    assert noise.states == [alone.bit_generator.state]
    again = Noise(restored(noise.states), DOF)
    for _ in range(PERIODS):
        np.testing.assert_array_equal(again.standard_normal(), noise.standard_normal())


def test_a_new_episode_changes_no_neighbour():
    noise = Noise(generators(1, 2, 3), DOF)
    for _ in range(10):
        noise.standard_normal()
    noise.put([1], Noise(generators(9), DOF))
    drawn = np.array([noise.standard_normal() for _ in range(PERIODS)])
    for i, seed in ((0, 1), (2, 3)):
        np.testing.assert_array_equal(drawn[:, i], one_by_one(np.random.default_rng(seed), 10 + PERIODS)[10:])
    newcomer = np.random.default_rng(9)
    np.testing.assert_array_equal(drawn[:, 1], one_by_one(newcomer, PERIODS))
    assert noise.states[1] == newcomer.bit_generator.state


def test_a_copy_goes_on_by_itself():
    noise = Noise(generators(4), DOF)
    noise.standard_normal()
    other = copy.deepcopy(noise)
    first = noise.standard_normal().copy()
    noise.standard_normal()
    np.testing.assert_array_equal(other.standard_normal(), first)


def test_nobody_writes_into_it():
    with pytest.raises(ValueError, match="read-only"):
        Noise(generators(4), DOF).standard_normal()[0] = 0.0
