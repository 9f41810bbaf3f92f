"""MuJoCo's log file never lands in the folder that a program runs in."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]

# A state that MuJoCo warns of, in MuJoCo's own loop and in a batch.
WARN = """
import numpy as np
from fo_gym.robots import robot_of
from fo_gym.plant import FlexibleJointPlant
link = robot_of("single_link")
plant = FlexibleJointPlant(link.link_side, 2, joints=link.flexible, friction=link.friction, control_dt=1e-3)
model, data = plant.to_mujoco()
data.qpos[:] = np.nan
import mujoco
mujoco.mj_step(model, data)
plant.q[0] = np.nan
plant.step(np.zeros((2, 1)), np.zeros((2, 1)))
assert data.warning[mujoco.mjtWarning.mjWARN_BADQPOS].number == 1
"""
CHOSEN = """
import mujoco
log = mujoco.MjLogConfig.get()
log.logfile = "chosen.log"
log.set()
"""


def run(program: str, folder: Path) -> str:
    """What a program says on its standard output and error, from a process of its own."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def test_a_warning_is_told_and_leaves_no_file(tmp_path: Path) -> None:
    assert "Nan, Inf or huge value in QPOS" in run(WARN, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_log_file_that_somebody_chose_is_kept(tmp_path: Path) -> None:
    run(CHOSEN + WARN, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["chosen.log"]
