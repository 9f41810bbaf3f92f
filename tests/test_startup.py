"""What is imported when: the package and its help are there at once, and what is heavy comes when it is needed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import fo_gym
from fo_gym.cli import _OWN

ROOT = Path(__file__).parents[1]
HEAVY = ("joblib", "matplotlib", "mujoco", "numba", "optuna", "pandas", "ray", "scipy", "stable_baselines3", "torch")
IMPORTED = """
import json, sys
{program}
print(json.dumps(sorted({{name.partition(".")[0] for name in sys.modules}})), file=sys.stderr)
"""
HELP = """
from fo_gym.cli import app
try:
    app({arguments!r})
except SystemExit as end:
    assert end.code == {code}, end.code
"""


def imported(program: str, folder: Path) -> set[str]:
    """Top-level packages that a program leaves imported; it runs in a process of its own."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", IMPORTED.format(program=program)]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stderr.splitlines()[-1]))


def test_the_package_is_light(tmp_path: Path) -> None:
    assert imported("import fo_gym", tmp_path) & {*HEAVY, "rich", "typer", "baselines"} == set()


def test_help_is_light(tmp_path: Path) -> None:
    """That of all commands together, and that of each of ours; plug-ins are listed without being imported."""
    programs = {"all": HELP.format(arguments=["--help"], code=0)}
    programs["each"] = "\n".join(HELP.format(arguments=[name, "--help"], code=0) for name in _OWN)
    found = {name: imported(program, tmp_path) & {*HEAVY, "baselines"} for name, program in programs.items()}
    assert found == {"all": set(), "each": set()}


def test_what_is_misspelt_is_told_before_anything_heavy_is_imported(tmp_path: Path) -> None:
    wrong = [
        "evaluate nobody",
        "evaluate pid-high --env Nothing-v0",
        "evaluate pid-high --gains L=a",
        "evaluate pid-high --gains Lx=1",
        "sweep pid-high --gains L=a",
        "sweep pid-high --gains L=1,2 --variant wild",
        "leaderboard --protocol nothing.toml",
    ]
    program = "\n".join(HELP.format(arguments=line.split(), code=2) for line in wrong)
    assert imported(program, tmp_path) & set(HEAVY) == set()


def test_names_that_come_later_are_public_as_the_others() -> None:
    assert set(fo_gym.__all__) <= set(dir(fo_gym))
    for name in ("evaluate", "sweep", "Settings", "Randomization"):
        assert getattr(fo_gym, name) is getattr(fo_gym, name)
        assert getattr(fo_gym, name).__name__ == name
    with pytest.raises(AttributeError, match="module 'fo_gym' has no attribute 'nothing'"):
        fo_gym.nothing  # noqa: B018
    with pytest.raises(ImportError, match="cannot import name 'nothing'"):
        from fo_gym import nothing  # type: ignore[attr-defined] # noqa: F401, PLC0415
