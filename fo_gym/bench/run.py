"""Measure every environment beside its peers; one row per environment, kind of measurement and peer."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from importlib.metadata import PackageNotFoundError, version

import numpy as np
import pandas as pd

from fo_gym import ENVIRONMENTS
from fo_gym.bench.bars import (
    ASYNC,
    BARS,
    BATCH,
    FEW,
    FORWARD,
    GROWTH,
    MORE_IS_BETTER,
    NOT_MEASURED,
    ONE_THREAD,
    SINGLE,
    SUBPROC,
    SYNC,
    THREADS,
    THROUGHPUT,
    TWIN,
    verdict,
)
from fo_gym.bench.measure import Array, Subject, interleaved, spread
from fo_gym.bench.subjects import (
    gymnasium_async,
    gymnasium_sync,
    many_beside_few,
    many_beside_peer,
    one_beside_mujoco,
    sb3_subproc,
    some_beside_mujoco,
    threads_beside_one,
)
from fo_gym.checks import shown
from fo_gym.evaluation.runs.provenance import versions
from fo_gym.extras import install_command

__all__ = ["FULL", "QUICK", "Size", "bench", "check_envs", "count"]


@dataclass(frozen=True)
class Size:
    """How much is measured.

    Attributes:
        num_envs: environments of the batch.
        num_threads: of the threads' row.
        few, most: environments between which the growth is measured.
        many: environments whose throughput is measured; as many processes in those peers that need them.
        repeats: rounds, in each of which everybody has a slice.
        slice_seconds: length of a slice [s].
    """

    num_envs: int = 256
    num_threads: int = 2
    few: int = 64
    most: int = 1024
    many: int = 64
    repeats: int = 15
    slice_seconds: float = 0.15


FULL = Size()
"""What the bars are about."""

QUICK = Size(num_envs=16, few=4, most=16, many=2, repeats=3, slice_seconds=0.01)
"""Enough to see that everything runs."""


@dataclass(frozen=True)
class _Group:
    """What is timed by turns: ours, and its peers.

    Attributes:
        measured: BATCH, SINGLE, THREADS, GROWTH or THROUGHPUT.
        num_envs, peer_envs: of ours, and of each peer.
        peers: their names.
        open: from an environment's id to what is timed, ours first, then the peers.
    """

    measured: str
    num_envs: int
    peer_envs: int
    peers: tuple[str, ...]
    open: Callable[[str], AbstractContextManager[list[Subject]]]

    def ratio(self, ours: Array, theirs: Array) -> Array:
        """What the row tells of the seconds per call in every round, (repeats,) each."""
        if self.measured == GROWTH:
            return np.asarray(np.log(ours / theirs) / np.log(self.num_envs / self.peer_envs))
        return np.asarray(theirs / ours if self.measured in MORE_IS_BETTER else ours / theirs)


def _groups(size: Size) -> list[_Group]:
    makers = {SYNC: gymnasium_sync, ASYNC: gymnasium_async, SUBPROC: sb3_subproc}
    n, many = size.num_envs, size.many
    threads = partial(threads_beside_one, num_envs=n, num_threads=size.num_threads)
    return [
        _Group(BATCH, n, n, (TWIN, FORWARD), partial(some_beside_mujoco, num_envs=n)),
        _Group(SINGLE, 1, 1, (TWIN,), one_beside_mujoco),
        _Group(THREADS, n, n, (ONE_THREAD,), threads),
        _Group(GROWTH, size.most, size.few, (FEW,), partial(many_beside_few, many=size.most, few=size.few)),
        # One group for each of these, so that the processes of one do not wait in memory beside those of another.
        *(
            _Group(THROUGHPUT, many, many, (name,), partial(many_beside_peer, num_envs=many, make_peer=maker))
            for name, maker in makers.items()
        ),
    ]


def check_envs(env_ids: Sequence[str]) -> None:
    """Refuse what is not one of ours.

    Raises:
        ValueError: an environment is not of `fo_gym.ENVIRONMENTS`, or is there twice.
    """
    if len(set(env_ids)) < len(env_ids):
        raise ValueError(f"env is {shown(env_ids)}; name each environment once")
    for env_id in env_ids:
        if env_id not in ENVIRONMENTS:
            raise ValueError(f"env is {env_id!r}; allowed are {', '.join(map(repr, ENVIRONMENTS))}")


def count(env_ids: Iterable[str], size: Size) -> int:
    """How many groups `bench` measures."""
    return len(list(env_ids)) * len(_groups(size))


def _row(env_id: str, group: _Group, peer: str, ours: Array, theirs: Array) -> dict[str, object]:
    """One row from seconds per call in every round, (repeats,) each."""
    ratio = spread(group.ratio(ours, theirs))
    bar = BARS.get((env_id, group.measured, peer, group.num_envs), np.nan)
    return {
        "env": env_id,
        "measured": group.measured,
        "beside": peer,
        "num_envs": group.num_envs,
        "ratio": ratio.median,
        "q1": ratio.q1,
        "q3": ratio.q3,
        "bar": bar,
        "verdict": verdict(group.measured, ratio.median, bar),
        "ours_us": 1e6 / group.num_envs * spread(ours).median,
        "peer_us": 1e6 / group.peer_envs * spread(theirs).median,
    }


def _rows(env_id: str, group: _Group, size: Size) -> list[dict[str, object]]:
    try:
        with group.open(env_id) as subjects:
            ours, *theirs = interleaved(subjects, size.repeats, size.slice_seconds).T
    except ModuleNotFoundError as error:  # Stable-Baselines3 is heavy, and nothing else here needs it
        nothing = np.full(1, np.nan)
        reason = f"{NOT_MEASURED}: {error}; install it with: {install_command('rl')}"
        return [_row(env_id, group, peer, nothing, nothing) | {"verdict": reason} for peer in group.peers]
    return [_row(env_id, group, peer, ours, times) for peer, times in zip(group.peers, theirs, strict=True)]


def _versions() -> dict[str, str]:
    """Columns `version_*`, that of Stable-Baselines3 included; "" where it is not installed."""
    try:
        sb3 = version("stable-baselines3")
    except PackageNotFoundError:
        sb3 = ""
    return {**versions(), "version_stable_baselines3": sb3}


def bench(env_ids: Iterable[str], size: Size, *, on_group: Callable[[str], None]) -> pd.DataFrame:
    """Measure the environments beside their peers.

    Args:
        env_ids: of `fo_gym.ENVIRONMENTS`.
        size: how much is measured.
        on_group: called with a label whenever a group has been measured.

    Returns:
        One row per environment, measurement and peer. `ratio` is the median over the rounds, `q1` and `q3` its
        quartiles: our time over the peer's, or our throughput over the peer's. `ours_us` and `peer_us` are
        microseconds per environment and control period. What was not measured is NaN and says why in `verdict`.

    Raises:
        ValueError: an environment is not one of ours.
    """
    env_ids = tuple(env_ids)
    check_envs(env_ids)
    rows = []
    for env_id in env_ids:
        for group in _groups(size):
            rows += _rows(env_id, group, size)
            on_group(f"{env_id}, {group.measured}, beside {', '.join(group.peers)}")
    return pd.DataFrame(rows).assign(**_versions())
