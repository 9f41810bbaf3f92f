"""The link side, batched: inertia and bias from MuJoCo, for links of other masses in every environment."""

from __future__ import annotations

import os
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

__all__ = ["RigidBody"]


class RigidBody:
    """`num_envs` copies of a link side, each with its own masses.

    It holds no motion state: every query names the configuration it asks about. `ids` picks environments
    (None = all); arrays then have one row for each of them.

    Attributes:
        link_side: what was loaded.
        num_threads: of MuJoCo.
        model: the compiled MuJoCo model.
        links: its kinematics and gravity, with the masses of the file.
        damping: of the file's own dampers at the joints, (dof,) [N s/m | N m s/rad]: they are the kernel's, which takes
            them implicitly, and no part of the bias.
        layout: (row_nonzeros, row_start, columns) of the sparse lower triangle in which `dynamics` gives M.
        mass_scale: factor on the masses of each environment, (num_envs,).
        inputs: where `forward` reads q and q_dot, (num_envs, dof) each, to be written into.
        outputs: what it writes, until the next query does: bias, and what it is less of, (num_envs, dof) each, and M.
    """

    def __init__(self, link_side: LinkSide, num_envs: int, num_threads: int = 1) -> None:
        self.link_side = link_side
        self.num_envs = num_envs
        self.num_threads = num_threads
        self.model = link_side.model
        self.links = Links(link_side)
        self.damping = self.model.dof_damping.copy()
        self.model.dof_damping[:] = 0.0
        self.mass_scale = np.ones(num_envs)
        self._make_batch()

    def _make_batch(self) -> None:
        self.layout = self.model.M_rownnz, self.model.M_rowadr, self.model.M_colind
        self._batch, self._process = Batch(self.model, self.num_envs, nthread=self.num_threads), os.getpid()
        self._qpos = self._batch.bind("qpos")
        self._qvel = self._batch.bind("qvel")
        self._inertia = self._batch.bind("M")
        self._bias = self._batch.bind("qfrc_bias")
        self._passive = self._batch.bind("qfrc_passive")
        self.inputs, self.outputs = (self._qpos, self._qvel), (self._bias, self._passive, self._inertia)
        self._mass = self._batch.expand("body_mass")
        self._body_inertia = self._batch.expand("body_inertia")
        self.scale_mass(self.mass_scale)

    def __getstate__(self) -> dict[str, Any]:
        # A Batch owns threads and cannot be pickled; it is rebuilt from what defines it.
        return {
            "link_side": self.link_side,
            "num_envs": self.num_envs,
            "num_threads": self.num_threads,
            "model": self.model,
            "links": self.links,
            "damping": self.damping,
            "mass_scale": self.mass_scale,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._make_batch()

    def _check_process(self) -> None:
        """Raise RuntimeError where this process was forked and has none of the threads: it would wait for ever."""
        if self.num_threads > 1 and self._process != os.getpid():
            raise RuntimeError(
                "this process was forked, and the environment's threads stayed with its parent; make the environment "
                "in this process, or with num_threads=1"
            )

    def scale_mass(self, scale: Array, ids: Ids = None) -> None:
        """Multiply all masses and inertias of the file by `scale`, (n,), for the named environments.

        Raises:
            ValueError: a scale is not finite and above 0.
        """
        if not np.all(np.isfinite(scale) & (np.asarray(scale) > 0)):
            raise ValueError(f"mass scale is {scale}; it must be finite and above 0")
        self._check_process()
        rows = slice(None) if ids is None else ids
        self.mass_scale[rows] = scale
        self._mass[rows] = self.model.body_mass * self.mass_scale[rows, None]
        self._body_inertia[rows] = self.model.body_inertia * self.mass_scale[rows, None, None]
        self._batch.set_const(ids)

    def forward(self) -> None:
        """What `dynamics` gives, for all environments at `inputs`, into `outputs`."""
        self._check_process()
        self._batch.forward(None, _VELOCITY_STAGE)

    def dynamics(self, q: Array, q_dot: Array, ids: Ids = None) -> tuple[Array, Array]:
        """Inertia and bias at (q, q_dot), (n, dof) each.

        Returns:
            M as a sparse lower triangle, (n, nonzeros), laid out as in `layout`; C q_dot + g less the file's own
            joint springs, (n, dof), N or N m.
        """
        self._check_process()
        rows = slice(None) if ids is None else ids
        self._qpos[rows], self._qvel[rows] = q, q_dot
        self._batch.forward(ids, _VELOCITY_STAGE)
        return self._inertia[rows], self._bias[rows] - self._passive[rows]

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
