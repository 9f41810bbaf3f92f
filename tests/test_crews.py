"""Who shares a worker and a batch: crews and teams, in which each does what it does alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd
import pytest

import fo_gym
from fo_gym.evaluation.competitors.entry import competitor_of
from fo_gym.evaluation.competitors.team import Team
from fo_gym.evaluation.results.sweep import Grid, Plan
from fo_gym.evaluation.runs import trial
from fo_gym.evaluation.runs.backends import Processes, Task
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.run import ENDED, run_contests
from fo_gym.evaluation.runs.trial import reference_trials, trials_together

STICTION = "FJRStiction-v0"


class Dying(Processes):
    """Workers that are lost whenever L = 60 takes part."""

    def run(self, function: Callable[..., Any], tasks: Sequence[Task]) -> Iterator[tuple[int, Any]]:
        for place, task in enumerate(tasks):
            dies = function is trials_together and any(each.gains.get("L") == 60.0 for each in task[1])
            yield place, None if dies else function(*task)


def test_who_ends_the_process_is_found_among_those_of_its_batch() -> None:
    episodes = EpisodeSet(STICTION, "nominal", (1,), {"duration": 0.05})
    plan = Plan(Grid("pid-high", {"L": [50.0, 60.0, 70.0]}), [episodes])
    rows = plan.table(run_contests(plan.contests, "", backend=Dying(1)))
    assert rows["status"].tolist() == ["ok", "failed", "ok"]
    assert rows["error"][1] == ENDED


def test_members_of_a_team_see_their_share_alone() -> None:
    seen = []

    class Member(fo_gym.compensators.NoCompensation):
        def reset(self, joints: fo_gym.JointInfo, num_envs: int) -> None:
            seen.append((num_envs, joints.motor_inertia.ravel().tolist()))
            super().reset(joints, num_envs)

        def estimate(self, signals: fo_gym.Signals) -> np.ndarray:
            return signals.theta

    joints = fo_gym.JointInfo(1, *(np.arange(6.0)[:, None] for _ in range(3)), control_dt=1e-3)
    team = Team([Member(), Member(), Member()], share=2)
    team.reset(joints, 6)
    assert seen == [(2, [0.0, 1.0]), (2, [2.0, 3.0]), (2, [4.0, 5.0])]
    signals = fo_gym.Signals.from_observation(np.arange(6.0)[:, None] + np.zeros(9), 1)
    assert team.estimate(signals).ravel().tolist() == list(range(6))


class Watching(Processes):
    """Workers that note who comes together."""

    def __init__(self, jobs: int) -> None:
        super().__init__(jobs)
        self.crews: list[int] = []

    def run(self, function: Callable[..., Any], tasks: Sequence[Task]) -> Iterator[tuple[int, Any]]:
        if function is trials_together:
            self.crews += [len(task[1]) for task in tasks]
        for place, task in enumerate(tasks):
            yield place, function(*task)


@pytest.mark.parametrize(("seeds", "jobs", "crews"), [(1, 1, [5]), (1, 2, [3, 2]), (80, 1, [2, 2, 1])])
def test_crews_are_as_large_as_a_fair_share_and_as_is_not_too_much_to_lose(seeds, jobs, crews) -> None:
    plan = Plan(
        Grid("pid-high", {"L": list(np.linspace(50.0, 60.0, 5))}),
        [EpisodeSet(STICTION, "randomized", tuple(range(seeds)), {"duration": 0.01})],
    )
    backend = Watching(jobs)
    run_contests(plan.contests, "", backend=backend)
    assert backend.crews == crews


def test_a_batch_is_not_larger_than_memory_allows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows and times are each member's own, whoever shares its batch."""
    episodes = EpisodeSet(STICTION, "randomized", (1, 2), {"duration": 0.05})
    competitors = [competitor_of(name) for name in ("pid-high", "pid-low", "pd-high", "letien-high")]
    references, _ = reference_trials(episodes)
    batches: list[int] = []
    record = EpisodeSet.record
    monkeypatch.setattr(EpisodeSet, "record", lambda *who: batches.append(len(who[0].seeds)) or record(*who))
    found = [trials_together(episodes, competitors, references)]
    monkeypatch.setattr(trial, "_MEMORY", 2 * 8 * trial._ARRAYS * 51 * 2)
    found.append(trials_together(episodes, competitors, references))
    assert batches == [6, 2, 4, 2, 2]
    for one, other in zip(*found, strict=True):
        pd.testing.assert_frame_equal(one.rows, other.rows, check_exact=True)
        assert one.timing is not None
        assert 0.0 < one.timing["estimate_median_us"] <= one.timing["estimate_p99_us"]
