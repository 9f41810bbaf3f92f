"""The first-order low-pass of a sensor, sampled at the control rate."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["weight"]


def weight(cutoff: float | Array, dt: float) -> Array:
    """Share of the new value that a low-pass at `cutoff` [rad/s] takes over per period [s], per joint or for all."""
    return _weight(cutoff, dt) if isinstance(cutoff, float) else _exact(cutoff, dt)


def _exact(cutoff: float | Array, dt: float) -> Array:
    return np.asarray(-np.expm1(-np.asarray(cutoff, dtype=np.float64) * dt))


_weight = lru_cache(maxsize=64)(_exact)
