"""Coming to rest: where the joints stop, and how they get there."""

from __future__ import annotations

import math

import numpy as np

from fo_gym.evaluation.episode.record import Array, Episode
from fo_gym.evaluation.metrics.reductions import REST, largest
from fo_gym.evaluation.metrics.registry import Tolerance, metric

_SETTLING_BAND = 0.02
"""Half width of the settling band, as a fraction of the step."""

_NO_STEP = 1e-9
"""Step of a joint, m or rad, below which it has no step response."""


@metric("steady_state_error_before_push_ju", unit="ju", better="lower", tolerance=Tolerance(1e-9, 1.5e-4))
def steady_state_error_before_push(episode: Episode) -> float:
    """Mean |theta - theta_d| over the last second before the push, worst joint.

    In m or rad. NaN without a push within the episode, or where the reference has not stood still for that
    second (the push comes less than 1 s after the start, the step, or the end of the path).
    """
    push = episode.push
    if push is None or push.time > episode.duration:
        return math.nan
    return _steady_state_error(episode, push.time)


@metric("steady_state_error_ju", unit="ju", better="lower", tolerance=Tolerance(1e-7, 4e-4))
def steady_state_error(episode: Episode) -> float:
    """Mean |theta - theta_d| over the last second of the episode, worst joint.

    In m or rad. NaN where there was no rest: the reference moved or the push acted within that second, or
    the episode is shorter than 1 s.
    """
    push = episode.push
    if push is not None and push.time < episode.duration and push.time + push.duration > episode.duration - REST:
        return math.nan
    return _steady_state_error(episode, episode.duration)


def _steady_state_error(episode: Episode, end: float) -> float:
    """Mean |theta - theta_d| over the second before `end` (s), worst joint; NaN if the reference moved in it."""
    window = episode.ticks(end - REST, end)
    if window.start < round(episode.moved_until / episode.dt):
        return math.nan
    return largest(np.mean(np.abs(episode.motion.theta[window] - episode.theta_d[window]), axis=0))


@metric("settling_time_s", unit="s", better="lower", tolerance=Tolerance(1e-3, 0.03))
def settling_time(episode: Episode) -> float:
    """Time from the step until every joint stays within 2 % of its step around theta_d.

    In s, up to the push or the end of the episode. The step of a joint is |theta_d at the end of that time -
    theta_ideal at the step|: the friction-free start, so that every competitor meets the same band wherever
    its own friction had left it. Joints without a step (below 1e-9 m or rad) do not count. A joint that never
    settles counts the whole available time. NaN where no joint steps.
    """
    response = _step_response(episode)
    outside = np.abs(response) > _SETTLING_BAND
    if not outside.size:
        return math.nan
    last_outside = np.flatnonzero(outside.any(axis=1))
    settled = last_outside[-1] + 1 if len(last_outside) else 0
    return episode.dt * float(min(settled, len(response) - 1))


@metric("overshoot_percent", unit="%", better="lower", tolerance=Tolerance(1e-8, 0.06))
def overshoot(episode: Episode) -> float:
    """How far a joint moves past theta_d, as a share of its step, worst joint.

    In percent, 0 without overshoot; window and step as for the settling time. NaN where no joint steps.
    """
    response = _step_response(episode)
    return 100.0 * float(np.max(response, initial=0.0)) if response.size else math.nan


def _step_response(episode: Episode) -> Array:
    """(theta - theta_d) / step from the step to the push or the end, (ticks, joints that step).

    Positive means past the target. Empty where there is no step. A push that starts before the step, or with
    it, does not end the window.
    """
    start = episode.step_time
    if start is None or start >= episode.duration:
        return np.empty((0, 0))
    push = episode.push
    end = min(push.time, episode.duration) if push is not None and push.time > start else episode.duration
    window = episode.ticks(start, end)
    theta, theta_d = episode.motion.theta[window], episode.theta_d[window]
    step = theta_d[-1] - episode.ideal.theta[window.start]
    steps = np.abs(step) >= _NO_STEP
    response: Array = (theta - theta_d)[:, steps] / step[steps]
    return response
