"""Pictures of a simulation, as images or in a window, with what the robot file does not show.

Beside the robot there are the motor and the spring of the single link, the target, on a tool path the reference and the
tool's trace, and a hand that guides the tool. OpenGL is asked for with the first frame, not before.
"""

from __future__ import annotations

from collections import deque
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.envs.camera import Closeup, closeup_of
from fo_gym.envs.window import Window
from fo_gym.robots import Robot
from fo_gym.simulation.simulation import Simulation

Array = NDArray[np.float64]
Colour = tuple[float, float, float, float]

HEIGHT, WIDTH = 480, 640
MAX_GEOMS = 10_000
TRACE_DT = 0.01
"""Time between two points of a trace [s]."""
TRACE_POINTS = 2000
"""A longer trace loses its beginning; every point is one of the MAX_GEOMS shapes of a scene."""
FRAME_DT = 0.02
"""Simulated time between two frames of the window [s]."""

# What is desired is green, what was done is red.
DESIRED: Colour = (0.0, 0.35, 0.15, 1.0)
TARGET: Colour = (0.0, 0.75, 0.35, 0.55)
DONE: Colour = (0.85, 0.05, 0.20, 1.0)
STEEL: Colour = (0.60, 0.63, 0.67, 1.0)
HAND: Colour = (0.87, 0.64, 0.47, 1.0)

_SHAPES = mujoco.mjtGeom
_FOOT = np.array([0.0, -0.034, -0.028])
"""Of the pointer of the single link's motor, where it meets the scale, as seen from the motor [m]."""
_MOTOR = "motor"
_SPRING = ("spring_motor", "spring_link")

__all__ = ["SceneRenderer", "open_images", "picture_of"]


def _add(scene: mujoco.MjvScene, shape: int, rgba: Colour, position: Any = (0, 0, 0), size: Any = (0, 0, 0)) -> Any:
    """A new shape in the scene, at `position` (3,) [m], its half sizes `size` (3,) [m]; it casts no shadow."""
    geom = scene.geoms[scene.ngeom]
    scene.ngeom += 1
    vectors = (np.array(vector, dtype=np.float64) for vector in (size, position, np.eye(3).ravel()))
    mujoco.mjv_initGeom(geom, int(shape), *vectors, np.array(rgba, dtype=np.float32))
    geom.category = int(mujoco.mjtCatBit.mjCAT_DECOR)
    return geom


def _add_line(scene: mujoco.MjvScene, points: Array, shape: int, width: float, rgba: Colour) -> None:
    """Join points (n, 3) [m] by capsules of radius `width` [m], or by lines of `width` [pixels]."""
    for start, end in pairwise(points):
        mujoco.mjv_connector(_add(scene, shape, rgba), int(shape), width, start, end)


def _coil(start: Array, end: Array, radius: float = 0.010, turns: int = 7) -> Array:
    """Points (n, 3) [m] of a coil about the line from `start` to `end`, straight at both ends."""
    axis = end - start
    side = np.cross(axis, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side)
    up = np.cross(side, axis) / np.linalg.norm(axis)
    turn = np.linspace(0.0, turns, 16 * turns + 1)[:, None]
    circle = radius * (np.cos(2.0 * np.pi * turn) * up + np.sin(2.0 * np.pi * turn) * side)
    coil = start + (0.1 + 0.8 * turn / turns) * axis + circle
    return np.vstack([start, start + 0.1 * axis, coil, start + 0.9 * axis, end])


def open_images(model: mujoco.MjModel, height: int, width: int) -> mujoco.Renderer:
    """A renderer of images of this size. Raises RuntimeError where there is no OpenGL."""
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    try:
        return mujoco.Renderer(model, height, width, max_geom=MAX_GEOMS)
    except mujoco.FatalError as error:
        raise RuntimeError(
            "there is no OpenGL to draw with; on a machine without display, set the environment variable MUJOCO_GL to "
            "'egl' or 'osmesa' before Python starts"
        ) from error


