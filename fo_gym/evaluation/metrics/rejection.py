"""Friction rejection: how much of what friction does to the motion a compensator undoes."""

from __future__ import annotations

import math

import numpy as np

from fo_gym.evaluation.episode.record import Array, Episode
from fo_gym.evaluation.metrics.registry import Tolerance, metric

_NO_EFFECT = 1e-9
"""RMS effect of friction on the motion, m or rad, below which there is nothing to reject."""


@metric("frr", unit="1", better="higher", tolerance=Tolerance(1e-6, 4e-4))
def friction_rejection_ratio(episode: Episode) -> float:
    """Friction rejection ratio: 1 as if there were no friction, 0 useless, below 0 harmful.

        FRR = 1 - RMS |y - y_ideal| / RMS |y_none - y_ideal|

    y is `Motion.scored` (theta of all joints together, or the tool's position), |.| the Euclidean norm over
    its components, RMS over all ticks. `ideal` is the same episode without friction, `none` the same without
    compensation. NaN where friction changes the motion by less than 1e-9 (RMS, m or rad). Defined for episodes
    that ended early too: their arrays hold the last finite value.
    """
    ideal = episode.ideal.scored
    effect = _rms_distance(episode.none.scored, ideal)
    if effect < _NO_EFFECT:
        return math.nan
    return 1.0 - _rms_distance(episode.motion.scored, ideal) / effect


def _rms_distance(one: Array, other: Array) -> float:
    """RMS over ticks of the Euclidean distance between two signals (ticks, size)."""
    return float(np.sqrt(np.mean(np.sum(np.square(one - other), axis=1))))
