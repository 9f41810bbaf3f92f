"""Cameras that are no part of a robot file: one that the mouse can move, and close-ups."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["Closeup", "closeup_of", "free_camera"]


@dataclass(frozen=True, eq=False)
class Closeup:
    """A view with a longer lens.

    Attributes:
        camera: where it is and where it looks.
        fovy: its vertical field of view [degrees].
        magnification: by how much things look larger than from the robot's own camera.
    """

    camera: mujoco.MjvCamera
    fovy: float
    magnification: float


def free_camera(model: mujoco.MjModel, data: mujoco.MjData, name: str | None) -> mujoco.MjvCamera:
    """A camera that can be moved, starting with the view of the robot file's camera, or of all where it has none."""
    free = mujoco.MjvCamera()
    if name is None:
        mujoco.mjv_defaultFreeCamera(model, free)
        return free
    fixed = data.camera(name)
    forward = -fixed.xmat.reshape(3, 3)[:, 2]
    free.distance = np.linalg.norm(model.stat.center - fixed.xpos)
    free.lookat = fixed.xpos + free.distance * forward
    _turn(free, forward)
    return free


def closeup_of(model: mujoco.MjModel, name: str | None, points: Array, shape: float, room: float) -> Closeup:
    """The view of some points alone, from where the robot's own camera stands.

    Args:
        model: of the robot.
        name: of its camera, or None.
        points: that are to be seen, (n, 3) [m].
        shape: width of the picture over its height.
        room: size of what is seen, as a multiple of the points' extent.
    """
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    camera = free_camera(model, data, name)
    turn, tilt = np.deg2rad(camera.azimuth), np.deg2rad(camera.elevation)
    forward = np.array([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)])
    place = camera.lookat - camera.distance * forward
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    camera.lookat, camera.distance = middle, np.linalg.norm(middle - place)
    forward = (middle - place) / camera.distance
    _turn(camera, forward)
    right = np.array([np.sin(np.arctan2(forward[1], forward[0])), -np.cos(np.arctan2(forward[1], forward[0])), 0.0])
    across, upwards = np.ptp(points @ right), np.ptp(points @ np.cross(right, forward))
    height = room * max(across / shape, upwards)
    own = float(model.vis.global_.fovy if name is None else model.camera(name).fovy[0])
    seen = 2.0 * camera.distance * np.tan(0.5 * np.deg2rad(own))
    fovy = float(np.rad2deg(2.0 * np.arctan(0.5 * height / camera.distance)))
    return Closeup(camera, fovy, float(seen / height))


def _turn(camera: mujoco.MjvCamera, forward: Array) -> None:
    """Let the camera look along a unit vector (3,)."""
    camera.azimuth = np.rad2deg(np.arctan2(forward[1], forward[0]))
    camera.elevation = np.rad2deg(np.arcsin(forward[2]))
