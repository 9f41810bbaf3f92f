"""What a trace shows, in words: from which second on a joint oscillates, or where and when it stopped short."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.metrics.hunting import HUNTING, settled

Array = NDArray[np.float64]

__all__ = ["Finding", "look_at", "turning_points"]


@dataclass(frozen=True)
class Finding:
    """What is to be seen in a trace.

    Attributes:
        text: in words, with the second in which it happens.
        span: the seconds to look at.
    """

    text: str
    span: tuple[float, float]


def turning_points(values: Array, threshold: float) -> NDArray[np.int64]:
    """Where a signal turns round after a swing, and before one, of more than a threshold.

    Args:
        values: (n,).
        threshold: smaller swings do not count.

    Returns:
        The extremes between such swings, in their order; none where the signal goes one way or hardly moves.
    """
    found: list[int] = []
    low = high = 0
    way = 0
    for i, value in enumerate(values):
        if value > values[high]:
            high = i
        if value < values[low]:
            low = i
        if way >= 0 and values[high] - value > threshold:
            if way > 0:
                found.append(high)
            way, low = -1, i
        elif way <= 0 and value - values[low] > threshold:
            if way < 0:
                found.append(low)
            way, high = 1, i
    return np.array(found, dtype=np.int64)


def look_at(trace: Trace) -> Finding:
    """The worst that a trace shows, in words."""
    signals = {name: np.asarray(values, dtype=np.float64) for name, values in trace.signals.items()}
    if "tool" in signals:
        return _furthest(signals["time"], np.linalg.norm(signals["tool"] - signals["tool_ideal"], axis=1))
    return _at_rest(signals, trace.joint_unit)


def _furthest(time: Array, away: Array) -> Finding:
    at = int(np.nanargmax(away))
    text = f"the tool is furthest from its friction-free path at {time[at]:.2f} s: {1e3 * away[at]:.2g} mm"
    return Finding(text, _around(time, time[at], 1.0))


def _at_rest(signals: dict[str, Array], unit: str) -> Finding:
    """What a joint does once it would have come to rest without friction; told is the worst one."""
    time, theta, ideal, target = (signals[name] for name in ("time", "theta", "theta_ideal", "theta_d"))
    resting = settled(ideal)
    error = theta[resting:] - ideal[resting:]
    swings = [turning_points(column, HUNTING) for column in error.T]
    joint = int(np.argmax([len(each) for each in swings]))
    if len(swings[joint]) >= 2:
        start = time[resting + swings[joint][0]]
        size = 1e3 * float(np.ptp(error[swings[joint][0] :, joint]))
        text = f"{_joint(joint, theta)} oscillates from {start:.1f} s on, {size:.2g} m{unit} from peak to peak"
        return Finding(text, (_before(time, start), float(time[-1])))
    short = theta[-1] - target[-1]
    joint = int(np.argmax(np.abs(short)))
    moving = np.flatnonzero(np.abs(theta[:, joint] - theta[-1, joint]) > HUNTING / 2)
    since = time[moving[-1] + 1] if len(moving) and moving[-1] + 1 < len(time) else time[0]
    if abs(short[joint]) > HUNTING:
        text = f"{_joint(joint, theta)} stops {1e3 * abs(short[joint]):.2g} m{unit} off the target at {since:.1f} s"
    else:
        text = f"comes to rest on the target, within {1e3 * abs(short[joint]):.2g} m{unit}, at {since:.1f} s"
    return Finding(text, _around(time, since, 3.0))


def _joint(joint: int, theta: Array) -> str:
    return f"joint {joint + 1}" if theta.shape[1] > 1 else "the joint"


def _before(time: Array, second: float) -> float:
    return max(float(time[0]), round(float(second) - 1.0, 2))


def _around(time: Array, second: float, reach: float) -> tuple[float, float]:
    return max(float(time[0]), round(float(second) - reach, 2)), min(float(time[-1]), round(float(second) + reach, 2))
