"""Numbers that no robot has, found in a file's compiled model before anything is computed with them."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from fo_gym.robots.editing import HINGE
from fo_gym.robots.welding import SLIDE

LARGEST = 1e9
"""Numbers of a file are below this, in SI units."""

MOST_JOINTS = 256
"""Flexible joints of a robot: all pairs of them are in the inertia matrix."""

_OF_BODIES = ("mass", "inertia", "pos", "quat", "ipos", "iquat", "gravcomp")
_OF_JOINTS = ("axis", "pos", "stiffness")
_OF_DOFS = ("damping", "armature", "frictionloss")
_NOT_NEGATIVE = {"mass", "inertia", "stiffness", "damping", "armature", "frictionloss"}

__all__ = ["LARGEST", "MOST_JOINTS", "check_count", "check_numbers_of"]


def check_numbers_of(file: Path, whole: mujoco.MjModel) -> None:
    """Raise ValueError for a number that is not finite, larger than LARGEST, or below 0 where it must not be."""
    for body in range(1, whole.nbody):
        for name in _OF_BODIES:
            _check(file, f"{name} of body {whole.body(body).name!r}", name, getattr(whole, f"body_{name}")[body])
    for joint in range(whole.njnt):
        what = f"of joint {whole.joint(joint).name!r}"
        for name in _OF_JOINTS:
            _check(file, f"{name} {what}", name, getattr(whole, f"jnt_{name}")[joint])
        if whole.jnt_type[joint] in (HINGE, SLIDE):
            for name in _OF_DOFS:
                _check(file, f"{name} {what}", name, getattr(whole, f"dof_{name}")[whole.jnt_dofadr[joint]])
    _check(file, "the drawn pose", "qpos0", whole.qpos0)
    _check(file, "gravity", "gravity", whole.opt.gravity)


def _check(file: Path, what: str, name: str, value: object) -> None:
    values = np.atleast_1d(np.asarray(value, dtype=np.float64))
    low = 0.0 if name in _NOT_NEGATIVE else -LARGEST
    if not np.all((values >= low) & (values <= LARGEST)):
        told = values.tolist() if values.size > 1 else f"{values[0]:g}"
        raise ValueError(f"{file}: {what} is {told}; give numbers from {low:g} to {LARGEST:g}")


def check_count(file: Path, joints: tuple[str, ...]) -> None:
    """Raise ValueError for more joints than MOST_JOINTS."""
    if len(joints) > MOST_JOINTS:
        raise ValueError(
            f"{file} has {len(joints)} joints that move; a robot has at most {MOST_JOINTS}: name them, joints=[...]"
        )
