"""RL-Zoo itself runs the hyperparameters of examples/rl_zoo.

`make test-zoo` installs it, in versions of its own, and runs this.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from baselines.rl.study.recipe import SOURCES

pytestmark = pytest.mark.zoo

ROOT = Path(__file__).parents[2]
ENV_ID = "FJRStiction-v0"


@pytest.mark.parametrize("algo", SOURCES)
def test_rl_zoo_runs_them(algo: str, tmp_path: Path) -> None:
    """Unchanged, but for the length and for rollouts that are no longer."""
    recipe = ROOT / "examples" / "rl_zoo" / f"{algo}.yml"
    command = [sys.executable, "-m", "rl_zoo3.train", "--algo", algo, "--env", ENV_ID]
    command += ["--gym-packages", "fo_gym", "--conf-file", str(recipe), "--log-folder", str(tmp_path)]
    command += ["--n-timesteps", "64", "--eval-freq", "-1", "--device", "cpu", "--seed", "0", "--num-threads", "1"]
    if algo.startswith("ppo"):
        command += ["--hyperparams", "n_envs:2", "n_steps:32", "batch_size:32"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / algo / f"{ENV_ID}_1" / f"{ENV_ID}.zip").is_file()
