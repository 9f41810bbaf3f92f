"""Random generators: which seeds they take, how their states are kept, and which one a draw of an episode takes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from fo_gym.checks import shown, whole_number

MAX_SEED = 2**128 - 1
"""The largest seed, 128 bits: as many as NumPy draws where no seed is given."""

__all__ = [
    "MAX_SEED",
    "Streams",
    "check_random_state",
    "check_random_states",
    "restored",
    "seed_number",
    "states_of",
]


class Streams:
    """The random generators of one episode's draws, one for each name.

    A draw that is added, left out, or given another range changes none of the others, and so no other number of the
    episodes of a seed.

    Args:
        generator: the environment's. The episode's seed is taken from it, and nothing else.
    """

    def __init__(self, generator: np.random.Generator) -> None:
        self._streams: dict[str, np.random.Generator] = {}
        self._seed: list[int] = generator.integers(2**32, size=4).tolist()

    def __call__(self, name: str) -> np.random.Generator:
        """The generator of the draw of this name; asked again, it goes on."""
        if name not in self._streams:
            sequence = np.random.SeedSequence(self._seed, spawn_key=tuple(name.encode()))
            self._streams[name] = np.random.default_rng(sequence)
        return self._streams[name]


def seed_number(name: str, value: Any) -> int:
    """The seed of a random generator. Raises ValueError where it is no whole number from 0 to MAX_SEED."""
    if isinstance(value, int) and value > MAX_SEED:
        raise ValueError(f"{name} is {shown(value)}; give a whole number of at least 0 and of at most 128 bits")
    return whole_number(name, value, 0)


def check_random_state(name: str, state: Any, scratch: np.random.Generator) -> None:
    """Raise ValueError where a generator of the kind of `scratch`, which is changed, cannot be set to `state`."""
    try:
        scratch.bit_generator.state = state
    except Exception as error:  # NumPy raises what comes up, according to what is wrong with it
        raise ValueError(f"{name} is {shown(state)}; give the state that such a generator had: {error!r}") from error


def check_random_states(name: str, states: Any, count: int) -> None:
    """Raise ValueError where these are no states of `count` generators as `numpy.random.default_rng` makes them."""
    if not isinstance(states, list | tuple) or len(states) != count:
        raise ValueError(f"{name} is {shown(states)}; give a list of {count} states of random generators")
    scratch = np.random.default_rng(0)
    for i, state in enumerate(states):
        check_random_state(f"{name}[{i}]", state, scratch)


def states_of(generators: Iterable[np.random.Generator]) -> list[dict[str, Any]]:
    """Copies of the states of random generators."""
    return [dict(generator.bit_generator.state) for generator in generators]


def restored(states: Iterable[Any]) -> list[np.random.Generator]:
    """New random generators, as `numpy.random.default_rng` makes them, in these states."""
    generators = []
    for state in states:
        generators.append(np.random.default_rng(0))
        generators[-1].bit_generator.state = state
    return generators
