"""What a link side is in its poses: inertia, gravity, the tool's Jacobian; and the scales that make them comparable."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

Array = NDArray[np.float64]

SLIDE = 0.1
"""What a sliding joint moves while a hinge turns by 1 rad [m]: the lever of a joint's own gear and housing."""

ORIENTED_FROM = 6
"""Joints from which on a tool is moved in position and orientation; fewer move its position alone."""

CENTRAL = 0.6
"""Share of every joint's range that poses are taken from, about its middle."""

_SLOPE_STEP = 1e-4
"""Of the central difference that gives dg/dq, in natural units; g is a sine of them, so it is good to 2e-9 of g."""

__all__ = [
    "CENTRAL",
    "ORIENTED_FROM",
    "SLIDE",
    "Poses",
    "joint_range",
    "motion_units",
    "natural_units",
    "scaled",
    "tool_rows",
]


def natural_units(model: mujoco.MjModel) -> Array:
    """1 rad for a hinge, SLIDE for a slide, (dof,) [rad | m]: in these units joints of both kinds compare."""
    return np.where(model.jnt_type == int(mujoco.mjtJoint.mjJNT_SLIDE), SLIDE, 1.0)


def motion_units(model: mujoco.MjModel) -> Array:
    """By what joints move where hinges are asked for 1 rad: a natural unit, at most their range, (dof,) [rad | m]."""
    low, high = joint_range(model)
    return np.minimum(natural_units(model), high - low)


def joint_range(model: mujoco.MjModel) -> tuple[Array, Array]:
    """Lowest and highest position of every joint, (dof,) each [rad | m]; infinite where there is none."""
    limited = model.jnt_limited.astype(bool)
    low = np.where(limited, model.jnt_range[:, 0], -np.inf)
    return low, np.where(limited, model.jnt_range[:, 1], np.inf)


def tool_rows(dof: int) -> int:
    """Rows of the tool's task: 6 with orientation, 3 for position alone."""
    return 6 if dof >= ORIENTED_FROM else 3


def scaled(jacobian: Array, units: Array, reach: float) -> Array:
    """Jacobians (..., 3 | 6, dof) without dimension: joints in natural units, the tool's position in units of reach."""
    rows = np.ones(jacobian.shape[-2])
    rows[:3] = 1.0 / reach
    return rows[:, None] * jacobian * units


class Poses:
    """A link side, asked pose by pose.

    Args:
        model: the compiled link side; its joints are hinges and slides only.
        tool: name of the tool's site, or None.

    Attributes:
        units: natural unit of every joint, (dof,).
        low, high: the range that is looked at, (dof,) [rad | m]: the joints' own, at most a turn where it is wider or
            where there is none.
    """

    def __init__(self, model: mujoco.MjModel, tool: str | None = None) -> None:
        self.model = model
        self._data = mujoco.MjData(model)
        self._site = None if tool is None else int(model.site(tool).id)
        self.units = natural_units(model)
        low, high = joint_range(model)
        bounded = np.isfinite(low)
        middle = np.where(bounded, 0.5 * (np.where(bounded, low, 0.0) + np.where(bounded, high, 0.0)), 0.0)
        half = np.minimum(0.5 * (high - low), np.pi * self.units)
        self.low, self.high = middle - half, middle + half

    def sample(self, count: int, share: float = CENTRAL) -> Array:
        """`count` poses that fill the middle `share` of all ranges evenly, the middle first, (count, dof).

        A Sobol sequence, not scrambled: the same poses on every machine.
        """
        exponent = int(np.ceil(np.log2(count + 1)))
        points = qmc.Sobol(self.model.nq, scramble=False).random_base2(exponent)[1 : count + 1]
        return 0.5 * (self.low + self.high) + share * (self.high - self.low) * (points - 0.5)

    def _at(self, q: Array) -> mujoco.MjData:
        self._data.qpos[:] = q
        self._data.qvel[:] = 0.0
        mujoco.mj_fwdPosition(self.model, self._data)
        return self._data

    def inertia(self, q: Array) -> Array:
        """M(q), (dof, dof), without motors."""
        dense = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self._at(q), dense)
        return dense

    def gravity(self, q: Array) -> Array:
        """Torque g(q) that holds the links still, (dof,) [N m | N], less the file's own springs."""
        data = self._at(q)
        mujoco.mj_fwdVelocity(self.model, data)
        return np.array(data.qfrc_bias - data.qfrc_passive)

    def gravity_slope(self, q: Array) -> Array:
        """dg/dq, (dof, dof), row by torque, column by joint."""
        steps = np.diag(_SLOPE_STEP * self.units)
        columns = [(self.gravity(q + step) - self.gravity(q - step)) / (2.0 * step.sum()) for step in steps]
        return np.array(columns).T

    def gravity_bound(self) -> Array:
        """A bound of |dg/dq| for every joint over all poses, (dof,) [N m/rad | N/m].

        The largest sum of a row of dg/dq, other joints counted in natural units: diag(K_p) above it makes K_p + dg/dq
        diagonally dominant, hence positive definite, so that PD with g(q_d) has one rest (Tomei 1991); K_j above it
        gives the springs one.
        """
        slopes = np.abs([self.gravity_slope(q) for q in self.sample(127, share=1.0)])
        return np.asarray((slopes @ self.units).max(axis=0) / self.units)

    def jacobian(self, q: Array) -> Array:
        """Of the tool, (6, dof): linear velocity, then angular."""
        assert self._site is not None
        jacobian = np.zeros((6, self.model.nv))
        mujoco.mj_jacSite(self.model, self._at(q), jacobian[:3], jacobian[3:], self._site)
        return jacobian

    def reach(self) -> float:
        """The longest lever of the tool, over many poses [m per natural unit]; 1 where no joint moves it."""
        longest = max(float(np.linalg.norm(columns[:3], axis=0).max()) for columns in self._scaled_columns())
        return longest if longest > 0.0 else 1.0

    def _scaled_columns(self) -> Iterator[Array]:
        return (self.jacobian(q) * self.units for q in self.sample(64, share=1.0))
