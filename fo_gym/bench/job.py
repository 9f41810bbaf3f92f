"""Where the time of a whole leaderboard goes, as it runs: the small protocol in one process, nothing stored."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from fo_gym.bench.measurement import JOB, Measurement, Tables
from fo_gym.bench.size import Size
from fo_gym.compensators import Compensator
from fo_gym.evaluation.episode.recording import Recording
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.results.report import write_results
from fo_gym.evaluation.runs.backends import Task
from fo_gym.evaluation.runs.contest import contests_in
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.protocol import Protocol, load_protocol
from fo_gym.evaluation.runs.run import run_contests
from fo_gym.evaluation.runs.trial import reference_trials

T = TypeVar("T")

REFERENCES, SIMULATION, COMPENSATORS = "references", "simulation", "compensators"
METRICS, STATISTICS, PAGES = "metrics", "statistics", "tables and figures"
"""Parts of a job; that of the references is all of theirs."""

__all__ = ["COMPENSATORS", "METRICS", "PAGES", "REFERENCES", "SIMULATION", "STATISTICS", "jobs", "parts_of_job"]


@dataclass
class _Clock:
    """Seconds of records, and of the calls of `estimate` in them."""

    records: float = 0.0
    estimates: float = 0.0


@dataclass(frozen=True)
class _Watched(EpisodeSet):
    """Episodes whose records are timed."""

    clock: _Clock = field(default_factory=_Clock)

    def record(self, compensator: Compensator, name: str) -> Recording:
        """See `EpisodeSet`."""
        start = time.perf_counter()
        recording = super().record(compensator, name)
        self.clock.records += time.perf_counter() - start
        self.clock.estimates += float(recording.seconds.sum())
        return recording


class _Watch:
    """This process, as who does the work; it keeps the time of every function, and of the records in it."""

    workers = 1

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.clocks: dict[str, _Clock] = {}

    def run(self, function: Callable[..., T], tasks: Sequence[Task]) -> Iterator[tuple[int, T | None]]:
        """See `Backend`."""
        clock = self.clocks.setdefault(function.__name__, _Clock())
        for place, (episodes, *rest) in enumerate(tasks):
            parts: dict[str, Any] = {each.name: getattr(episodes, each.name) for each in fields(EpisodeSet)}
            start = time.perf_counter()
            result = function(_Watched(**parts, clock=clock), *rest)
            taken = time.perf_counter() - start
            self.seconds[function.__name__] = self.seconds.get(function.__name__, 0.0) + taken
            yield place, result


def parts_of_job(protocol: Protocol) -> dict[str, float]:
    """Seconds of every part of a protocol."""
    watch = _Watch()
    results = run_contests(contests_in(protocol), protocol.stamp, backend=watch)
    start = time.perf_counter()
    leaderboard(results.episodes)
    statistics = time.perf_counter() - start
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        write_results(protocol, results, Path(folder))  # the statistics once more
        pages = time.perf_counter() - start - statistics
    references = watch.seconds.pop(reference_trials.__name__)
    watch.clocks.pop(reference_trials.__name__)
    records = sum(clock.records for clock in watch.clocks.values())
    estimates = sum(clock.estimates for clock in watch.clocks.values())
    return {
        REFERENCES: references,
        SIMULATION: records - estimates,
        COMPENSATORS: estimates,
        METRICS: sum(watch.seconds.values()) - records,
        STATISTICS: statistics,
        PAGES: max(0.0, pages),
    }


def _measured(protocol: Protocol) -> Tables:
    parts = parts_of_job(protocol)
    whole = sum(parts.values())
    return {JOB: [{"part": part, "seconds": taken, "share": taken / whole} for part, taken in parts.items()]}


def jobs(env_ids: Sequence[str], size: Size) -> list[Measurement]:
    """The job of the small protocol's environments among those given; none where it has none of them."""
    small = load_protocol("quick")
    environments = tuple(env_id for env_id in small.environments if env_id in env_ids)[: size.job_envs]
    if not environments:
        return []
    compensators = small.compensators[: size.competitors]
    protocol = replace(small, environments=environments, variants=size.variants, compensators=compensators)
    return [Measurement("a whole job, by its parts", partial(_measured, protocol))]
