"""Tracking: how far the joints and the tool are from where they should be, and from their path."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fo_gym.evaluation.episode.record import Array, Episode
from fo_gym.evaluation.metrics.reductions import largest, rms
from fo_gym.evaluation.metrics.registry import Tolerance, metric

_MM = 1e3
"""mm per m."""

_AFTER_REVERSAL = 0.1
"""How long after a reversal a quadrant glitch is looked for, s."""

_STANDSTILL = 1e-3
"""A joint's reference stands still below this fraction of the fastest joint's largest speed."""

_SAME_POINT = 1e-12
"""Points of the path closer than this, m, are one."""


@metric("joint_rms_error_ju", unit="ju", better="lower", tolerance=Tolerance(1e-8, 3e-4))
def joint_rms_error(episode: Episode) -> float:
    """RMS of theta - theta_d over the whole episode, worst joint.

    In m or rad, over all ticks; a step therefore counts with all of its response.
    """
    return largest(rms(episode.motion.theta - episode.theta_d))


@metric("tool_rms_error_mm", unit="mm", better="lower", tolerance=Tolerance(1e-9, 0.035))
def tool_rms_error(episode: Episode) -> float:
    """RMS distance from the tool to its desired position while the reference moves.

    In mm, over the part of the motion window that the episode reaches; NaN without a tool path.
    """
    paths = _moving_tool(episode)
    return math.nan if paths is None else _MM * float(rms(_distance(*paths)))


@metric("tool_max_error_mm", unit="mm", better="lower", tolerance=Tolerance(1e-9, 0.08))
def tool_max_error(episode: Episode) -> float:
    """Largest distance from the tool to its desired position while the reference moves.

    In mm, over the part of the motion window that the episode reaches; NaN without a tool path.
    """
    paths = _moving_tool(episode)
    return math.nan if paths is None else _MM * float(np.max(_distance(*paths)))


@metric("contour_error_mm", unit="mm", better="lower", tolerance=Tolerance(1e-9, 0.025))
def contour_error(episode: Episode) -> float:
    """RMS distance from the tool to the closest point of its path while the reference moves.

    In mm. The path is the polyline through tool_d in the motion window; being late on it is no contour error.
    NaN without a tool path.
    """
    paths = _moving_tool(episode)
    return math.nan if paths is None else _MM * float(rms(_distance_to_polyline(*paths)))


@metric("quadrant_glitch_mm", unit="mm", better="lower", tolerance=Tolerance(1e-9, 0.07))
def quadrant_glitch(episode: Episode) -> float:
    """Largest |tool - tool_ideal| within 0.1 s after a joint's reference reverses.

    In mm, over all reversals in the motion window. A joint reverses where theta_d sets out against its previous
    direction, however long it stood still in between; below 0.1 % of the fastest joint's largest speed it stands
    still. NaN without a tool path or without a reversal.
    """
    if _moving_tool(episode) is None or episode.motion_window is None:
        return math.nan
    window = episode.ticks(*episode.motion_window)
    reversals = window.start + _reversals(episode.theta_d[window])
    if not len(reversals):
        return math.nan
    deviation = _distance(episode.motion.scored, episode.ideal.scored)
    after = round(_AFTER_REVERSAL / episode.dt) + 1
    return _MM * max(float(np.max(deviation[tick : tick + after])) for tick in reversals)


def _moving_tool(episode: Episode) -> tuple[Array, Array] | None:
    """Tool and desired tool in the motion window, (ticks, 3) each, m; None without a path or such ticks."""
    if episode.motion.tool is None or episode.tool_d is None or episode.motion_window is None:
        return None
    window = episode.ticks(*episode.motion_window)
    tool = episode.motion.tool[window]
    return (tool, episode.tool_d[window]) if len(tool) else None


def _distance(one: Array, other: Array) -> Array:
    """Euclidean distance between points, (n, 3) and (n, 3) or (3,) -> (n,)."""
    distance: Array = np.linalg.norm(one - other, axis=1)
    return distance


def _distance_to_polyline(points: Array, path: Array) -> Array:
    """Distance of points (n, 3) to the polyline through path (m, 3), -> (n,).

    Only the two segments at the nearest vertex are looked at: exact where the path is sampled more finely than
    it bends, and elsewhere never more than the distance to that vertex.
    """
    moved = np.linalg.norm(np.diff(path, axis=0), axis=1) > _SAME_POINT
    vertices = path[np.concatenate([[True], moved])]
    if len(vertices) == 1:
        return _distance(points, vertices[0])
    _, nearest = cKDTree(vertices).query(points)
    before = np.maximum(nearest - 1, 0)
    after = np.minimum(nearest, len(vertices) - 2)
    return np.minimum(
        _distance_to_segment(points, vertices[before], vertices[before + 1]),
        _distance_to_segment(points, vertices[after], vertices[after + 1]),
    )


def _distance_to_segment(points: Array, start: Array, end: Array) -> Array:
    """Distance of each point to its own segment, all (n, 3), -> (n,); segments have a length."""
    along = end - start
    share = np.sum((points - start) * along, axis=1) / np.sum(along * along, axis=1)
    return _distance(points, start + np.clip(share, 0.0, 1.0)[:, None] * along)


def _reversals(reference: Array) -> NDArray[np.intp]:
    """Ticks at which a joint of `reference` (ticks, dof) sets out against its previous direction, ascending."""
    change = np.diff(reference, axis=0)
    if not change.any():
        return np.empty(0, dtype=np.intp)
    threshold = _STANDSTILL * np.max(np.abs(change))
    ticks = []
    for joint in change.T:
        moving = np.flatnonzero(np.abs(joint) > threshold)
        ticks.append(moving[1:][np.diff(np.sign(joint[moving])) != 0])
    return np.unique(np.concatenate(ticks))
