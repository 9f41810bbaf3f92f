"""From signals to one number: over time, then over joints."""

from __future__ import annotations

import numpy as np

from fo_gym.evaluation.episode.record import Array

REST = 1.0
"""Length of the window over which an error at rest is averaged, s."""


def rms(signal: Array) -> Array:
    """Root mean square over time, (samples, ...) -> (...)."""
    root: Array = np.sqrt(np.mean(np.square(signal), axis=0))
    return root


def largest(per_joint: Array) -> float:
    """Largest of the values (dof,) that are not NaN; NaN if none is."""
    return float(np.fmax.reduce(per_joint, initial=np.nan))


def smallest(per_joint: Array) -> float:
    """Smallest of the values (dof,) that are not NaN; NaN if none is."""
    return float(np.fmin.reduce(per_joint, initial=np.nan))
