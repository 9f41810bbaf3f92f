"""How the bench times: by turns, on a machine that is made up; and its verdicts."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from fo_gym.bench.bars import verdict
from fo_gym.bench.measure import Subject, calls_per_slice, interleaved, seconds, spread


class Machine:
    """A machine on which time passes only as its subjects say; it may get slower and slower."""

    def __init__(self, slowing: float = 0.0) -> None:
        self.now = 100.0
        self.slowing = slowing
        self.log: list[str] = []

    def clock(self) -> float:
        return self.now

    def pass_time(self, cost: float) -> None:
        self.now += cost * (1.0 + self.slowing * (self.now - 100.0))

    def subject(self, name: str, cost: float, prepare: float = 7.0) -> Subject:
        def call() -> None:
            self.log.append(name)
            self.pass_time(cost)

        def get_ready() -> None:
            self.log.append(f"prepare {name}")
            self.now += prepare

        return Subject(call, get_ready)

    def turns(self) -> list[str]:
        """Who was timed when."""
        return [entry.removeprefix("prepare ") for entry in self.log if entry.startswith("prepare")]


def test_only_the_calls_are_timed() -> None:
    machine = Machine()
    assert seconds(machine.subject("a", 0.25), 4, machine.clock) == pytest.approx(1.0)
    assert machine.log == ["prepare a", *["a"] * 5]


@pytest.mark.parametrize(("cost", "calls"), [(0.001, 150), (0.01, 15), (0.06, 2), (0.15, 1), (40.0, 1)])
def test_calls_of_a_slice(cost: float, calls: int) -> None:
    machine = Machine()
    assert calls_per_slice(machine.subject("a", cost), 0.15, machine.clock) == calls


def test_spread() -> None:
    assert spread(np.array([9.0, 1.0, 4.0, 2.0, 3.0])) == (3.0, 2.0, 4.0)
    assert spread(np.array([5.0])) == (5.0, 5.0, 5.0)


@pytest.mark.parametrize("repeats", [2, 6])
def test_everybody_comes_first_as_often_as_last(repeats: int) -> None:
    machine = Machine()
    names = ("a", "b", "c")
    subjects = [machine.subject(name, cost) for name, cost in zip(names, (0.1, 0.2, 0.4), strict=True)]
    times = interleaved(subjects, repeats, 0.4, machine.clock)
    np.testing.assert_allclose(times, np.tile([0.1, 0.2, 0.4], (repeats, 1)))
    turns = machine.turns()[-3 * repeats :]
    rounds = [turns[3 * i : 3 * i + 3] for i in range(repeats)]
    assert all(set(each) == set(names) for each in rounds)
    for first, second in combinations(names, 2):
        assert sum(each.index(first) < each.index(second) for each in rounds) == repeats // 2


def test_a_machine_that_slows_down_is_fair() -> None:
    """The ratio errs to either side in turn."""
    machine = Machine(slowing=1e-3)
    ours, peer = interleaved([machine.subject("ours", 1.0), machine.subject("peer", 1.0)], 10, 5.0, machine.clock).T
    ratios = ours / peer
    assert (ratios[::2] < 1.0).all()
    assert (ratios[1::2] > 1.0).all()
    assert spread(ratios).median == pytest.approx(1.0, abs=1e-3)
    assert ours[-1] > 1.1 * ours[0]


@pytest.mark.parametrize(
    ("measured", "ratio", "bar", "expected"),
    [
        ("batch", 0.25, 0.25, "holds"),
        ("batch", 0.26, 0.25, "misses"),
        ("single", 3.0, 2.0, "misses"),
        ("threads", 1.7, 1.7, "holds"),
        ("threads", 1.6, 1.7, "misses"),
        ("growth", 1.03, 1.02, "misses"),
        ("equal accuracy", 41.0, 40.0, "holds"),
        ("equal accuracy", 39.0, 40.0, "misses"),
        ("throughput", 8.0, 8.0, "holds"),
        ("throughput", 7.9, 8.0, "misses"),
        ("throughput", 7.9, np.nan, ""),
    ],
)
def test_verdict(measured: str, ratio: float, bar: float, expected: str) -> None:
    assert verdict(measured, ratio, bar) == expected