def picture_of(robot: Robot, height: int = HEIGHT, width: int = WIDTH) -> NDArray[np.uint8]:
    """The robot at home, from its camera or from where all of it is seen: (height, width, 3).

    Raises:
        RuntimeError: there is no OpenGL.
    """
    model = robot.link_side.scene
    data = mujoco.MjData(model)
    data.qpos[:] = robot.home
    mujoco.mj_forward(model, data)
    images = open_images(model, height, width)
    try:
        images.update_scene(data, -1 if robot.link_side.camera is None else robot.link_side.camera)
        picture: NDArray[np.uint8] = images.render()
        return picture
    finally:
        images.close()


class SceneRenderer:
    """Draws the environments of one simulation from copies of its model, so that it cannot disturb it.

    Args:
        simulation: what is to be drawn.
        render_mode: "rgb_array" or "human".
        height, width: size of an image [pixels].
    """

    def __init__(
        self, simulation: Simulation, render_mode: str | None, height: int = HEIGHT, width: int = WIDTH
    ) -> None:
        self._mode = render_mode
        self._height, self._width = height, width
        self._camera = simulation.robot.link_side.camera
        self._tool = simulation.robot.tool
        self._model = simulation.robot.link_side.scene
        self._data = mujoco.MjData(self._model)
        self._elsewhere = mujoco.MjData(self._model)
        names = {self._model.body(i).name for i in range(self._model.nbody)}
        self._motor = int(self._model.body(_MOTOR).mocapid[0]) if _MOTOR in names else -1
        self._motor_rest = self._data.mocap_pos[self._motor].copy() if self._motor >= 0 else np.zeros(3)
        names = {self._model.site(i).name for i in range(self._model.nsite)}
        self._has_spring = names.issuperset(_SPRING)
        self._trace_ticks = max(1, round(TRACE_DT / simulation.settings.control_dt))
        self._frame_ticks = max(1, round(FRAME_DT / simulation.settings.control_dt))
        self._traces: list[deque[Array]] = [deque(maxlen=TRACE_POINTS) for _ in range(simulation.num_envs)]
        self._traced = np.full(simulation.num_envs, -self._trace_ticks)
        self._drawn = -self._frame_ticks
        self._images: Any = None
        self._window: Window | None = None

    def watch(self, simulation: Simulation, draw: bool = False) -> None:
        """Take note of a step: remember where the tool is and, with `draw`, keep the window up to date."""
        if simulation.control.path is not None:
            since = simulation.ticks - self._traced
            for i in np.flatnonzero(since < 0):
                self._traces[i].clear()
            for i in np.flatnonzero((since < 0) | (since >= self._trace_ticks)):
                self._traces[i].append(self._tool_at(simulation.plant.q[i]))
                self._traced[i] = simulation.ticks[i]
        if draw and not 0 <= simulation.ticks[0] - self._drawn < self._frame_ticks:
            self.frame(simulation)

    def clear_trace(self) -> None:
        """Forget where the tool has been."""
        for trace in self._traces:
            trace.clear()
        self._traced[:] = -self._trace_ticks

    def followed(self, simulation: Simulation, i: int = 0) -> Array:
        """What is worth a close-up in environment i: the foot of the motor's pointer, or the tool; (3,), m."""
        if self._motor >= 0:
            return self._on_rail(simulation.plant.theta[i]) + _FOOT
        return self._tool_at(simulation.plant.q[i])

    def closeup(self, points: Array, room: float = 1.4) -> Closeup:
        """The view of these points (n, 3) [m] alone, with so much room around them."""
        shape = self._width / self._height
        return closeup_of(self._model, self._camera, points, shape, room)

    def frame(self, simulation: Simulation, i: int = 0, closeup: Closeup | None = None) -> NDArray[np.uint8] | None:
        """Draw environment i as it is now; an image, where asked for, as a close-up.

        Returns:
            Image (height, width, 3) of uint8 in the "rgb_array" mode; None in the "human" mode.

        Raises:
            RuntimeError: there is no OpenGL, or no display.
        """
        self._drawn = int(simulation.ticks[0])
        self._data.qpos[:] = simulation.plant.q[i]
        if self._motor >= 0:
            self._data.mocap_pos[self._motor] = self._on_rail(simulation.plant.theta[i])
        mujoco.mj_forward(self._model, self._data)
        if self._mode == "human":
            if self._window is None:
                self._window = Window(self._model, self._data, self._camera)
            self._window.draw(lambda scene: self._decorate(scene, simulation, i))
            return None
        if self._images is None:
            self._images = open_images(self._model, self._height, self._width)
        camera: Any = -1 if self._camera is None else self._camera
        own = self._model.vis.global_.fovy
        if closeup is not None:
            camera, self._model.vis.global_.fovy = closeup.camera, closeup.fovy
        # The headlight follows the camera of the update before: the second makes frames independent of each other.
        for _ in range(2):
            self._images.update_scene(self._data, camera)
        self._model.vis.global_.fovy = own
        self._decorate(self._images.scene, simulation, i)
        image: NDArray[np.uint8] = self._images.render()
        return image

    def _on_rail(self, theta: Array) -> Array:
        """Where the motor is at theta (1,), on a rail along the world's x: (3,), m."""
        position: Array = self._motor_rest + np.array([theta[0], 0.0, 0.0])
        return position

    def _tool_at(self, q: Array) -> Array:
        """Tool position in the world with the links at q (dof,): (3,), m."""
        self._elsewhere.qpos[:] = q
        mujoco.mj_kinematics(self._model, self._elsewhere)
        return np.array(self._elsewhere.site(self._tool).xpos)

    def _desired_tool(self, simulation: Simulation, i: int) -> Array:
        """Where the tool of environment i should be now: (3,), m."""
        links = simulation.control.desired_links(i)
        reference: Array = simulation.control.reference[i] if links is None else self._tool_at(links)
        return reference

    def _decorate(self, scene: mujoco.MjvScene, simulation: Simulation, i: int) -> None:
        """Add to the scene what the robot file does not show."""
        if self._has_spring:
            coil = _coil(*(self._data.site(name).xpos for name in _SPRING))
            _add_line(scene, coil, _SHAPES.mjGEOM_CAPSULE, 0.0013, STEEL)
        if self._motor >= 0:
            # A pin in front of the motor block, so that the block's pointer can be read against it.
            x, y, z = self._on_rail(simulation.control.theta_d[i])
            _add(scene, _SHAPES.mjGEOM_BOX, TARGET, (x, y - 0.034, z), (0.0012, 0.0008, 0.042))
            _add(scene, _SHAPES.mjGEOM_SPHERE, TARGET, (x, y - 0.034, z + 0.044), (0.004, 0.004, 0.004))
        pixel = self._height / HEIGHT
        if simulation.control.path is not None:
            path = simulation.control.path[:: 5 * self._trace_ticks]
            _add_line(scene, path, _SHAPES.mjGEOM_LINE, 1.5 * pixel, DESIRED)
            _add_line(scene, np.array(self._traces[i]), _SHAPES.mjGEOM_LINE, 3.5 * pixel, DONE)
        if self._tool is not None:
            _add(scene, _SHAPES.mjGEOM_SPHERE, TARGET, self._desired_tool(simulation, i), (0.008, 0.008, 0.008))
        hands = simulation.hands
        if hands is not None and hands.held[i] > 0.0:
            # The hand's own point, joined to the tool by its spring.
            _add(scene, _SHAPES.mjGEOM_SPHERE, HAND, hands.point[i], (0.02, 0.02, 0.02))
            ends = np.array([hands.point[i], self._tool_at(simulation.plant.q[i])])
            _add_line(scene, ends, _SHAPES.mjGEOM_CAPSULE, 0.005, HAND)

    def close(self) -> None:
        """Close the window and release OpenGL; closing twice is allowed."""
        for opened in (self._images, self._window):
            if opened is not None:
                opened.close()
        self._images = self._window = None
