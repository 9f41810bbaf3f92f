"""Where the links are and what holds them still: kinematics and gravity of a link side.

MuJoCo says once where axes, masses and tool are when all joints are at their reference; the screws of
`fo_gym.plant.screws` take them elsewhere. MuJoCo's own passes, which do much more, are for the motion.
"""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.plant.screws import (
    ANCHOR,
    AXIS,
    BEFORE,
    COLUMNS,
    LEADS,
    MASS,
    MOMENT,
    REST,
    SLIDES,
    SPRING,
    gravity_torques,
    tool_poses,
    tool_positions,
)
from fo_gym.robots import LinkSide

Array = NDArray[np.float64]

__all__ = ["Links", "ToolPose"]


class ToolPose(NamedTuple):
    """Tool frame in the world.

    Attributes:
        position: (n, 3), m.
        rotation: (n, 3, 3), columns are the tool's axes.
        jacobian: (n, 6, dof), rows are linear, then angular velocity, per joint velocity.
    """

    position: Array
    rotation: Array
    jacobian: Array


class Links:
    """Kinematics and gravity of a link side, with the masses of its file.

    Attributes:
        joints: what is known of each, (dof, columns), see `fo_gym.plant.screws`.
        world: the acceleration of gravity [m/s^2]; the tool's place [m] and its three axes, one after the other, where
            all joints are at their reference, NaN without a tool; (5, 3).
        reference: of the joints, (dof,) [m | rad].
    """

    def __init__(self, link_side: LinkSide) -> None:
        model = link_side.model
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        self.reference = model.qpos0.copy()
        self.joints = _joints(model, data)
        self.world = np.full((5, 3), np.nan)
        off = int(model.opt.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
        self.world[0] = 0.0 if off else model.opt.gravity
        if link_side.tool is not None:
            site = model.site(link_side.tool)
            self.world[1], self.world[2:] = data.site_xpos[site.id], data.site_xmat[site.id].reshape(3, 3).T
            last = _last_joint(model, int(site.bodyid[0]))
            while last >= 0:
                self.joints[last, LEADS] = 1.0
                last = int(self.joints[last, BEFORE]) - 1

    def gravity(self, q: Array, mass: Array | float = 1.0) -> Array:
        """Torque g(q), (n, dof), N or N m, that holds the links still: gravity, less the file's own joint springs.

        Args:
            q: joint positions, (n, dof), m | rad.
            mass: factor on the masses of the file, (n,) or a number.
        """
        torque = np.empty(q.shape)
        masses = np.full(len(q), mass)
        gravity_torques(self.joints, self.world, self.reference, np.ascontiguousarray(q), masses, torque)
        return torque

    def tool_position(self, q: Array) -> Array:
        """Tool position in the world at q (n, dof): (n, 3), m."""
        position = np.empty((len(q), 3))
        tool_positions(self.joints, self.world, self.reference, np.ascontiguousarray(q), position)
        return position

    def tool_pose(self, q: Array) -> ToolPose:
        """Tool frame and Jacobian at q (n, dof)."""
        n, dof = q.shape
        pose = ToolPose(np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((n, 6, dof)))
        tool_poses(self.joints, self.world, self.reference, np.ascontiguousarray(q), *pose)
        return pose


def _last_joint(model: mujoco.MjModel, body: int) -> int:
    """The last joint that moves a body; -1 where none does."""
    while body > 0 and model.body_jntnum[body] == 0:
        body = int(model.body_parentid[body])
    return int(model.body_jntadr[body] + model.body_jntnum[body]) - 1 if body > 0 else -1


def _joints(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    joints = np.zeros((model.njnt, COLUMNS))
    joints[:, AXIS:ANCHOR], joints[:, ANCHOR:MOMENT] = data.xaxis, data.xanchor
    joints[:, SLIDES] = model.jnt_type == int(mujoco.mjtJoint.mjJNT_SLIDE)
    joints[:, SPRING] = model.jnt_stiffness
    joints[:, SPRING + 1 : REST] = model.jnt_stiffnesspoly
    joints[:, REST] = model.qpos_spring
    for body in range(1, model.nbody):
        last = _last_joint(model, body)
        if last >= 0:
            weight = model.body_mass[body] * (1.0 - model.body_gravcomp[body])
            joints[last, MASS] += weight
            joints[last, MOMENT:MASS] += weight * data.xipos[body]
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        for joint in range(first, first + count):
            above = _last_joint(model, int(model.body_parentid[body])) if joint == first else joint - 1
            joints[joint, BEFORE] = above + 1
    return joints
