"""What all tests share: a way to draw without a display, unless the caller chose another, and a small robot."""

import os
from functools import partial
from pathlib import Path

import pytest

os.environ.setdefault("MUJOCO_GL", "egl")

from pendulum import MakeRobot, write_pendulum


@pytest.fixture
def pendulum(tmp_path: Path) -> MakeRobot:
    """Writes a two-link pendulum with the given attributes into the test's folder, and names its joints."""
    return partial(write_pendulum, tmp_path)
