"""Joints that are not driven, welded: the bodies that they move stand where the joints hold them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SLIDE = int(mujoco.mjtJoint.mjJNT_SLIDE)

__all__ = ["SLIDE", "weld"]


class _Motion:
    """A rigid motion x -> rotation x + shift, rotation as a unit quaternion."""

    def __init__(self, rotation: Any, shift: Any) -> None:
        self.rotation, self.shift = np.array(rotation, dtype=np.float64), np.array(shift, dtype=np.float64)

    @classmethod
    def of_joint(cls, model: mujoco.MjModel, joint: int, value: float) -> _Motion:
        """Of a hinge or a slide, in the frame of its body, at `value`."""
        axis, moved = model.jnt_axis[joint], value - model.qpos0[model.jnt_qposadr[joint]]
        if model.jnt_type[joint] == SLIDE:
            return cls([1.0, 0.0, 0.0, 0.0], moved * axis)
        turn = np.zeros(4)
        mujoco.mju_axisAngle2Quat(turn, axis, moved)
        about = cls(turn, np.zeros(3))
        return cls(turn, model.jnt_pos[joint] - about.point(model.jnt_pos[joint]))

    def point(self, x: Array) -> Array:
        """Where a point goes."""
        return self.direction(x) + self.shift

    def direction(self, x: Array) -> Array:
        """Where a vector goes."""
        moved = np.zeros(3)
        mujoco.mju_rotVecQuat(moved, x, self.rotation)
        return moved

    def after(self, first: _Motion) -> _Motion:
        """`first`, then this one."""
        rotation = np.zeros(4)
        mujoco.mju_mulQuat(rotation, self.rotation, first.rotation)
        mujoco.mju_normalize4(rotation)
        return _Motion(rotation, self.point(first.shift))

    def inverse(self) -> _Motion:
        """The way back."""
        back = _Motion(self.rotation * [1.0, -1.0, -1.0, -1.0], np.zeros(3))
        back.shift = -back.direction(self.shift)
        return back


def weld(model: mujoco.MjModel, whole: mujoco.MjModel, joints: tuple[str, ...], frozen: Mapping[str, float]) -> bool:
    """Move bodies to where frozen joints hold them, in place; True where one moved.

    A body's joints turn it one after the other, T_0 F_1 R_2(q) F_3: welding 1 and 3 leaves T_0 F_1 F_3 and R_2 with its
    axis as seen after F_3.
    """
    moved = False
    for body in range(1, whole.nbody):
        first, count = int(whole.body_jntadr[body]), int(whole.body_jntnum[body])
        held = _Motion([1.0, 0.0, 0.0, 0.0], np.zeros(3))
        for joint in reversed(range(first, first + count)):
            name = whole.joint(joint).name
            if name in joints:
                kept, back = model.joint(name), held.inverse()
                kept.axis[:], kept.pos[:] = back.direction(kept.axis), back.point(kept.pos)
            elif frozen.get(name, 0.0) != whole.qpos0[whole.jnt_qposadr[joint]] and name in frozen:
                held = _Motion.of_joint(whole, joint, frozen[name]).after(held)
                moved = True
        if np.any(held.rotation[1:]) or np.any(held.shift):
            place = _Motion(model.body_quat[body], model.body_pos[body]).after(held)
            model.body_quat[body], model.body_pos[body] = place.rotation, place.shift
    return moved
