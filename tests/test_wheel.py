"""The wheel, installed into an empty environment, away from the sources: what a user gets from `pip install fo-gym`."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import NamedTuple
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).parents[1]
HIDDEN = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "FORCE_COLOR", "MUJOCO_GL")

STEP = """
import gymnasium as gym, fo_gym
env = gym.make("FJRStiction-v0")
obs, info = env.reset(seed=0)
obs, reward, terminated, truncated, info = env.step([0.5])
print(obs.shape, terminated, truncated, fo_gym.__file__)
"""

SCORE = """
import fo_gym
print(*(fo_gym.evaluate(name, "FJRSquare-v0", duration=0.5)["frr"].item() for name in ("none", "pid-high", "ideal")))
"""


class Installed(NamedTuple):
    """The wheel, the `bin` of the environment that it is installed in, and an empty folder."""

    wheel: Path
    scripts: Path
    elsewhere: Path

    def run(self, script: str, *arguments: str) -> str:
        """Output of a command of that environment, run in the empty folder."""
        return run(str(self.scripts / script), *arguments, cwd=self.elsewhere)


def run(*command: str, cwd: Path) -> str:
    environment = {name: value for name, value in os.environ.items() if name not in HIDDEN}
    done = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    folder = tmp_path_factory.mktemp("wheel")
    clutter = shutil.ignore_patterns(".*", "__pycache__", "build", "dist", "leaderboard")
    shutil.copytree(ROOT, folder / "source", ignore=clutter)
    run(sys.executable, "-m", "build", "--wheel", "--outdir", str(folder), cwd=folder / "source")
    (wheel,) = folder.glob("*.whl")
    run(sys.executable, "-m", "venv", str(folder / "environment"), cwd=folder)
    scripts = next(path for name in ("bin", "Scripts") if (path := folder / "environment" / name).is_dir())
    (folder / "elsewhere").mkdir()
    result = Installed(wheel, scripts, folder / "elsewhere")
    result.run(
        "python", "-m", "pip", "install", "--no-compile", "--constraint", str(ROOT / "constraints.txt"), str(wheel)
    )
    return result


@pytest.mark.slow
def test_the_wheel_works_where_there_is_nothing_else(installed: Installed) -> None:
    files = set(ZipFile(installed.wheel).namelist())
    packages = {name for name in {path.partition("/")[0] for path in files} if not name.endswith(".dist-info")}
    assert packages == {"baselines", "envs_assets", "fo_gym"}
    sources = [path for package in packages for path in (ROOT / package).rglob("*") if path.is_file()]
    assert {str(path.relative_to(ROOT)) for path in sources if "__pycache__" not in path.parts} <= files

    listed = installed.run("fo-gym", "list")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for name in ("none", "ideal", *project["entry-points"]["fo_gym.compensators"]):
        assert f"compensator  {name}\n" in listed
    for name in ("FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"):
        assert f"environment  {name} (" in listed

    *step, file = installed.run("python", "-c", STEP).split()
    assert step == ["(9,)", "False", "False"]
    assert Path(file).is_relative_to(installed.scripts.parent)

    none, observer, ideal = map(float, installed.run("python", "-c", SCORE).split())
    assert (none, ideal) == (0.0, 1.0)
    assert 0.5 < observer < 1.0
    assert not list(installed.elsewhere.iterdir())
