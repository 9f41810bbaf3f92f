"""Hunting: whether a joint still moves where it should have come to rest, how far, and how fast."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from fo_gym.evaluation.episode.record import Array, Episode
from fo_gym.evaluation.metrics.reductions import largest
from fo_gym.evaluation.metrics.registry import Tolerance, metric

HUNTING = 1e-4
"""Peak-to-peak motion at rest, m or rad, above which a joint hunts.

On the arm, 0.1 mrad at a reach of 0.8 m moves the tool by 0.08 mm, about the repeatability of such arms (0.1 mm by
ISO 9283 in the data sheets of iiwa 7 and Panda): a motion above it is seen at the tool, one below is not. On the
single link it is 1 % of the step. Joints leave a gap there: in 20 randomized episodes of the arm under PD-type and
PID-type observers, after the ideal has come to rest, those that rest move by 1e-9 to 4e-5, those that hunt by 3e-4 to
2e-2; sensor noise keeps resting ones within 6e-5 (6 episodes of the variant "hardware", PD-type).
"""

_CREEP_PRICE = 1e-3
"""Peak to peak that has to be gained per unit of creep taken out, so that none is where none shows."""

_NO_LIMIT_CYCLE = 2e-5
"""Peak-to-peak motion, m or rad, below which a limit cycle has no period."""

_STUCK = 0.003
"""A joint is stuck below this fraction of the largest friction-free speed of any joint in the episode."""

_SLIPS = 0.03
"""A stuck joint has slipped above this fraction of that speed."""

_STUCK_FOR = 0.1
"""How long a joint must be below the lower speed to be stuck, s; a joint that only turns around is not."""


@metric("hunting_ratio", unit="1", better="lower", tolerance=Tolerance(0.0, 1.0), share=True)
def hunting(episode: Episode) -> float:
    """Hunting: 1 where a joint still moves by more than 1e-4 m or rad, peak to peak, once it should rest; else 0.

    By `limit_cycle_peak_to_peak` and `HUNTING`: relative to the motion without friction, slow creep left out, in a
    window in which that motion has come to rest. A row says the share of its episodes. NaN as the limit cycle.
    """
    size = limit_cycle_peak_to_peak(episode)
    return math.nan if math.isnan(size) else float(size > HUNTING)


@metric(
    "limit_cycle_peak_to_peak_ju", unit="ju", better="lower", tolerance=Tolerance(1e-9, 3e-4), where="hunting_ratio"
)
def limit_cycle_peak_to_peak(episode: Episode) -> float:
    """Peak to peak of the motion in the limit-cycle window that friction adds, without slow creep, worst joint.

    In m or rad. Taken per joint from theta - theta_ideal or from theta - theta_d, whichever moves less: a limit
    cycle is motion, and motion that the joint without friction does not make. (Where the friction-free joint
    still rings, the first alone would give a stuck joint that ringing, the second a perfect one.) Creep is the
    straight line a + b t that leaves the smallest peak to peak (`_without_creep`). NaN without a window, or if it
    ends after the episode. A push within the window is not looked for. A row says it of the episodes that hunt.
    """
    cycles = _limit_cycles(episode)
    return math.nan if cycles is None else largest(np.ptp(cycles, axis=0))


@metric("limit_cycle_period_s", unit="s", better="higher", tolerance=Tolerance(1e-3, 0.8), where="hunting_ratio")
def limit_cycle_period(episode: Episode) -> float:
    """Period of the motion in the limit-cycle window, on the joint where it is largest, peak to peak.

    In s: the mean time between two changes to the same side. The joint changes side when it gets into the
    upper or the lower quarter of its peak-to-peak range, coming from the other; slips of half the range
    (stick-slip in pairs) therefore count as one change. Slow cycles show only two changes, there and back, in
    the window: half a cycle, which is doubled. NaN where the peak to peak does not apply or is below 2e-5 m or rad,
    and with fewer than two changes. A row says it of the episodes that hunt.
    """
    cycles = _limit_cycles(episode)
    if cycles is None:
        return math.nan
    sizes = np.ptp(cycles, axis=0)
    joint = int(np.argmax(sizes))
    if sizes[joint] < _NO_LIMIT_CYCLE:
        return math.nan
    changes = _changes_of_side(cycles[:, joint])
    if len(changes) < 2:
        return math.nan
    if len(changes) == 2:
        return 2.0 * episode.dt * float(changes[1] - changes[0])
    return episode.dt * float(np.mean(changes[2:] - changes[:-2]))


@metric("stick_slip_count", unit="events", better="lower", tolerance=Tolerance(0.0, 0.0))
def stick_slip(episode: Episode) -> float:
    """How often a joint in the limit-cycle window, having been stuck, slips, worst joint.

    With v = the largest friction-free speed of any joint in the episode, from theta_ideal: a joint is stuck once
    |theta'| was below 0.3 % of v for 0.1 s on end, and has slipped when it next exceeds 3 % of v. Both thresholds
    follow from the episode, so that m and rad, large and small steps are alike; slips less than 0.1 s of rest
    apart (a pair) count as one. The window is where the reference stands still and nothing pushes: along a path
    joints stick at every reversal, which is no hunting. On a joint that rings, every reversal at which it sticks
    counts. NaN as the amplitude, and where nothing moves without friction.
    """
    window = _rest_window(episode)
    fastest = np.max(np.abs(np.diff(episode.ideal.theta, axis=0)), initial=0.0) / episode.dt
    if window is None or fastest == 0.0:
        return math.nan
    speeds = np.abs(episode.theta_dot[window]) / fastest
    ticks = max(1, round(_STUCK_FOR / episode.dt))
    return float(max(_slips(speed, ticks) for speed in speeds.T))


def settled(ideal: NDArray[np.floating[Any]]) -> int:
    """From which tick on the friction-free motors, (ticks, dof), rest, to a tenth of HUNTING; 0 where they never do."""
    moving = np.flatnonzero((np.abs(ideal - ideal[-1]) > HUNTING / 10).any(axis=1))
    return int(moving[-1]) + 1 if len(moving) and moving[-1] + 1 < len(ideal) else 0


def _slips(speed: Array, ticks: int) -> int:
    """How often `speed` (n,), having been below `_STUCK` for so many `ticks`, exceeds `_SLIPS`."""
    stuck = np.zeros(len(speed), dtype=bool)
    if len(speed) >= ticks:
        stuck[ticks - 1 :] = np.convolve(speed < _STUCK, np.ones(ticks, dtype=int), mode="valid") == ticks
    state = np.where(stuck, -1, np.where(speed > _SLIPS, 1, 0))
    return int(np.sum(np.diff(state[state != 0]) > 0))


def _rest_window(episode: Episode) -> slice | None:
    """Ticks of the limit-cycle window; None without one, or if it ends after the episode."""
    if episode.limit_cycle_window is None:
        return None
    window = episode.ticks(*episode.limit_cycle_window)
    return window if window.stop <= len(episode.theta_d) else None


@lru_cache(maxsize=1)  # three metrics of an episode ask, one after the other
def _limit_cycles(episode: Episode) -> Array | None:
    """Motion that friction adds in the limit-cycle window, without creep, (ticks, dof); None without a window."""
    window = _rest_window(episode)
    if window is None:
        return None
    theta = episode.motion.theta[window]
    from_ideal = np.apply_along_axis(_without_creep, 0, theta - episode.ideal.theta[window])
    from_target = np.apply_along_axis(_without_creep, 0, theta - episode.theta_d[window])
    return np.where(np.ptp(from_ideal, axis=0) <= np.ptp(from_target, axis=0), from_ideal, from_target)


def _without_creep(signal: Array) -> Array:
    """`signal` (ticks,) without the linear trend whose removal leaves the smallest peak to peak.

    That is the straight line fitted in the maximum norm. It removes a linear creep wholly and, unlike a
    least-squares line, never enlarges a cycle: a window with few slips has no whole number of periods, and
    least squares would see a slope in the slips themselves (half as much again on the paper's example). Among
    lines that leave practically the same, as around a single slip, it is the flattest.
    """
    height = float(np.ptp(signal))
    if height == 0.0:
        return signal
    ramp = np.linspace(-0.5, 0.5, len(signal))
    best = minimize_scalar(  # convex in the drift, which cannot exceed twice the height
        lambda drift: np.ptp(signal - drift * ramp) + _CREEP_PRICE * abs(drift),
        bounds=(-2.0 * height, 2.0 * height),
        method="bounded",
        options={"xatol": 1e-9 * height},
    )
    return signal - best.x * ramp


def _changes_of_side(signal: Array) -> NDArray[np.intp]:
    """Ticks at which `signal` (ticks,) enters the upper or lower quarter of its range, coming from the other one."""
    quarter = np.ptp(signal) / 4
    side = np.where(signal > signal.max() - quarter, 1, np.where(signal < signal.min() + quarter, -1, 0))
    decided = np.flatnonzero(side)
    changes: NDArray[np.intp] = decided[1:][np.diff(side[decided]) != 0]
    return changes
