"""The window, on a virtual display, and what happens where there is no display; each in a Python of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.looks


ROOT = Path(__file__).parents[1]


def run(program, folder, **environment):
    """Run a program in a Python of its own, with nothing but these variables about displays and OpenGL.

    MuJoCo leaves a log of errors in the working directory: `folder`.
    """
    hidden = ("DISPLAY", "WAYLAND_DISPLAY", "MUJOCO_GL")
    variables = {name: value for name, value in os.environ.items() if name not in hidden}
    return subprocess.run(
        [sys.executable, "-c", program],
        cwd=folder,
        env={**variables, "PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        check=False,
    )


WITHOUT_DISPLAY = """
import sys, gymnasium as gym, fo_gym
for mode in (None, "rgb_array"):
    env = gym.make("FJRSquare-v0", render_mode=mode)
    env.reset(seed=0)
    env.step(0.0 * env.action_space.high)
assert "mujoco.viewer" not in sys.modules
for draw in (env.render, gym.make("FJRStiction-v0", render_mode="human").reset):
    try:
        draw()
    except RuntimeError as error:
        print(error)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="only on Linux can there be no display")
def test_without_display_it_runs_and_says_what_drawing_needs(tmp_path):
    result = run(WITHOUT_DISPLAY, tmp_path)
    assert result.returncode == 0, result.stderr
    assert "MUJOCO_GL" in result.stdout
    assert "DISPLAY" in result.stdout


IN_A_WINDOW = """
import threading, gymnasium as gym, fo_gym
env = gym.make("FJRSquare-v0", render_mode="human")
def window():
    return env.unwrapped._renderer._window
env.reset(seed=0)
first = window()
assert first.is_open
for _ in range(60):
    env.step(0.0 * env.action_space.high)
assert env.render() is None and window() is first
env.close()
env.close()
assert not first.is_open and threading.active_count() == 1
env.reset(seed=0)
window()._handle.close()  # what the viewer does when the user closes it
for _ in range(60):
    env.step(0.0 * env.action_space.high)
env.reset(seed=0)
assert not window().is_open
env.close()
env.reset(seed=0)
print("the last one is left open")
"""


@pytest.fixture
def display():
    """A virtual display, (":number")."""
    if shutil.which("Xvfb") is None:
        pytest.skip("the window is NOT tested: there is no Xvfb (Debian: apt-get install xvfb)")
    reading, writing = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(writing)], pass_fds=[writing], stderr=subprocess.DEVNULL)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        number = pipe.readline().strip()
    yield f":{number}"
    server.terminate()
    server.wait()


@pytest.mark.slow
def test_window_opens_and_closes(display, tmp_path):
    result = run(IN_A_WINDOW, tmp_path, DISPLAY=display)
    assert result.returncode == 0, result.stderr
    assert "left open" in result.stdout
    assert "Error" not in result.stderr
