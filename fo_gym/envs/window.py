"""The window of the "human" mode."""

from __future__ import annotations

import atexit
import sys
import threading
import warnings
import weakref
from collections.abc import Callable
from typing import Any

import mujoco

from fo_gym.envs.camera import free_camera

__all__ = ["Window"]


def _check_display() -> None:
    """MuJoCo's viewer ends the whole process where it finds no display: ask first."""
    import glfw  # noqa: PLC0415

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if not glfw.init():
            raise RuntimeError("render_mode is 'human', but there is no display: set DISPLAY, or use 'rgb_array'")


class Window:
    """MuJoCo's viewer. The user may close it at any time; it is then left closed."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, camera: str | None) -> None:
        if sys.platform == "linux":
            _check_display()
        from mujoco import viewer  # noqa: PLC0415

        if camera is not None:
            model.vis.global_.fovy = model.camera(camera).fovy[0]
        before = threading.enumerate()
        self._handle = viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False)
        threads = [thread for thread in threading.enumerate() if thread not in before]
        if camera is not None:
            start = free_camera(model, data, camera)
            with self._handle.lock():
                for name in ("distance", "lookat", "azimuth", "elevation"):
                    setattr(self._handle.cam, name, getattr(start, name))
        # When Python ends, MuJoCo shuts GLFW down, which crashes if a viewer's thread still draws. What is
        # registered last runs first: an environment that nobody closed is closed before that.
        self.close = weakref.finalize(self, self._end, self._handle, threads)
        atexit.register(self.close)

    @staticmethod
    def _end(handle: Any, threads: list[threading.Thread]) -> None:
        handle.close()
        for thread in threads:
            thread.join(timeout=5.0)

    @property
    def is_open(self) -> bool:
        """Whether the window is there: neither `close` nor the user has closed it."""
        return bool(self._handle.is_running())

    def draw(self, decorate: Callable[[mujoco.MjvScene], None]) -> None:
        """Show the data as they are, and what `decorate` adds to a scene."""
        if not self.is_open:
            return
        with self._handle.lock():
            self._handle.user_scn.ngeom = 0
            decorate(self._handle.user_scn)
        self._handle.sync()
