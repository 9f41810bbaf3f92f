"""What the benchmark of speed measures, beside whom, and what is promised."""

from __future__ import annotations

import numpy as np

BATCH, SINGLE, THREADS, GROWTH, THROUGHPUT = "batch", "single", "threads", "growth", "throughput"
"""What is measured: the time of a batch's step, of one environment's step; how many times faster a batch's step is on
more threads; the power of the number of environments with which its time grows; steps per second of many environments.
"""

TWIN, FORWARD = "MuJoCo twin", "MuJoCo forward"
ONE_THREAD, FEW = "one thread", "fewer environments"
SYNC, ASYNC, SUBPROC = "Gymnasium sync", "Gymnasium async", "SB3 SubprocVecEnv"
"""Peers."""

_STICTION, _REGULATION, _SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"

BARS = {
    (_STICTION, BATCH, TWIN, 256): 0.12,
    (_REGULATION, BATCH, TWIN, 256): 0.09,
    (_SQUARE, BATCH, TWIN, 256): 0.16,
    (_STICTION, BATCH, FORWARD, 256): 1.6,
    (_REGULATION, BATCH, FORWARD, 256): 1.9,
    (_SQUARE, BATCH, FORWARD, 256): 3.2,
    (_STICTION, SINGLE, TWIN, 1): 1.0,
    (_REGULATION, SINGLE, TWIN, 1): 0.5,
    (_SQUARE, SINGLE, TWIN, 1): 0.9,
    (_STICTION, THREADS, ONE_THREAD, 256): 1.7,
    (_REGULATION, THREADS, ONE_THREAD, 256): 1.8,
    (_SQUARE, THREADS, ONE_THREAD, 256): 1.8,
    **{(env_id, GROWTH, FEW, 1024): 1.02 for env_id in (_STICTION, _REGULATION, _SQUARE)},
    (_STICTION, THROUGHPUT, ASYNC, 64): 8.0,
    (_REGULATION, THROUGHPUT, ASYNC, 64): 4.0,
    (_STICTION, THROUGHPUT, SUBPROC, 64): 8.0,
    (_REGULATION, THROUGHPUT, SUBPROC, 64): 4.0,
}
"""What is promised on a machine of two cores, by environment, measurement, peer and number of environments.

The most that a ratio of times or a power may be, the least that a ratio of throughputs or of threads may be.
"""

MORE_IS_BETTER = (THROUGHPUT, THREADS)
"""Of what is measured."""

HOLDS, MISSES, NOT_MEASURED = "holds", "misses", "not measured"
"""Verdicts; the last one with its reason."""

__all__ = [
    "ASYNC",
    "BARS",
    "BATCH",
    "FEW",
    "FORWARD",
    "GROWTH",
    "HOLDS",
    "MISSES",
    "MORE_IS_BETTER",
    "NOT_MEASURED",
    "ONE_THREAD",
    "SINGLE",
    "SUBPROC",
    "SYNC",
    "THREADS",
    "THROUGHPUT",
    "TWIN",
    "verdict",
]


def verdict(measured: str, ratio: float, bar: float) -> str:
    """Whether a ratio keeps its bar; "" where there is none, NaN."""
    if np.isnan(bar):
        return ""
    kept = ratio >= bar if measured in MORE_IS_BETTER else ratio <= bar
    return HOLDS if kept else MISSES
