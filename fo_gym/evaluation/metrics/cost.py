"""Cost: what a compensator asks of the motor."""

from __future__ import annotations

import math

import numpy as np

from fo_gym.evaluation.episode.record import Episode
from fo_gym.evaluation.metrics.reductions import largest, rms
from fo_gym.evaluation.metrics.registry import Tolerance, metric


@metric("control_effort_ratio", unit="1", better="lower", tolerance=Tolerance(1e-7, 2e-3))
def control_effort(episode: Episode) -> float:
    """RMS of the motor torque as a fraction of its limit, worst joint.

    RMS(tau_m) / torque_limit over all periods, tau_m as applied (controller, gravity and compensation).
    """
    return largest(rms(episode.tau_m) / episode.torque_limit)


@metric("torque_roughness_ratio", unit="1", better="lower", tolerance=Tolerance(1e-6, 5e-4))
def torque_roughness(episode: Episode) -> float:
    """RMS change of the motor torque from one period to the next as a fraction of its limit, worst joint.

    RMS(tau_m[k+1] - tau_m[k]) / torque_limit over all neighbouring periods. It depends on the length of a
    period: compare only episodes with the same one. NaN with fewer than two periods.
    """
    if len(episode.tau_m) < 2:
        return math.nan
    return largest(rms(np.diff(episode.tau_m, axis=0)) / episode.torque_limit)
