"""Memory of many environments, each batch alone in a fresh process."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
from mujoco.batch import Batch

from fo_gym.bench.bars import NOT_MEASURED, REGULATION, SQUARE, STICTION
from fo_gym.bench.measurement import MEMORY, Measurement, Row, Tables
from fo_gym.bench.size import Size
from fo_gym.bench.subjects import TWIN_TIMESTEP

_STATM = Path("/proc/self/statm")

__all__ = ["batch_of", "growths_of_resident_set", "memories", "twins_of"]


def batch_of(env_id: str, num_envs: int) -> Any:
    """A batch of environments that has been stepped."""
    envs = gym.make_vec(env_id, num_envs=num_envs)
    envs.reset(seed=0)
    envs.step(np.zeros(envs.action_space.shape))
    return envs


def twins_of(env_id: str, num_envs: int) -> Any:
    """As many twins, in a batch of MuJoCo's, that have been stepped."""
    simulation = gym.make(env_id).unwrapped.simulation  # type: ignore[attr-defined]
    model, _ = simulation.plant.to_mujoco(timestep=TWIN_TIMESTEP, scene=False)
    batch = Batch(model, num_envs, nthread=1)
    batch.step(nstep=1)
    return batch


def _resident() -> int:
    """What of this process is in memory [bytes]."""
    return int(_STATM.read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE")


def growths_of_resident_set(makers: Sequence[Callable[[str, int], Any]], env_id: str, more: int) -> list[int]:
    """By how much this process grows from one environment to `more` beyond it, of every maker in turn [bytes].

    Nothing is let go in between, so that nobody gets the memory of who came before.
    """
    kept, grown = [], []
    for make in makers:
        kept.append(make(env_id, 1))
        before = _resident()
        kept.append(make(env_id, 1 + more))
        grown.append(_resident() - before)
    return grown


def _measured(env_id: str, more: int) -> Tables:
    row: Row = {"env": env_id, "ours_mb": np.nan, "twin_mb": np.nan}
    if not _STATM.exists():
        return {MEMORY: [row | {"note": f"{NOT_MEASURED}: this system has no {_STATM}"}]}
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as fresh:
        grown = fresh.submit(growths_of_resident_set, (batch_of, twins_of), env_id, more).result()
    ours, twin = (each / 1e6 * 1000 / more for each in grown)
    return {MEMORY: [row | {"ours_mb": ours, "twin_mb": twin, "note": f"from 1 to {1 + more} environments"}]}


def memories(env_ids: Sequence[str], size: Size) -> list[Measurement]:
    """Those of the environments that stand for a kind of plant, and of their twins."""
    kinds = (env_id for env_id in (STICTION, REGULATION, SQUARE) if env_id in env_ids)
    return [Measurement(f"{env_id}, {MEMORY}", partial(_measured, env_id, size.memory_envs)) for env_id in kinds]
