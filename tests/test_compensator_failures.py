"""What happens when a compensator misbehaves: the error names it, the tick and the episode."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from answering import STICTION, Answering, arrays, assert_same, episodes, silent

from fo_gym import CompensatorError, Signals, evaluate, make_compensator


def explode(*_: Any) -> Any:
    raise KeyError("oops")


def from_tick_3(value: Any) -> Callable[[Signals, int], Any]:
    return lambda signals, tick: value if tick >= 3 else silent(signals, tick)


BROKEN: list[tuple[Callable[[Signals, int], Any], str]] = [
    (lambda signals, tick: explode() if tick == 3 else silent(signals, tick), "estimate raised KeyError at tick 3"),
    (from_tick_3(np.array([[0.0], [math.nan]])), r"returned \[nan\] at tick 3 in episode 1; it must be finite"),
    (from_tick_3(np.array([[math.inf], [0.0]])), r"returned \[inf\] at tick 3 in episode 0; it must be finite"),
    (from_tick_3(np.zeros(2)), r"shape \(2,\) at tick 3; \(num_envs, dof\) is \(2, 1\)"),
    (from_tick_3(np.zeros((2, 2))), r"shape \(2, 2\) at tick 3; \(num_envs, dof\) is \(2, 1\)"),
    (from_tick_3(0.0), r"shape \(\) at tick 3"),
    (from_tick_3(None), "at tick 3"),
    (from_tick_3("zero"), "estimate .* at tick 3"),
]


@pytest.mark.parametrize(("answer", "message"), BROKEN)
def test_a_broken_estimate_is_named(answer: Callable[[Signals, int], Any], message: str) -> None:
    with pytest.raises(CompensatorError, match=f"^who: .*{message}"):
        episodes(STICTION, (1, 2)).record(Answering(answer), "who")


def test_a_broken_reset_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Answering, "reset", explode)
    with pytest.raises(CompensatorError, match=r"^Answering: reset raised KeyError: 'oops'"):
        evaluate(Answering(silent), STICTION, duration=0.1)


def test_gains_that_do_not_fit_the_sampling_are_named() -> None:
    with pytest.raises(CompensatorError, match=r"^PDObserver: reset raised ValueError.*too fast"):
        evaluate(make_compensator("pd-low", L=250.0), STICTION, duration=0.1, decimation=5)


@pytest.mark.parametrize("value", [np.array([[1], [-2]]), [[1], [-2]], np.array([[1.0], [-2.0]], dtype=np.float32)])
def test_whatever_is_a_finite_array_will_do(value: Any) -> None:
    batch = episodes(STICTION, (1, 2))
    exact = batch.record(Answering(lambda *_: np.array([[1.0], [-2.0]])), "exact")
    assert_same(arrays(batch.record(Answering(lambda *_: value), "other")), arrays(exact))
