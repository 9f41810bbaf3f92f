"""What all tests share: drawing without a display, unless the caller chose it, a small robot, files, short episodes."""

import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import gymnasium as gym
import pytest
from hypothesis import HealthCheck, settings

os.environ.setdefault("MUJOCO_GL", "egl")

from entries import Write, write_files
from pendulum import MakeRobot, write_pendulum

import fo_gym

# Neither the machine's load nor an earlier run decides what Hypothesis tries, or how long it may take.
settings.register_profile(
    "repeatable", deadline=None, derandomize=True, database=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("repeatable")


@pytest.fixture
def pendulum(tmp_path: Path) -> MakeRobot:
    """Writes a two-link pendulum with the given attributes into the test's folder, and names its joints."""
    return partial(write_pendulum, tmp_path)


@pytest.fixture(scope="module")
def short_episodes() -> Iterator[None]:
    """Episodes of 1 s on every environment, in this process alone: for tests of the machinery around them."""
    with pytest.MonkeyPatch.context() as patch:
        for env_id in fo_gym.ENVIRONMENTS:
            patch.setitem(gym.spec(env_id).kwargs, "duration", 1.0)
        yield


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    """Writes files into a folder beside the working directory, and names the first."""
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    return partial(write_files, tmp_path)


@pytest.fixture(scope="module")
def one_torch_thread() -> Iterator[None]:
    """Networks as small as ours are faster on one, and a loaded machine lets the others wait in a busy loop."""
    import torch  # noqa: PLC0415 (slow)

    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)
