"""How times grow: with environments, joints, threads and the length of episodes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fo_gym.bench.bars import CORES, ENVS, GROWTH, JOINTS, LENGTH, REGULATION, STICTION, growth_from
from fo_gym.bench.chains import chain
from fo_gym.bench.measure import Array, Subject, interleaved, spread
from fo_gym.bench.measurement import GROWTHS, RATIOS, Measurement, Row, Tables, ratio_row
from fo_gym.bench.size import Size
from fo_gym.bench.subjects import batch
from fo_gym.bench.yardsticks import OBSERVER
from fo_gym.evaluation.runs.evaluate import evaluate

_PERIODS_PER_SECOND = 1000
_EPISODE_ROUNDS = 3  # an evaluation takes seconds

__all__ = ["Growth", "batches_of", "chains_of", "episodes_of", "growths", "power", "threads_of"]


@dataclass(frozen=True)
class Growth:
    """Something that is timed by turns at several sizes of one kind.

    Attributes:
        env_id: environment.
        over: what grows, see `fo_gym.bench.bars`.
        points: its sizes, rising.
        counts: what a call at each size counts as, in environments and control periods.
        starts: points from which on a power is told, each in a row of its own.
        num_envs: at the last point.
        open: gives what is timed, one for each point.
    """

    env_id: str
    over: str
    points: tuple[float, ...]
    counts: tuple[int, ...]
    starts: tuple[float, ...]
    num_envs: int
    open: Callable[[], AbstractContextManager[list[Subject]]]

    def tables(self, size: Size) -> Tables:
        """A row of ratios per start, and a row of times per point."""
        with self.open() as subjects:
            times = interleaved(subjects, size.repeats, size.slice_seconds)
        return {RATIOS: [self._row(start, times) for start in self.starts], GROWTHS: self._times(times)}

    def _row(self, start: float, times: Array) -> Row:
        first = self.points.index(start)
        each = times / np.array(self.counts)
        powers = power(np.array(self.points[first:]), times[:, first:])
        name = growth_from(self.over, start, self.points[-1])
        last, early = each[:, -1], each[:, first]
        return ratio_row(self.env_id, GROWTH, name, self.num_envs, powers, ours=last, theirs=early)

    def _times(self, times: Array) -> list[Row]:
        spreads = [spread(1e3 * column) for column in times.T]
        return [
            {"env": self.env_id, "over": self.over, "size": point, "ms": ms.median, "q1": ms.q1, "q3": ms.q3}
            for point, ms in zip(self.points, spreads, strict=True)
        ]

    def measurement(self, size: Size) -> Measurement:
        """To be made at this size."""
        return Measurement(f"{self.env_id}, {GROWTH} over {self.over}", partial(self.tables, size))


def power(points: Array, times: Array) -> Array:
    """Slope of log(time) over log(size) in every round, by least squares, (repeats,).

    Args:
        points: sizes, (n,), two at least.
        times: (repeats, n).
    """
    return np.asarray(np.polyfit(np.log(points), np.log(times).T, 1)[0])


@contextmanager
def batches_of(env_id: str, counts: Sequence[int]) -> Iterator[list[Subject]]:
    """A control period of batches of several sizes."""
    with ExitStack() as stack:
        yield [stack.enter_context(batch(env_id, count))[0] for count in counts]


@contextmanager
def chains_of(env_id: str, joints: Sequence[int], num_envs: int) -> Iterator[list[Subject]]:
    """A control period of `num_envs` arms of several numbers of joints."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory()))
        robots = [chain(count, folder) for count in joints]
        yield [stack.enter_context(batch(env_id, num_envs, robot=robot))[0] for robot in robots]


@contextmanager
def threads_of(env_id: str, threads: Sequence[int], num_envs: int) -> Iterator[list[Subject]]:
    """A control period of `num_envs` environments on several numbers of threads."""
    with ExitStack() as stack:
        yield [stack.enter_context(batch(env_id, num_envs, count))[0] for count in threads]


@contextmanager
def episodes_of(env_id: str, lengths: Sequence[float]) -> Iterator[list[Subject]]:
    """The evaluation of an observer on one episode of several lengths [s]: its references, records and metrics too."""
    yield [
        Subject(call=partial(evaluate, OBSERVER, env_id, duration=length), prepare=lambda: None) for length in lengths
    ]


def _of(env_id: str, size: Size) -> Iterator[Growth]:
    n, envs, threads = size.num_envs, size.batches, size.threads
    yield Growth(env_id, ENVS, envs, envs, (size.batches_from,), envs[-1], partial(batches_of, env_id, envs))
    counts = (n,) * len(threads)
    yield Growth(env_id, CORES, threads, counts, threads[:1], n, partial(threads_of, env_id, threads, n))
    if env_id == REGULATION:
        joints, opener = size.joints, partial(chains_of, env_id, size.joints, n)
        yield Growth(env_id, JOINTS, joints, (n,) * len(joints), size.joints_from, n, opener)


def growths(env_ids: Sequence[str], size: Size) -> list[Measurement]:
    """Those over environments and threads of all, over joints of the arm, over the length of episodes of the link."""
    made = [each.measurement(size) for env_id in env_ids for each in _of(env_id, size)]
    if STICTION in env_ids:
        lengths = size.lengths
        counts = tuple(round(_PERIODS_PER_SECOND * length) for length in lengths)
        opener = partial(episodes_of, STICTION, lengths)
        episodes = Growth(STICTION, LENGTH, lengths, counts, lengths[:1], 1, opener)
        made.append(episodes.measurement(replace(size, repeats=min(size.repeats, _EPISODE_ROUNDS))))
    return made
