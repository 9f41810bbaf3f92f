"""A stranger's working directory, and commands as they are given there."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import pytest
from typer.testing import CliRunner

import fo_gym
from fo_gym.cli import app

MINE = """\
import numpy as np


class Mine:
    feedback = "measured"

    def __init__(self, bandwidth=80.0, sign=1.0):
        self.bandwidth, self.sign = bandwidth, sign

    def reset(self, joints, num_envs):
        self.gain = self.sign * self.bandwidth * joints.motor_inertia
        self.ticks = 0

    def estimate(self, signals):
        return -self.gain * (signals.theta_n_dot - signals.theta_dot)


class Broken(Mine):
    def estimate(self, signals):
        return np.linalg.inv(np.zeros((2, 2)))


class Late(Mine):
    def estimate(self, signals):
        self.ticks += 1
        if self.ticks > 60:
            raise KeyError("no [/such] key in [red]")
        return super().estimate(signals)


class Undecided(Mine):
    feedback = "both"
"""

TINY = """
name = "tiny"
split = "validation"
seeds = 1
environments = ["FJRSquare-v0"]
variants = ["nominal"]
compensators = ["mine.py:Mine"]
"""


@contextmanager
def strangers_folder(folder: Path) -> Iterator[Path]:
    """The folder, with files of a stranger, as the current one."""
    (folder / "mine.py").write_text(MINE, encoding="utf-8")
    (folder / "tiny.toml").write_text(TINY, encoding="utf-8")
    (folder / "[notes].toml").write_text(TINY.replace('"tiny"', "7 +"), encoding="utf-8")
    (folder / "syntax.py").write_text("class Mine(:\n", encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield folder


class Outcome(NamedTuple):
    """What a command printed, without colours, and its exit code."""

    code: int
    out: str
    err: str


def run(*arguments: str) -> Outcome:
    """Outcome of the command; a traceback is at most that of a user's own lines."""
    result = CliRunner().invoke(app, list(arguments))
    assert f'File "{Path(fo_gym.__file__).parent}' not in result.output
    assert result.exception is None or isinstance(result.exception, SystemExit), repr(result.exception)
    out, err = (re.sub(r"\x1b\[[0-9;]*m", "", text) for text in (result.stdout, result.stderr))
    return Outcome(result.exit_code, out, err)


def written(folder: Path) -> set[Path]:
    return {path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
