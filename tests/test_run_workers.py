"""A protocol in worker processes: the same bytes as in this one, also where a competitor takes a worker down."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from dying import ANSWERS, answer, tasks
from tables import SQUARE

from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.evaluation.runs.run import ENDED, run_protocol
from fo_gym.evaluation.runs.trial import trials_together
from fo_gym.files import csv

pytestmark = pytest.mark.slow
CRASH = """
import os

from baselines import PDObserver


class Late(PDObserver):
    def __init__(self):
        super().__init__(50.0, 10.0)
        self.tick = 0

    def estimate(self, signals):
        self.tick += 1
        if self.tick > 3:
            raise KeyError("no such key")
        return super().estimate(signals)


class Crash(Late):
    def estimate(self, signals):
        os._exit(1)
"""


@pytest.fixture
def theirs(tmp_path: Path) -> str:
    """A stranger's file."""
    path = tmp_path / "theirs.py"
    path.write_text(CRASH, encoding="utf-8")
    return str(path)


def test_the_number_of_workers_does_not_matter(theirs: str) -> None:
    """To the byte, with one that fails and one that does not exist among them."""
    names = (f"{theirs}:Late", "ideal", "nobody", "pid-high")
    protocol = Protocol("small", "leaderboard", 2, (SQUARE,), ("nominal", "randomized"), names)
    one, two = (run_protocol(protocol, jobs=jobs) for jobs in (1, 2))
    assert csv(one.episodes) == csv(two.episodes)
    assert csv(leaderboard(one.episodes)) == csv(leaderboard(two.episodes))
    assert set(one.episodes["status"]) == {"ok", "failed"}


def test_a_competitor_that_ends_its_process_fails_alone(theirs: str) -> None:
    """As a crash in compiled code would: its rows say so, and the others, before and after it, are as ever."""
    spec = f"{theirs}:Crash"
    protocol = Protocol("crash", "validation", 1, (SQUARE,), ("nominal",), ("pd-low", spec, "pd-high"))
    table = run_protocol(protocol, jobs=2).episodes.set_index("compensator")
    assert table["status"].drop(spec).eq("ok").all()
    assert table.loc[spec, "status"] == "failed"
    assert list(table.index) == ["none", "ideal", "bound", "pd-low", spec, "pd-high"]
    assert table.loc[spec, "error"].endswith("it ended the process that it ran in, with exit status 1")
    assert table.loc["pd-high", "frr"] > table.loc["pd-low", "frr"]


def test_a_killed_worker_costs_nothing_but_time(tmp_path: Path) -> None:
    assert dict(Processes(2).run(answer, tasks(str(tmp_path)))) == ANSWERS


class Losing:
    """Work in this process, in which "pd-high" is lost each time it is tried, and who is tried with it."""

    workers = 1

    def run(self, function: Callable[..., Any], tasks: Sequence[tuple[Any, ...]]) -> Iterator[tuple[int, Any]]:
        for place, task in enumerate(tasks):
            lost = function is trials_together and "pd-high" in {competitor.name for competitor in task[1]}
            yield place, None if lost else function(*task)


def test_who_is_lost_with_his_process_has_failed_rows() -> None:
    protocol = Protocol("lost", "validation", 1, (SQUARE,), ("nominal",), ("pd-low", "pd-high", "pid-high"))
    table = run_protocol(protocol, backend=Losing()).episodes.set_index("compensator")
    assert table["status"].drop("pd-high").unique().tolist() == ["ok"]
    assert table.loc["pd-high", ["status", "error"]].tolist() == ["failed", ENDED]
