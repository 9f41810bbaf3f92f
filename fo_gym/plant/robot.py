"""A robot: the link side as an ordinary MJCF or URDF file, and which of its joints are driven."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

__all__ = ["Robot", "home_pose", "load_model", "switch_off_constraints"]


@dataclass(frozen=True)
class Robot:
    """The link side of a robot.

    Attributes:
        path: MJCF or URDF file. It knows nothing of motors and friction.
        joints: names of the flexible joints, in the file's order: all the joints that the file has.
        tool: name of the site that a task-space controller moves, or None.
        camera: name of the camera to render from, or None for MuJoCo's free camera.
    """

    path: Path
    joints: tuple[str, ...]
    tool: str | None = None
    camera: str | None = None

    @property
    def dof(self) -> int:
        """Number of joints."""
        return len(self.joints)


def load_model(robot: Robot) -> mujoco.MjModel:
    """Compile the link side and switch off what the suite leaves out: contacts and constraints.

    Joint limits stay in the model as data; the environments end an episode at them.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: the file has joints, constraints or actuators that the plant cannot represent.
    """
    if not Path(robot.path).is_file():
        raise FileNotFoundError(f"robot file {robot.path} does not exist")
    model = mujoco.MjModel.from_xml_path(str(robot.path))
    names = tuple(model.joint(i).name for i in range(model.njnt))
    scalar = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
    if not set(model.jnt_type.tolist()) <= scalar:
        raise ValueError(f"{robot.path}: every joint must be a hinge or a slide; fix free and ball joints to the world")
    if names != tuple(robot.joints):
        raise ValueError(f"{robot.path}: joints are {names}, in this order, but the robot names {robot.joints}")
    if model.nu or model.neq or model.ntendon:
        raise ValueError(f"{robot.path}: remove actuators, equalities and tendons; motors are added by the plant")
    if model.dof_frictionloss.any():
        raise ValueError(f"{robot.path}: remove frictionloss; friction is given as LuGre parameters")
    if robot.tool is not None:
        model.site(robot.tool)  # raises KeyError, naming the sites there are
    switch_off_constraints(model)
    return model


def switch_off_constraints(model: mujoco.MjModel) -> None:
    """No contacts and no constraints, in place."""
    off = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.disableflags |= int(off)


def home_pose(robot: Robot) -> NDArray[np.float64]:
    """Joint positions of the file's keyframe "home", (dof,), m or rad."""
    return np.array(load_model(robot).key("home").qpos)
