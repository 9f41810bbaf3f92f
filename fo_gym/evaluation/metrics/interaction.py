"""Interaction: what a hand that guides the tool feels of friction, and whether the arm gives energy to it.

All are NaN where no hand grips the tool within the episode.
"""

from __future__ import annotations

import math

import numpy as np

from fo_gym.evaluation.episode.record import Array, Episode, Motion
from fo_gym.evaluation.metrics.reductions import REST
from fo_gym.evaluation.metrics.registry import Tolerance, metric
from fo_gym.tasks.hand import Hand

_BINS = 20
"""Parts of the tool's way in which forces forth and back are compared."""

_NO_WORK = 1e-9
"""Work against friction, J, below which there is nothing to save."""

_VIOLATION = 0.01
"""Energy that an arm may give out beyond what it had, as a share of the hand's work without friction: bristles and
observers, whose own springs are not counted as stored, hold less."""


@metric("hand_work_j", unit="J", better="lower", tolerance=Tolerance(1e-6, 0.02))
def hand_work(episode: Episode) -> float:
    """Work of the hand on the tool, from its grip until it has let go.

    In J: sum of f_hand (x[k+1] - x[k]), the mean force of a period times the way of the tool. Without friction it is
    what the controller's damping takes and its spring holds when the hand lets go.
    """
    return math.nan if _hand(episode) is None else _work(episode.motion)


@metric("hand_friction_work_ratio", unit="1", better="lower", tolerance=Tolerance(1e-6, 0.01))
def hand_friction_work(episode: Episode) -> float:
    """Work of the hand against friction, as a share of what it is without compensation: 1 useless, 0 as if none.

        |W_f| / |W_f,none|,  W_f = hand_work_j - (what the friction-free arm would store and damp on the same motion)

    of the same hand in the same episode, from its grip until it has let go. By the energy balance of the plant W_f is
    the sum of `Motion.lost`, and so computed: without friction it is 0, without compensation the work of friction
    itself, wherever the tool goes. The absolute value: to help the hand along is no better than to hinder it. NaN where
    friction takes less than 1e-9 J.
    """
    hand = _hand(episode)
    if hand is None:
        return math.nan
    effect = abs(_against_friction(episode.none, hand, episode))
    return abs(_against_friction(episode.motion, hand, episode)) / effect if effect >= _NO_WORK else math.nan


@metric("apparent_friction_n", unit="N", better="lower", tolerance=Tolerance(1e-4, 0.2))
def apparent_friction(episode: Episode) -> float:
    """Force at the tool that turns with the direction of its motion, beyond that of the arm without friction.

    In N: half the width of the loop that the hand's force, along its strokes, draws over the tool's way, less that of
    the ideal arm (whose controller damps), and its absolute value. Quasi-static: only from the parts of the strokes in
    which the hand's own point has a constant speed. The width is the mean over 20 parts of the way that both directions
    pass through, of the mean force forth less the mean force back. NaN where they share no way.
    """
    hand = _hand(episode)
    if hand is None:
        return math.nan
    return abs(_half_width(episode.motion, hand, episode) - _half_width(episode.ideal, hand, episode))


@metric("return_error_mm", unit="mm", better="lower", tolerance=Tolerance(1e-5, 0.2))
def return_error(episode: Episode) -> float:
    """Mean distance of the tool from its target over the last second, after the hand has let it go.

    In mm. NaN where the hand still held the tool in that second.
    """
    hand = _hand(episode)
    if hand is None or hand.let_go + hand.release > episode.duration - REST:
        return math.nan
    assert episode.motion.tool is not None
    assert episode.tool_d is not None
    window = episode.ticks(episode.duration - REST, episode.duration)
    away = np.linalg.norm(episode.motion.tool[window] - episode.tool_d[window], axis=1)
    return 1e3 * float(np.mean(away))


