"""Measure every environment beside its peers, and whole jobs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.metadata import PackageNotFoundError, version

import pandas as pd

from fo_gym import ENVIRONMENTS
from fo_gym.bench.accuracy import accuracies
from fo_gym.bench.batches import batches
from fo_gym.bench.growth import growths
from fo_gym.bench.job import jobs
from fo_gym.bench.measurement import GROWTHS, JOB, MEMORY, PRECISION, RATIOS, Measurement, Tables
from fo_gym.bench.memory import memories
from fo_gym.bench.size import Size
from fo_gym.bench.yardsticks import yardsticks
from fo_gym.checks import shown
from fo_gym.evaluation.runs.provenance import versions

_KINDS = (batches, accuracies, growths, yardsticks, memories, jobs)

__all__ = ["bench", "check_envs", "measurements"]


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


def measurements(env_ids: Sequence[str], size: Size) -> list[Measurement]:
    """Everything that is measured of these environments, see `check_envs`."""
    return [each for kind in _KINDS for each in kind(env_ids, size)]


def _versions() -> dict[str, str]:
    """Columns `version_*`, those of peers included; "" where one is not installed."""
    peers = {}
    for name in ("pin", "stable-baselines3"):
        try:
            peers[f"version_{name.replace('-', '_')}"] = version(name)
        except PackageNotFoundError:
            peers[f"version_{name.replace('-', '_')}"] = ""
    return {**versions(), **peers}


def bench(chosen: Sequence[Measurement], *, told: Callable[[str], None]) -> dict[str, pd.DataFrame]:
    """Measure.

    Args:
        chosen: see `measurements`.
        told: called with a label whenever something has been measured.

    Returns:
        Tables by name. "bench" has one row per environment, measurement and peer. `ratio` is the median over the
        rounds, `q1` and `q3` its quartiles; `fo_gym.bench.report` says of what. `ours_us` and `peer_us` are
        microseconds per environment and control period. What was not measured is NaN and says why in `verdict`.
        "growth" has the times whose powers are told [ms], "precision" the errors that make accuracy equal, "memory"
        MB per 1000 environments, "job" the seconds of every part of a leaderboard.
    """
    rows: Tables = {name: [] for name in (RATIOS, GROWTHS, PRECISION, MEMORY, JOB)}
    for each in chosen:
        for name, found in each.run().items():
            rows[name] += found
        told(each.label)
    tables = {name: pd.DataFrame(found) for name, found in rows.items()}
    return {**tables, RATIOS: tables[RATIOS].assign(**_versions())}
