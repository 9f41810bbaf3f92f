"""The README and the examples do what they say."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import gymnasium as gym
import pytest

import fo_gym

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def run(*arguments: str) -> str:
    """Standard output of a script of the repository."""
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("page", ["README.md", "docs/learning.md", "docs/processors.md"])
def test_the_tables_are_the_published_ones(page: str) -> None:
    program = f"import tables; print(tables.page({page!r}), end='')"
    published = (ROOT / page).read_text(encoding="utf-8")
    assert run("-c", f"import sys; sys.path.insert(0, 'docs'); {program}") == published


@pytest.mark.slow
def test_the_compensator_of_the_readme_is_scored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine.py").write_text(BLOCKS[0], encoding="utf-8")
    assert len(BLOCKS[0].strip().splitlines()) <= 12
    monkeypatch.chdir(tmp_path)
    rows = fo_gym.evaluate("mine.py:Mine", "FJRStiction-v0")
    # It knows the Coulomb friction, but neither stiction nor the bristle.
    assert 0.8 < rows["frr"][0] < fo_gym.evaluate("pid-high", "FJRStiction-v0")["frr"][0]


def test_the_environments_of_the_readme_run() -> None:
    names: dict[str, object] = {}
    (block,) = [block for block in BLOCKS if "gym.make_vec" in block]
    exec(block, names)
    rows, grid, envs = names["rows"], names["grid"], names["envs"]
    assert len(rows) == 5  # type: ignore[arg-type]
    assert grid[["L", "Lp"]].to_numpy().tolist() == [[L, Lp] for L in (50, 100, 200) for Lp in (20, 30)]  # type: ignore[index]
    assert isinstance(envs, gym.vector.VectorEnv)
    assert envs.num_envs == 256


@pytest.mark.slow
def test_the_robot_and_the_task_of_the_readme() -> None:
    """In a process of its own: it registers an environment."""
    (block,) = [block for block in BLOCKS if "fo_gym.register" in block]
    robot, score = run("-c", f"{block}\nprint(rows['robot'][0], rows['frr'][0])").split()
    assert robot == "two_links"
    assert float(score) > 0.8


def test_the_readme_names_every_argument_of_an_environment() -> None:
    (listed,) = re.findall(r"Arguments of every\s+environment: (.*?);\s+they are", README, re.DOTALL)
    assert re.findall(r"`(\w+)`", listed) == [*(each.name for each in fields(fo_gym.Settings)), "render_mode"]


def test_every_file_that_the_pages_name_exists() -> None:
    for page in (
        "README.md",
        "CONTRIBUTING.md",
        "docs/agents.md",
        "docs/learning.md",
        "docs/api.md",
        "docs/protocol.md",
        "docs/processors.md",
        "docs/robots.md",
        "envs_assets/README.md",
        "docs/security.md",
        "docs/maps.md",
    ):
        text = (ROOT / page).read_text(encoding="utf-8")
        named = re.findall(r"\]\(([^)#:]+)\)", text) + re.findall(
            r"`((?:fo_gym|baselines|tests|examples)/[\w./]+)`", text
        )
        missing = [
            name for name in named if not (ROOT / name).exists() and not (ROOT / page).parent.joinpath(name).exists()
        ]
        assert missing == [], page


@pytest.mark.slow
def test_the_example_of_a_robot() -> None:
    scores = [float(line.split()[2]) for line in run("examples/own_robot.py").splitlines()]
    assert scores[0] == 0.0
    assert 0.5 < scores[1] < scores[2] < 1.0


@pytest.mark.slow
def test_the_example_of_a_compensator() -> None:
    rows = fo_gym.evaluate(f"{ROOT / 'examples' / 'bang_bang.py'}:BangBang", "FJRStiction-v0")
    assert rows["status"].tolist() == ["ok"]
    assert rows["frr"][0] > 0.8


@pytest.mark.slow
def test_the_example_of_training() -> None:
    assert re.search(r"mean return .* before, .* after 500 steps", run("examples/train_sb3.py", "--steps", "500"))
