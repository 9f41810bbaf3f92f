"""What the benchmark of speed measures, beside whom, and what is promised."""

from __future__ import annotations

import numpy as np

BATCH, SINGLE, THREADS, GROWTH, THROUGHPUT = "batch", "single", "threads", "growth", "throughput"
ACCURACY, COMPENSATOR, YARDSTICK = "equal accuracy", "compensator", "yardstick"
"""What is measured; `fo_gym.bench.report` says of each what its numbers are."""

TWIN, FORWARD = "MuJoCo twin", "MuJoCo forward"
ONE_THREAD, STEP = "one thread", "our step"
SYNC, ASYNC, SUBPROC = "Gymnasium sync", "Gymnasium async", "SB3 SubprocVecEnv"
LSODA, PUSHER = "SciPy LSODA", "Gymnasium Pusher-v5"
ENVS, JOINTS, CORES, LENGTH = "environments", "joints", "threads", "seconds"
"""Peers, and what a time grows with."""

INTEGRATORS = ("implicitfast", "euler", "rk4")
"""MuJoCo's ways to step the twin. Its `implicit` errs and costs as `implicitfast` does."""

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"
"""Environments that stand for a kind of plant: the link, the arm in joint space, the arm in task space."""


def twin_with(integrator: str) -> str:
    """Name of the twin as a peer, by its integrator."""
    return f"{TWIN}, {integrator}"


def growth_from(over: str, first: float, last: float) -> str:
    """Name of a growth by what it is over and from where to where its power is told."""
    return f"{over} {first:g} to {last:g}"


BARS = {
    (STICTION, BATCH, TWIN, 256): 0.12,
    (REGULATION, BATCH, TWIN, 256): 0.09,
    (SQUARE, BATCH, TWIN, 256): 0.16,
    (STICTION, BATCH, FORWARD, 256): 1.6,
    (REGULATION, BATCH, FORWARD, 256): 1.9,
    (SQUARE, BATCH, FORWARD, 256): 3.2,
    (STICTION, SINGLE, TWIN, 1): 1.0,
    (REGULATION, SINGLE, TWIN, 1): 0.5,
    (SQUARE, SINGLE, TWIN, 1): 0.9,
    (STICTION, THREADS, ONE_THREAD, 256): 1.7,
    (REGULATION, THREADS, ONE_THREAD, 256): 1.8,
    (SQUARE, THREADS, ONE_THREAD, 256): 1.8,
    **{(env_id, GROWTH, growth_from(ENVS, 64, 1024), 1024): 1.02 for env_id in (STICTION, REGULATION, SQUARE)},
    **{(REGULATION, GROWTH, growth_from(JOINTS, first, 14), 256): 1.0 for first in (1, 7)},
    **{(STICTION, ACCURACY, twin_with(integrator), 256): 100.0 for integrator in INTEGRATORS},
    **{(REGULATION, ACCURACY, twin_with(integrator), 256): 40.0 for integrator in INTEGRATORS},
    (STICTION, THROUGHPUT, ASYNC, 64): 8.0,
    (REGULATION, THROUGHPUT, ASYNC, 64): 4.0,
    (STICTION, THROUGHPUT, SUBPROC, 64): 8.0,
    (REGULATION, THROUGHPUT, SUBPROC, 64): 4.0,
}
"""What is promised on a machine of two cores, by environment, measurement, peer and number of environments.

The most that a ratio of times or a power may be, the least that a ratio of throughputs or of threads may be, or how
many times cheaper than the twin we are at least where both err alike.
"""

MORE_IS_BETTER = (THROUGHPUT, THREADS, ACCURACY)
"""Of what is measured."""

HOLDS, MISSES, NOT_MEASURED = "holds", "misses", "not measured"
"""Verdicts; the last one with its reason."""

__all__ = [
    "ACCURACY",
    "ASYNC",
    "BARS",
    "BATCH",
    "COMPENSATOR",
    "CORES",
    "ENVS",
    "FORWARD",
    "GROWTH",
    "HOLDS",
    "INTEGRATORS",
    "JOINTS",
    "LENGTH",
    "LSODA",
    "MISSES",
    "MORE_IS_BETTER",
    "NOT_MEASURED",
    "ONE_THREAD",
    "PUSHER",
    "REGULATION",
    "SINGLE",
    "SQUARE",
    "STEP",
    "STICTION",
    "SUBPROC",
    "SYNC",
    "THREADS",
    "THROUGHPUT",
    "TWIN",
    "YARDSTICK",
    "growth_from",
    "twin_with",
    "verdict",
]


def verdict(measured: str, ratio: float, bar: float) -> str:
    """Whether a ratio keeps its bar; "" where there is none, NaN."""
    if np.isnan(bar):
        return ""
    kept = ratio >= bar if measured in MORE_IS_BETTER else ratio <= bar
    return HOLDS if kept else MISSES
