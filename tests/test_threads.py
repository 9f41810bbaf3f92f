"""Threads of a batch: as many as are asked for, and nothing that comes out depends on how many."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable
from functools import partial
from threading import Event, Thread, current_thread
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import fo_gym
from fo_gym.binding import bound
from fo_gym.compiling import jit
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
    ("num_envs", "dof", "wanted", "count"),
    [(1, 7, 8, 1), (56, 7, 8, 1), (57, 7, 8, 2), (128, 7, 3, 3), (256, 1, 8, 3), (85, 1, 8, 1), (999, 7, 1, 1)],
)
def test_a_small_batch_has_fewer(num_envs: int, dof: int, wanted: int, count: int) -> None:
    threads = Threads(num_envs, dof, wanted)
    done = np.zeros(num_envs, dtype=int)

    def work(first: int, last: int) -> None:
        done[first:last] += 2

    threads.run([partial(work, *share) for share in threads.shares])
    assert (threads.count, len(threads.shares)) == (count, count)
    np.testing.assert_array_equal(done, 2)


@jit
def _squared(values: Any, squares: Any, first: int, last: int) -> None:
    for i in range(first, last):
        squares[i] += values[i] ** 2


@pytest.mark.parametrize("pause", [0.0, 0.1], ids=["awake", "asleep"])
def test_compiled_and_other_work_by_turns(pause: float) -> None:
    """Helpers that still look out for work, and such as sleep by now."""
    threads, values, squares = Threads(128, 7, 3), np.arange(128.0), np.zeros(128)
    works = [bound(_squared, values, squares, *share) for share in threads.shares]
    seen: list[str] = []
    for count in range(1, 4):
        threads.run(works)
        np.testing.assert_array_equal(squares, count * values**2)
        threads.run([lambda: seen.append(current_thread().name)] * 3)
        time.sleep(pause)
    assert len(seen) == 9
    assert len(set(seen)) == 3


def test_who_comes_while_the_helpers_are_busy_works_alone() -> None:
    threads, began, go = Threads(128, 7, 2), Event(), Event()

    def long() -> None:
        began.set()
        assert go.wait(60)

    other = Thread(target=threads.run, args=([lambda: None, long],))
    other.start()
    assert began.wait(60)
    seen: list[str] = []
    threads.run([lambda: seen.append(current_thread().name)] * 2)
    go.set()
    other.join()
    assert seen == [current_thread().name] * 2


def test_what_fails_in_a_thread_is_raised() -> None:
    def work(first: int) -> None:
        if first > 0:
            raise ZeroDivisionError(f"environments from {first}")

    threads = Threads(128, 7, 2)
    works = [partial(work, first) for first, _ in threads.shares]
    with pytest.raises(ZeroDivisionError, match="environments from 64"):
        threads.run(works)
    threads.run([lambda: None] * 2)  # it is not raised again


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
def test_an_environment_of_the_parent_goes_on() -> None:
    env: Any = gym.make_vec("FJRStiction-v0", num_envs=ENVS, num_threads=2)
    env.reset(seed=0)
    env.step(np.zeros((ENVS, 1)))

    def after() -> bytes:
        env.step(np.ones((ENVS, 1)))
        return env.step(np.zeros((ENVS, 1)))[0].tobytes()

    assert forked(after) == after()


def test_nobody_works_on_when_one_fails() -> None:
    done = []

    def interrupted() -> None:
        raise KeyboardInterrupt

    def slow() -> None:
        time.sleep(0.2)
        done.append(1)

    with pytest.raises(KeyboardInterrupt):
        Threads(128, 7, 2).run([interrupted, slow])
    assert done == [1]
