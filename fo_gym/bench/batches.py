"""Batches and single environments beside MuJoCo, threads beside one, and throughput beside other vectors."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from fo_gym.bench.bars import (
    ASYNC,
    BATCH,
    FORWARD,
    ONE_THREAD,
    SINGLE,
    SUBPROC,
    SYNC,
    THREADS,
    THROUGHPUT,
    TWIN,
)
from fo_gym.bench.measurement import Comparison, Measurement
from fo_gym.bench.size import Size
from fo_gym.bench.subjects import one_beside_mujoco, some_beside_mujoco, threads_beside_one
from fo_gym.bench.vectors import gymnasium_async, gymnasium_sync, many_beside_peer, sb3_subproc

_VECTORS = {SYNC: gymnasium_sync, ASYNC: gymnasium_async, SUBPROC: sb3_subproc}

__all__ = ["batches"]


def _of(env_id: str, size: Size) -> list[Comparison]:
    n, many = size.num_envs, size.many
    counts = sorted({n, *size.other_envs})
    return [
        *(
            Comparison(env_id, BATCH, count, (TWIN, FORWARD), partial(some_beside_mujoco, env_id, count))
            for count in counts
        ),
        Comparison(env_id, SINGLE, 1, (TWIN,), partial(one_beside_mujoco, env_id)),
        Comparison(env_id, THREADS, n, (ONE_THREAD,), partial(threads_beside_one, env_id, n, size.num_threads)),
        # One each, so that the processes of one do not wait in memory beside those of another.
        *(
            Comparison(env_id, THROUGHPUT, many, (name,), partial(many_beside_peer, env_id, many, make))
            for name, make in _VECTORS.items()
        ),
    ]


def batches(env_ids: Sequence[str], size: Size) -> list[Measurement]:
    """Those of every environment."""
    return [each.measurement(size) for env_id in env_ids for each in _of(env_id, size)]
