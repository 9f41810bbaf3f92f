"""The oracle's arm on MuJoCo's own forward dynamics: for robot files with springs, dampers and armature."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from fo_gym.certificate.oracle import Arm


class MujocoArm(Arm):
    """Link accelerations and gravity by MuJoCo's forward dynamics."""

    def __init__(self, path: Path, joint: Any, friction: Any) -> None:
        self.joint, self.friction = joint, friction
        self.model = mujoco.MjModel.from_xml_path(str(path))
        off = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT
        self.model.opt.disableflags |= int(off)
        self.data = mujoco.MjData(self.model)

    def acceleration(self, q: np.ndarray, w: np.ndarray, torque: np.ndarray) -> np.ndarray:
        self.data.qpos[:], self.data.qvel[:], self.data.qfrc_applied[:] = q, w, torque
        mujoco.mj_forward(self.model, self.data)
        return self.data.qacc

    def gravity(self, q: np.ndarray) -> np.ndarray:
        self.acceleration(q, np.zeros_like(q), np.zeros_like(q))
        return self.data.qfrc_bias.copy()


def dense_inertia(arm: Arm, q: np.ndarray) -> np.ndarray:
    """M(q) column by column: a unit torque's acceleration less none's is a column of its inverse."""
    still = np.zeros_like(q)
    free = arm.acceleration(q, still, still).copy()
    return np.linalg.inv(np.array([arm.acceleration(q, still, unit) - free for unit in np.eye(len(q))]).T)
