"""Threads of a batch: as many as are asked for, and nothing that comes out depends on how many."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import fo_gym
from fo_gym.evaluation.episode.recorder import record
from fo_gym.threads import VARIABLE, Threads, number_of_threads

ENVS = 200
"""More arms than a thread does alone."""


def stepped(env_id: str, variant: str, num_threads: int | None, steps: int = 40) -> list[np.ndarray]:
    """What a batch shows under random actions, and its reward."""
    env: Any = gym.make_vec(env_id, num_envs=ENVS, variant=variant, num_threads=num_threads)
    obs, _ = env.reset(seed=3)
    generator, limit = np.random.default_rng(0), env.single_action_space.high
    shown = [obs]
    for _ in range(steps):
        obs, reward, *_, info = env.step(generator.uniform(-0.3, 0.3, (ENVS, len(limit))) * limit)
        shown += [obs, reward, info["z"], info["tau_f"]]
    return shown


@pytest.mark.parametrize("variant", ["randomized", "hardware"])
@pytest.mark.parametrize("env_id", ["FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"])
def test_any_number_gives_the_same_to_the_bit(env_id: str, variant: str) -> None:
    one = stepped(env_id, variant, 1)
    for number in (2, 3):
        for expected, found in zip(one, stepped(env_id, variant, number), strict=True):
            assert found.tobytes() == expected.tobytes()


@pytest.mark.parametrize(
    ("num_envs", "dof", "wanted", "count", "shares"),
    [(1, 7, 8, 1, 1), (63, 7, 8, 1, 1), (128, 7, 8, 4, 2), (256, 7, 2, 2, 2), (256, 1, 2, 2, 1), (999, 7, 1, 1, 1)],
)
def test_a_small_batch_has_fewer(num_envs: int, dof: int, wanted: int, count: int, shares: int) -> None:
    threads = Threads(num_envs, dof, wanted)
    done = np.zeros(num_envs, dtype=int)

    def work(step: int, first: int, last: int) -> None:
        done[first:last] += step

    threads.run(work, 2)
    assert (threads.count, len(threads.shares)) == (count, shares)
    np.testing.assert_array_equal(done, 2)


def test_what_fails_in_a_thread_is_raised() -> None:
    def work(first: int, last: int) -> None:
        if first > 0:
            raise ZeroDivisionError(f"environments {first} to {last}")

    with pytest.raises(ZeroDivisionError, match="environments 64 to 128"):
        Threads(128, 7, 2).run(work)


def test_who_is_not_told_asks_the_variable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert number_of_threads(None) == 1
    monkeypatch.setenv(VARIABLE, "2")
    assert number_of_threads(None) == 2
    assert number_of_threads(1) == 1
    env: Any = gym.make_vec("FJRStiction-v0", num_envs=ENVS)
    assert env.unwrapped.simulation.plant.threads.count == 2


@pytest.mark.parametrize("wrong", [0, -1, 1.5, True, "two", 1000])
def test_what_is_no_number_of_threads(wrong: Any) -> None:
    with pytest.raises(ValueError, match="num_threads is"):
        gym.make_vec("FJRStiction-v0", num_envs=2, num_threads=wrong)


@pytest.mark.parametrize("wrong", ["two", "0", "-1", "1.5"])
def test_what_the_variable_may_not_say(wrong: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, wrong)
    with pytest.raises(ValueError, match=f"{VARIABLE} is .*1"):
        gym.make_vec("FJRStiction-v0", num_envs=2)


def test_an_evaluation_leaves_the_processor_to_its_jobs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "2")
    counts: list[int] = []

    def note(env: Any) -> None:
        counts.append(env.simulation.plant.threads.count)

    none = fo_gym.make_compensator("none")
    record(none, "none", "FJRStiction-v0", "nominal", range(ENVS), {"duration": 0.01}, note)
    assert counts == [1]


FORKS = "fork" in multiprocessing.get_all_start_methods()
forking = pytest.mark.skipif(not FORKS, reason="this system does not fork processes")
threaded = pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")


def forked(work: Callable[[], Any]) -> Any:
    """What a forked process finds."""
    mine, its = multiprocessing.Pipe()
    process = multiprocessing.get_context("fork").Process(target=lambda: its.send(work()))
    process.start()
    try:
        assert mine.poll(60), "the forked process waits for ever"
        return mine.recv()
    finally:
        process.kill()
        process.join()


@forking
@threaded
def test_a_forked_process_has_its_own() -> None:
    """The threads of its parent are not there."""

    def last() -> bytes:
        return stepped("FJRRegulation-v0", "nominal", 2, steps=5)[-1].tobytes()

    assert forked(last) == last()


@forking
@threaded
def test_an_environment_of_the_parent_says_that_its_threads_are_gone() -> None:
    env: Any = gym.make_vec("FJRStiction-v0", num_envs=ENVS, num_threads=2)
    env.reset(seed=0)
    env.step(np.zeros((ENVS, 1)))

    def refused(call: Callable[[], object]) -> str:
        try:
            call()
        except RuntimeError as error:
            return str(error)
        return "it went on"

    for call in (lambda: env.step(np.zeros((ENVS, 1))), lambda: env.reset(seed=0)):
        assert "make the environment in this process" in forked(partial(refused, call))


def test_nobody_works_on_when_one_fails() -> None:
    done = []

    def work(first: int, last: int) -> None:
        if first == 0:
            raise KeyboardInterrupt
        time.sleep(0.2)
        done.append(first)

    with pytest.raises(KeyboardInterrupt):
        Threads(128, 7, 2).run(work)
    assert done == [64]
