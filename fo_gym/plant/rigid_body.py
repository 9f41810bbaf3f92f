"""The link side, batched: inertia and bias from MuJoCo, for links of other masses in every environment."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from fo_gym.plant.links import Links
from fo_gym.robots import LinkSide

Array = NDArray[np.float64]
Ids = NDArray[np.intp] | None

_VELOCITY_STAGE = int(mujoco.mjtStage.mjSTAGE_VEL)

__all__ = ["RigidBody", "Share"]


class Share:
    """Some environments of a body, one after the other in a batch of MuJoCo's: a thread's work.

    Attributes:
        first, last: of them; `last` is not among them.
        inputs: where `forward` reads q and q_dot, (last - first, dof) each, to be written into.
        outputs: what it writes, until the next query does: bias, and what it is less of, (last - first, dof) each, and
            M, (last - first, nonzeros).
    """

    def __init__(self, model: mujoco.MjModel, first: int, last: int) -> None:
        self.first, self.last = first, last
        self._batch = Batch(model, last - first, nthread=1)
        self.inputs = self._batch.bind("qpos"), self._batch.bind("qvel")
        self.outputs = tuple(self._batch.bind(name) for name in ("qfrc_bias", "qfrc_passive", "M"))
        self._mass, self._inertia = self._batch.expand("body_mass"), self._batch.expand("body_inertia")

    def scale_mass(self, model: mujoco.MjModel, scale: Array, ids: Ids) -> None:
        """Multiply masses and inertias of the model by `scale`, (n,), for its own environments of these numbers."""
        rows = slice(None) if ids is None else ids
        self._mass[rows] = model.body_mass * scale[:, None]
        self._inertia[rows] = model.body_inertia * scale[:, None, None]
        self._batch.set_const(ids)

    def forward(self, ids: Ids = None) -> None:
        """What `RigidBody.dynamics` gives, for its own environments of these numbers, at `inputs` into `outputs`."""
        self._batch.forward(ids, _VELOCITY_STAGE)


class RigidBody:
    """`num_envs` copies of a link side, each with its own masses.

    It holds no motion state: every query names the configuration it asks about. `ids` picks environments
    (None = all); arrays then have one row for each of them.

    Args:
        link_side: what is loaded.
        num_envs: how many copies.
        shares: (first, last) environment of each thread; None for one thread.

    Attributes:
        model: the compiled MuJoCo model.
        links: its kinematics and gravity, with the masses of the file.
        damping: of the file's own dampers at the joints, (dof,) [N s/m | N m s/rad]: they are the kernel's, which takes
            them implicitly, and no part of the bias.
        layout: (row_nonzeros, row_start, columns) of the sparse lower triangle in which `dynamics` gives M.
        mass_scale: factor on the masses of each environment, (num_envs,).
        shares: those of the threads.
        forwards: what they do, to be called.
    """

    def __init__(self, link_side: LinkSide, num_envs: int, shares: Sequence[tuple[int, int]] | None = None) -> None:
        self.link_side = link_side
        self.model = link_side.model
        self.links = Links(link_side)
        self.damping = self.model.dof_damping.copy()
        self.model.dof_damping[:] = 0.0
        self.mass_scale = np.ones(num_envs)
        self._make_shares(shares or [(0, num_envs)])

    def _make_shares(self, shares: Sequence[tuple[int, int]]) -> None:
        self.layout = self.model.M_rownnz, self.model.M_rowadr, self.model.M_colind
        self.shares = [Share(self.model, first, last) for first, last in shares]
        self.forwards = [share.forward for share in self.shares]
        self.scale_mass(self.mass_scale)

    def __getstate__(self) -> dict[str, Any]:
        # A Batch cannot be pickled; it is rebuilt from what defines it.
        kept = {name: value for name, value in self.__dict__.items() if name not in ("layout", "forwards", "shares")}
        return {**kept, "shares": [(share.first, share.last) for share in self.shares]}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._make_shares(state["shares"])

    def _parts(self, ids: Ids) -> Iterator[tuple[Share, NDArray[np.intp] | slice, Ids]]:
        """Every share of these environments: which of `ids` are its own, and which of its own they are."""
        for share in self.shares:
            if ids is None:
                yield share, slice(share.first, share.last), None
            elif len(own := np.flatnonzero((ids >= share.first) & (ids < share.last))):
                yield share, own, ids[own] - share.first

    def scale_mass(self, scale: Array, ids: Ids = None) -> None:
        """Multiply all masses and inertias of the file by `scale`, (n,), for the named environments.

        Raises:
            ValueError: a scale is not finite and above 0.
        """
        if not np.all(np.isfinite(scale) & (np.asarray(scale) > 0)):
            raise ValueError(f"mass scale is {scale}; it must be finite and above 0")
        self.mass_scale[slice(None) if ids is None else ids] = scale
        for share, own, its in self._parts(ids):
            share.scale_mass(self.model, scale[own], its)

    def dynamics(self, q: Array, q_dot: Array, ids: Ids = None) -> tuple[Array, Array]:
        """Inertia and bias at (q, q_dot), (n, dof) each.

        Returns:
            M as a sparse lower triangle, (n, nonzeros), laid out as in `layout`; C q_dot + g less the file's own
            joint springs, (n, dof), N or N m.
        """
        inertia, bias = np.empty((len(q), len(self.layout[2]))), np.empty(q.shape)
        for share, own, its in self._parts(ids):
            rows = slice(None) if its is None else its
            for place, value in zip(share.inputs, (q, q_dot), strict=True):
                place[rows] = value[own]
            share.forward(its)
            whole, less, sparse = share.outputs
            inertia[own], bias[own] = sparse[rows], whole[rows] - less[rows]
        return inertia, bias

    def dense_inertia(self, q: Array, ids: Ids = None) -> Array:
        """M(q) as full matrices, (n, dof, dof)."""
        sparse, _ = self.dynamics(q, np.zeros_like(q), ids)
        row_nonzeros, row_start, columns = self.layout
        dense = np.zeros((len(sparse), self.link_side.dof, self.link_side.dof))
        for row, (count, start) in enumerate(zip(row_nonzeros, row_start, strict=True)):
            column = columns[start : start + count]
            dense[:, row, column] = dense[:, column, row] = sparse[:, start : start + count]
        return dense

    def mobility(self, q: Array, ids: Ids = None) -> Array:
        """(M^-1)_jj, how far a torque moves its own link, (n, dof)."""
        return np.diagonal(np.linalg.inv(self.dense_inertia(q, ids)), axis1=1, axis2=2)

    def gravity(self, q: Array, ids: Ids = None) -> Array:
        """Torque g(q), (n, dof), N or N m, that holds the links still: gravity, less the file's own joint springs."""
        return self.links.gravity(q, self.mass_scale if ids is None else self.mass_scale[ids])
