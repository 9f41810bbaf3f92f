"""Compiled functions that find their arrays by a table."""

from __future__ import annotations

import copy
import ctypes
import gc
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fo_gym.binding import Binds, Bound, bound
from fo_gym.compiling import jit

PAIR = np.dtype([("offset", "f8"), ("gain", "f8", (2,))])


@jit
def combine(values, pair, parts, factor, flip, result, last):  # type: ignore[no-untyped-def]
    """All kinds of arguments."""
    count, (row, shift) = parts
    for i in range(last):
        value = pair[i].offset + pair[i].gain[1] * values[row, i] * factor + shift[i]
        result[i] = -count * value if flip else count * value


def arguments(flip: bool = True) -> tuple[Any, ...]:
    """Arrays of one, two and no plain layout, records, numbers, and tuples in each other."""
    values = np.arange(24.0).reshape(2, 12)[:, ::2]
    pair = np.zeros(6, PAIR)
    pair["offset"], pair["gain"] = np.arange(6), np.arange(12.0).reshape(6, 2)
    return values, pair, (3, (1, np.ones(6))), 0.5, flip


def expected(flip: bool = True) -> np.ndarray:
    """What `combine` makes of them."""
    values, pair, (count, (row, shift)), factor, _ = arguments()
    whole = count * (pair["offset"] + pair["gain"][:, 1] * values[row] * factor + shift)
    return -whole if flip else whole


@pytest.mark.parametrize("flip", [True, False])
@pytest.mark.parametrize("given", range(3))
def test_it_is_the_same_call(flip: bool, given: int) -> None:
    result = np.zeros(6)
    rest = (result, 6)
    bound(combine, *arguments(flip), *rest[:given])(*rest[given:])
    np.testing.assert_array_equal(result, expected(flip))


def test_what_it_is_bound_to_lives_on_and_may_change() -> None:
    result, given = np.zeros(6), arguments()
    call = bound(combine, *given, result, 6)
    given[1]["offset"] += 1.0
    del given
    gc.collect()
    call()
    np.testing.assert_array_equal(result, expected() - 3.0)


class Doubling(Binds):
    """An owner of a bound function."""

    bindings = ("_call",)

    def __init__(self) -> None:
        self.values, self.doubled = np.ones(3), np.zeros(3)
        self.bind()

    def bind(self) -> None:
        """See Binds."""
        self._call = bound(_double, self.values, self.doubled)

    def __call__(self) -> list[float]:
        self._call()
        return [float(each) for each in self.doubled]


@jit
def _double(values, doubled):  # type: ignore[no-untyped-def]
    for i in range(len(values)):
        doubled[i] = 2.0 * values[i]


@pytest.mark.parametrize("duplicate", [lambda owner: pickle.loads(pickle.dumps(owner)), copy.deepcopy])
def test_a_copy_is_bound_to_its_own_arrays(duplicate: Callable[[Doubling], Doubling]) -> None:
    one = Doubling()
    other = duplicate(one)
    one.values[:] = 5.0
    assert other() == [2.0, 2.0, 2.0]
    assert one.doubled.tolist() == [0.0, 0.0, 0.0]
    assert one() == [10.0, 10.0, 10.0]


def test_by_itself_it_cannot_be_pickled() -> None:
    call = bound(_double, np.ones(3), np.zeros(3))
    assert isinstance(call, Bound)
    with pytest.raises(TypeError, match="see Binds"):
        pickle.dumps(call)


def test_functions_of_one_name_are_told_apart() -> None:
    """Also by their addresses, which are looked up by name."""

    def made(factor: float) -> Any:
        @jit
        def scale(values, scaled):  # type: ignore[no-untyped-def]
            scaled[0] = factor * values[0]

        return scale

    values, scaled = np.ones(1), np.zeros(1)
    calls = {factor: bound(made(factor), values, scaled) for factor in (2.0, 3.0)}
    for factor in (2.0, 3.0, 2.0):
        calls[factor]()
        assert scaled[0] == factor
    for factor, call in calls.items():
        ctypes.CFUNCTYPE(None, ctypes.c_int64)(call.address)(call.args[0])
        assert scaled[0] == factor
