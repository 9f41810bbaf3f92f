"""The estimate: how close tau_f_hat is to what disturbs the motors, and how late."""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import correlate

from fo_gym.evaluation.episode.record import Array, Episode
from fo_gym.evaluation.metrics.reductions import largest, rms
from fo_gym.evaluation.metrics.registry import Tolerance, metric

_NOTHING = 1e-9
"""RMS disturbance torque, N or N m, below which there is nothing to estimate."""

_LONGEST_LAG = 0.5
"""Lags are looked for up to this, s, of both signs."""

_FLAT = 1e-12
"""Curvature of the correlation coefficient per tick^2 below which it has no peak (two straight ramps)."""

_CONSTANT = 1e-12
"""A variance below this fraction of the signal's own is zero up to rounding."""


@metric("estimate_rmse_ratio", unit="1", better="lower", tolerance=Tolerance(1e-5, 5e-3))
def estimate_rmse(episode: Episode) -> float:
    """RMS error of the estimate as a fraction of the RMS of what it estimates, worst joint.

    RMS(tau_f_hat - tau_dist) / RMS(tau_dist) over all periods; tau_dist, friction and whatever else disturbs the motor,
    is the mean over the period for which tau_f_hat was applied. 1 for no estimate at all. Joints with RMS(tau_dist)
    below 1e-9 N or N m do not count; NaN if none is left.
    """
    disturbance = rms(episode.tau_dist)
    error = rms(episode.tau_f_hat - episode.tau_dist)
    there = disturbance >= _NOTHING
    return largest(error[there] / disturbance[there])


@metric("estimate_lag_ms", unit="ms", better="lower", tolerance=Tolerance(1e-4, 0.9))
def estimate_lag(episode: Episode) -> float:
    """Lag of the estimate behind the disturbance of the motor, on the joint where that has the largest RMS.

    In ms, positive = tau_f_hat comes late, negative = early: the shift within +-500 ms (at most half the
    episode) with the largest correlation coefficient between tau_f_hat and tau_dist, refined by a parabola
    through its neighbours. NaN without a disturbance, if either signal is constant, or if the largest coefficient
    is at the edge of the search, not above zero, or no peak (two straight ramps fit at any lag).
    """
    disturbance = rms(episode.tau_dist)
    joint = int(np.argmax(disturbance))
    if disturbance[joint] < _NOTHING:
        return math.nan
    reach = min(round(_LONGEST_LAG / episode.dt), len(episode.tau_dist) // 2)
    coefficients = _correlation_at_lags(episode.tau_f_hat[:, joint], episode.tau_dist[:, joint], reach)
    peak = int(np.argmax(coefficients))
    if coefficients[peak] <= 0.0 or peak in (0, 2 * reach):
        return math.nan
    before, top, after = coefficients[peak - 1 : peak + 2]
    curvature = before - 2.0 * top + after
    if curvature > -_FLAT:
        return math.nan
    return 1e3 * episode.dt * float(peak - reach + (before - after) / (2.0 * curvature))


def _correlation_at_lags(late: Array, early: Array, reach: int) -> Array:
    """Correlation coefficient of late[k + lag] with early[k] at lags -reach..reach, (2 reach + 1,).

    Each is taken over the samples that both signals have at that lag, so that a pure delay gives exactly 1
    there, wherever the signals start and end. 0 where either is constant.
    """
    late, early = late - np.mean(late), early - np.mean(early)
    ones = np.ones_like(late)
    middle = len(late) - 1

    def sums(of_late: Array, of_early: Array) -> Array:
        """Sum over k of of_late[k + lag] of_early[k], lag by lag."""
        return correlate(of_late, of_early, method="fft")[middle - reach : middle + reach + 1]

    count = sums(ones, ones)
    sum_late, sum_early = sums(late, ones), sums(ones, early)
    covariance = sums(late, early) - sum_late * sum_early / count
    variance_late = sums(late**2, ones) - sum_late**2 / count
    variance_early = sums(ones, early**2) - sum_early**2 / count
    varies = (variance_late > _CONSTANT * np.sum(late**2)) & (variance_early > _CONSTANT * np.sum(early**2))
    scale = np.sqrt(variance_late * variance_early, where=varies, out=np.ones_like(count))
    return np.where(varies, covariance / scale, 0.0)