@metric("hand_energy_created_j", unit="J", better="lower", tolerance=Tolerance(1e-6, 0.02))
def hand_energy_created(episode: Episode) -> float:
    """Largest energy that the arm gave out in any span of time beyond what the hand put in and what was stored.

        max over t1 <= t2 of  V(t2) - V(t1) - ∫ tau_ext' q_dot dt,  at least 0

    In J. V is what the friction-free arm stores: energy of motion of links and motors, of the joints' springs, of
    gravity, and the potential of the controller, whose gradient is its torque at rest. (tau_ext, q_dot) of that arm is
    passive with V, so its value is 0: this is by how much the compensated arm breaks the same inequality. By the energy
    balance of the plant it is the largest fall of the sum of `Motion.lost` and `Episode.damped`, and so computed.
    """
    if _hand(episode) is None:
        return math.nan
    assert episode.motion.lost is not None
    assert episode.damped is not None
    taken = np.cumsum(np.append(0.0, episode.motion.lost + episode.damped))
    return float(np.max(np.maximum.accumulate(taken) - taken))


@metric("hand_passivity_violation_ratio", unit="1", better="lower", tolerance=Tolerance(0.0, 1.0), share=True)
def hand_passivity_violation(episode: Episode) -> float:
    """Passivity violated in the hand: 1 where the arm gave out more energy than a passive one may, else 0.

    1 where hand_energy_created_j is above 1 % of the hand's work on the arm without friction. The bristles of friction
    give back what they store, and an observer of the paper's kind has a spring of its own: both are below that. A
    row says the share of its episodes.
    """
    created = hand_energy_created(episode)
    return math.nan if math.isnan(created) else float(created > _VIOLATION * _work(episode.ideal))


def _hand(episode: Episode) -> Hand | None:
    """The hand, where it grips within the episode."""
    hand = episode.hand
    return hand if hand is not None and hand.grip < episode.duration else None


def _work(motion: Motion) -> float:
    assert motion.tool is not None
    assert motion.f_hand is not None
    return float(np.sum(motion.f_hand * np.diff(motion.tool, axis=0)))


def _against_friction(motion: Motion, hand: Hand, episode: Episode) -> float:
    """Work against friction from the grip until the hand has let go [J]."""
    assert motion.lost is not None
    guided = episode.ticks(hand.grip, hand.let_go + hand.release)
    return float(np.sum(motion.lost[guided.start : guided.stop - 1]))


def _half_width(motion: Motion, hand: Hand, episode: Episode) -> float:
    """Half the mean width of the loop of force over way [N]; NaN where no way is passed in both directions."""
    assert motion.tool is not None
    assert motion.f_hand is not None
    way, force = (signal @ np.array(hand.direction) for signal in (motion.tool, motion.f_hand))
    sides = []
    for first in (0, 1):
        spans = [episode.ticks(*span) for span in hand.steady[first::2]]
        ticks = np.concatenate([np.arange(len(force))[span] for span in spans]) if spans else np.empty(0, dtype=int)
        sides.append((way[ticks], force[ticks]))
    return 0.5 * _mean_gap(*sides) if all(len(each) for each, _ in sides) else math.nan


def _mean_gap(forth: tuple[Array, Array], back: tuple[Array, Array]) -> float:
    """Mean over the parts of the common way of the mean force forth less that back [N]."""
    low, high = max(np.min(way) for way, _ in (forth, back)), min(np.max(way) for way, _ in (forth, back))
    if not high > low:
        return math.nan
    edges = np.linspace(low, high, _BINS + 1)
    means = np.full((2, _BINS), np.nan)
    for side, (way, force) in enumerate((forth, back)):
        part = np.digitize(way, edges) - 1
        for k in np.unique(part[(part >= 0) & (part < _BINS)]):
            means[side, k] = np.mean(force[part == k])
    gaps = means[0] - means[1]
    return float(np.nanmean(gaps)) if not np.all(np.isnan(gaps)) else math.nan
