"""PLACEHOLDER for the design of what is not given, until `fo_gym.robots.home` and `design` take its place."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.parameters import FlexibleJoint, LuGre

Array = NDArray[np.float64]

__all__ = ["designed_friction", "designed_joints", "found_home"]


def found_home(model: mujoco.MjModel, tool: str | None, redundant: tuple[str, ...]) -> Array:
    """The middle of the range."""
    del tool, redundant
    return np.where(model.jnt_limited.astype(bool), model.jnt_range.mean(axis=1), 0.0)


def designed_joints(model: mujoco.MjModel, home: Array, armature: Array, torque_limit: Array) -> FlexibleJoint:
    """Rotor inertias like the links'."""
    data = mujoco.MjData(model)
    data.qpos[:] = home
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    links = np.diagonal(inertia)
    motor = np.where(armature > 0.0, armature, np.maximum(links, 1e-4))
    load = np.maximum(np.abs(data.qfrc_bias), links)
    limit = np.where(np.isnan(torque_limit), 10.0 * load, torque_limit)
    return FlexibleJoint(3000.0 * np.minimum(motor, links), 0.0, motor, limit)


def designed_friction(joints: FlexibleJoint, frictionloss: Array) -> LuGre:
    """A share of the torque limit."""
    dry = np.where(frictionloss > 0.0, frictionloss, 0.03 * np.asarray(joints.torque_limit))
    sigma_0 = dry / 1e-4
    return LuGre(sigma_0, np.sqrt(sigma_0 * joints.motor_inertia), 1.25 * dry, dry, 1.5 * dry, 0.01)
