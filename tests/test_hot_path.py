"""What a step costs, counted instead of timed: calls that Python makes, and arrays in compiled functions.

Both are the same on every machine and in every run. A step that needs more of them than is allowed here has become
slower: make it lean again, or say why it must cost that.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numba import njit
from numba.core.runtime import _nrt_python as runtime

from fo_gym.simulation.memory import Memory
from fo_gym.tasks.step import StepControl

CALLS = {
    ("FJRStiction-v0", "nominal"): 55,
    ("FJRStiction-v0", "hardware"): 136,
    ("FJRRegulation-v0", "nominal"): 55,
    ("FJRRegulation-v0", "hardware"): 136,
    ("FJRSquare-v0", "nominal"): 55,
    ("FJRSquare-v0", "hardware"): 136,
    ("FJRTracking-v0", "nominal"): 55,
    ("FJRInteraction-v0", "nominal"): 60,
}
"""Python's and C's functions that Python calls in a step of one environment, as they were counted."""

OF_A_VECTOR = 8
"""Beside those, in a step of a vector."""

ARRAYS = {"FJRStiction-v0": 17, "FJRRegulation-v0": 20, "FJRSquare-v0": 32}
"""Arrays that are handed to the compiled functions of a step or made there, once for all environments."""

TOLERANCE = 1.1
"""Between versions of Python and of libraries the counts differ by a few."""


def calls(step: Callable[[], object]) -> int:
    """How many functions Python calls in it."""
    counted = -1  # that of `setprofile` itself

    def count(_: Any, event: str, __: Any) -> None:
        nonlocal counted
        counted += event in ("call", "c_call")

    gc.collect()
    gc.disable()  # a collection calls whom it frees
    sys.setprofile(count)
    try:
        step()
    finally:
        sys.setprofile(None)
        gc.enable()
    return counted


def arrays(step: Callable[[], object]) -> int:
    """How many arrays are handed to compiled functions in it or made there."""
    runtime.memsys_enable_stats()
    try:
        before = runtime.memsys_get_stats_alloc()
        step()
        return int(runtime.memsys_get_stats_alloc() - before)
    finally:
        runtime.memsys_disable_stats()


def stepping(env_id: str, variant: str, num_envs: int | None = None) -> Callable[[], object]:
    """A step of one environment, or of a vector, that has been stepped before."""
    if num_envs is None:
        env: Any = gym.make(env_id, variant=variant)
    else:
        env = gym.make_vec(env_id, num_envs, variant=variant, num_threads=1)
    env.reset(seed=0)
    action = np.zeros(env.action_space.shape)
    for _ in range(5):
        env.step(action)
    return lambda: env.step(action)


@pytest.mark.parametrize(("env_id", "variant"), CALLS)
def test_python_calls_no_more_than_it_did(env_id: str, variant: str) -> None:
    allowed = CALLS[env_id, variant]
    assert calls(stepping(env_id, variant)) <= TOLERANCE * allowed
    few, many = (calls(stepping(env_id, variant, number)) for number in (2, 64))
    assert few == many, "what Python does grows with the number of environments"
    assert many <= TOLERANCE * (allowed + OF_A_VECTOR)


@pytest.mark.parametrize("env_id", ARRAYS)
def test_compiled_functions_have_no_more_arrays_than_they_had(env_id: str) -> None:
    for number in (2, 64):
        assert arrays(stepping(env_id, "nominal", number)) <= TOLERANCE * ARRAYS[env_id]


def test_more_calls_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """The observation put together of its parts, and nothing else changed, is seen."""
    lean = calls(stepping("FJRStiction-v0", "nominal"))
    monkeypatch.setattr(Memory, "observation", lambda memory: memory.signals.observation())
    assert calls(stepping("FJRStiction-v0", "nominal")) > TOLERANCE * lean


def test_more_arrays_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A controller one of whose compiled functions makes an array is seen."""

    @njit
    def copied(array: Any) -> Any:
        return array.copy()

    follow = StepControl.follow

    def wasteful(control: StepControl, ticks: Any, theta: Any, theta_dot: Any, tau_c: Any) -> None:
        follow(control, ticks, copied(theta), theta_dot, tau_c)

    lean = arrays(stepping("FJRStiction-v0", "nominal"))
    monkeypatch.setattr(StepControl, "follow", wasteful)
    assert arrays(stepping("FJRStiction-v0", "nominal")) == lean + 2  # handed over, and made
