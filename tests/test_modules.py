"""Files of a user, imported: one module for each, whatever is taken of it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from fo_gym import make_compensator
from fo_gym.envs.registry import ENVIRONMENTS, environment_of, sources
from fo_gym.modules import module_name

BOTH = """
import numpy as np
import fo_gym


class Mine:
    feedback = "measured"

    def reset(self, joints, num_envs):
        self.shape = num_envs, joints.dof

    def estimate(self, signals):
        return np.zeros(self.shape)


fo_gym.register("BothInOneFile-v0", "miro_like", fo_gym.Task(fo_gym.Step(size=0.05), duration=1.0))
"""


def test_a_file_with_a_compensator_and_an_environment_is_one_module(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whichever is asked for first, the source of the environment is the file, which a worker can import."""
    monkeypatch.setattr("fo_gym.envs.registry.ENVIRONMENTS", dict(ENVIRONMENTS))
    path = tmp_path / "both.py"
    path.write_text(BOTH, encoding="utf-8")
    compensator = make_compensator(f"{path}:Mine")
    assert environment_of(f"{path}:BothInOneFile-v0").source == str(path)
    assert sources() == (str(path),)
    assert type(compensator).__module__ == module_name(path)
    assert sys.modules[module_name(path)].__file__ == str(path)
