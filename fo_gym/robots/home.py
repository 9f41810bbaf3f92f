"""Where an arm starts when nobody says so, and which of its joints are redundant there."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.robots.poses import Poses, joint_range, natural_units, scaled, tool_rows

Array = NDArray[np.float64]

CANDIDATES = 511
"""Poses that are compared."""

LOADED = 0.5
"""Share of a joint's torque limit that gravity may take before a pose counts as a worse one."""

SINGULAR = 0.1
"""Smallest singular value of the tool's Jacobian, without dimension (poses.scaled), below which a pose is singular."""

EDGE = 0.15
"""Nearer to the end of its range a joint has no room for a step of 5 degrees [rad, or natural units of a slide]."""

EDGE_SHARE = 0.1
"""The same as a share of the range, where the range is small."""

_DIGITS = 3
"""Scores count to these digits, so that the last bits of a processor decide nothing; of equals the first is taken."""

__all__ = ["SINGULAR", "conditioning", "found_home", "poor_home", "redundant_joints", "room"]


def conditioning(poses: Poses, q: Array, reach: float) -> float:
    """The smallest singular value of the tool's Jacobian at q, without dimension.

    Of the rows that the tool's task has (poses.tool_rows); arms with fewer joints than rows have no such task, and the
    smallest of their own singular values counts.
    """
    dof = poses.model.nq
    rows = 6 if dof < 3 else tool_rows(dof)
    return float(np.linalg.svd(scaled(poses.jacobian(q)[:rows], poses.units, reach), compute_uv=False)[-1])


def found_home(model: mujoco.MjModel, tool: str | None = None, torque_limit: Array | None = None) -> Array:
    """A start pose with room around it, (dof,) [rad | m]: the same on every machine.

    Compared are CANDIDATES poses in the middle 60 % of every joint's range, the middle itself the first, so that steps,
    sinusoids and pushes have room on both sides. The best has the largest score: the smallest singular value of the
    tool's Jacobian (1 where no tool is named), less in proportion where gravity takes more than half of a joint's
    torque limit.

    Args:
        model: the compiled link side.
        tool: name of the tool's site.
        torque_limit: of every joint, (dof,) [N m | N], NaN where it is not known; None where none is.
    """
    poses = Poses(model, tool)
    reach = poses.reach() if tool is not None else 1.0
    candidates = poses.sample(CANDIDATES)
    scores = np.ones(len(candidates))
    for i, q in enumerate(candidates):
        if tool is not None:
            scores[i] = conditioning(poses, q, reach)
        if torque_limit is not None:
            load = np.abs(poses.gravity(q)) / torque_limit
            scores[i] *= min(1.0, LOADED / np.nanmax(load, initial=1e-9))
    best = candidates[int(np.argmax(np.round(scores, _DIGITS)))]
    # Round numbers, as far as the range of a joint is not too small for them.
    return np.where(poses.high - poses.low > 1.0 * poses.units, np.round(best, 3), best)


def room(model: mujoco.MjModel, q: Array) -> Array:
    """Distance of every joint to the nearer end of its range, (dof,), in units of what a step needs."""
    low, high = joint_range(model)
    return np.asarray(
        np.minimum(q - low, high - q) / np.minimum(EDGE * natural_units(model), EDGE_SHARE * (high - low))
    )


def poor_home(model: mujoco.MjModel, q: Array, tool: str | None = None) -> str | None:
    """Why q (dof,) [rad | m] is no pose to start from, or None where it is one.

    It is none where a joint stands within EDGE of the end of its range (EDGE_SHARE of a small range), or where the tool
    is at a singularity.
    """
    poses = Poses(model, tool)
    for j in np.flatnonzero(room(model, q) < 1.0):
        return f"joint {model.joint(j).name!r} stands at {q[j]:g}, too near to an end of its range"
    if tool is not None and model.nq >= 3:
        smallest = conditioning(poses, q, poses.reach())
        if smallest < SINGULAR:
            return f"the tool's Jacobian is singular there: its smallest singular value is {smallest:.2g}"
    return None


def redundant_joints(model: mujoco.MjModel, home: Array, tool: str | None) -> tuple[str, ...]:
    """Names of the joints that a tool task leaves free, in the model's order: those that the tool needs least.

    One after the other the joint is held without which the tool's Jacobian at home keeps the largest smallest singular
    value; of equals the first. () without a tool, or where there are no more joints than the task has rows.
    """
    if tool is None or model.nq < 3:
        return ()
    poses, rows = Poses(model, tool), tool_rows(model.nq)
    jacobian = scaled(poses.jacobian(home)[:rows], poses.units, poses.reach())
    moving = list(range(model.nq))
    while len(moving) > rows:
        without = [[j for j in moving if j != held] for held in moving]
        kept = [float(np.linalg.svd(jacobian[:, rest], compute_uv=False)[-1]) for rest in without]
        moving = without[int(np.argmax(np.round(kept, _DIGITS)))]
    return tuple(model.joint(j).name for j in range(model.nq) if j not in moving)
