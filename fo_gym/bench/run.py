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
from fo_gym.bench.measure import Array, Subject, interleaved, spread
from fo_gym.bench.subjects import (
    gymnasium_async,
    gymnasium_sync,
    many_beside_peer,
    one_beside_mujoco,
    sb3_subproc,
    some_beside_mujoco,
)
from fo_gym.checks import shown
from fo_gym.evaluation.runs.provenance import versions
from fo_gym.extras import install_command

BATCH, SINGLE, THROUGHPUT = "batch", "single", "throughput"
"""What is measured: the time of a batch's step, of one environment's step; steps per second of many environments."""

TWIN, FORWARD = "MuJoCo twin", "MuJoCo forward"
SYNC, ASYNC, SUBPROC = "Gymnasium sync", "Gymnasium async", "SB3 SubprocVecEnv"
"""Peers."""

_STICTION, _REGULATION = "FJRStiction-v0", "FJRRegulation-v0"

BARS = {
    (_STICTION, BATCH, TWIN, 256): 0.25,
    (_REGULATION, BATCH, TWIN, 256): 0.40,
    (_STICTION, SINGLE, TWIN, 1): 2.0,
    (_REGULATION, SINGLE, TWIN, 1): 1.25,
    (_STICTION, THROUGHPUT, ASYNC, 64): 8.0,
    (_REGULATION, THROUGHPUT, ASYNC, 64): 4.0,
    (_STICTION, THROUGHPUT, SUBPROC, 64): 8.0,
    (_REGULATION, THROUGHPUT, SUBPROC, 64): 4.0,
}
"""What is promised on a machine of two cores, by environment, measurement, peer and number of environments.

The most that a ratio of times may be, the least that a ratio of throughputs may be.
"""

HOLDS, MISSES, NOT_MEASURED = "holds", "misses", "not measured"
"""Verdicts; the last one with its reason."""

__all__ = [
    "ASYNC",
    "BARS",
    "BATCH",
    "FORWARD",
    "FULL",
    "HOLDS",
    "MISSES",
    "NOT_MEASURED",
    "QUICK",
    "SINGLE",
    "SUBPROC",
    "SYNC",
    "THROUGHPUT",
    "TWIN",
    "Size",
    "bench",
    "check_envs",
    "count",
    "verdict",
]


@dataclass(frozen=True)
class Size:
    """How much is measured.

    Attributes:
        num_envs: environments of the batch.
        many: environments whose throughput is measured; as many processes in those peers that need them.
        repeats: rounds, in each of which everybody has a slice.
        slice_seconds: length of a slice [s].
    """

    num_envs: int = 256
    many: int = 64
    repeats: int = 15
    slice_seconds: float = 0.15


FULL = Size()
"""What the bars are about."""

QUICK = Size(num_envs=16, many=2, repeats=3, slice_seconds=0.01)
"""Enough to see that everything runs."""


@dataclass(frozen=True)
class _Group:
    """What is timed by turns: ours, and its peers.

    Attributes:
        measured: BATCH, SINGLE or THROUGHPUT.
        num_envs: of ours and of each peer.
        peers: their names.
        open: from an environment's id to what is timed, ours first, then the peers.
    """

    measured: str
    num_envs: int
    peers: tuple[str, ...]
    open: Callable[[str], AbstractContextManager[list[Subject]]]


def _groups(size: Size) -> list[_Group]:
    makers = {SYNC: gymnasium_sync, ASYNC: gymnasium_async, SUBPROC: sb3_subproc}
    return [
        _Group(BATCH, size.num_envs, (TWIN, FORWARD), partial(some_beside_mujoco, num_envs=size.num_envs)),
        _Group(SINGLE, 1, (TWIN,), one_beside_mujoco),
        # One group for each of these, so that the processes of one do not wait in memory beside those of another.
        *(
            _Group(THROUGHPUT, size.many, (name,), partial(many_beside_peer, num_envs=size.many, make_peer=maker))
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


def verdict(measured: str, ratio: float, bar: float) -> str:
    """Whether a ratio keeps its bar; "" where there is none, NaN."""
    if np.isnan(bar):
        return ""
    kept = ratio >= bar if measured == THROUGHPUT else ratio <= bar
    return HOLDS if kept else MISSES


def _row(env_id: str, group: _Group, peer: str, ours: Array, theirs: Array) -> dict[str, object]:
    """One row from seconds per call in every round, (repeats,) each."""
    ratio = spread(theirs / ours if group.measured == THROUGHPUT else ours / theirs)
    bar = BARS.get((env_id, group.measured, peer, group.num_envs), np.nan)
    microseconds = 1e6 / group.num_envs
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
        "ours_us": microseconds * spread(ours).median,
        "peer_us": microseconds * spread(theirs).median,
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
