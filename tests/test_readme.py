"""The README and the examples do what they say."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest
from test_docs_code import MADE, PAGES

import fo_gym

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def run(*arguments: str) -> str:
    """Standard output of a script of the repository."""
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_tables_are_the_published_ones() -> None:
    program = "print([name for name in tables.PAGES if tables.page(name) != (tables.ROOT / name).read_text('utf-8')])"
    assert run("-c", f"import sys; sys.path.insert(0, 'docs'); import tables; {program}") == "[]\n"


@pytest.mark.slow
def test_the_compensator_of_the_readme_is_scored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine.py").write_text(BLOCKS[0], encoding="utf-8")
    assert len(BLOCKS[0].strip().splitlines()) <= 12
    monkeypatch.chdir(tmp_path)
    rows = fo_gym.evaluate("mine.py:Mine", "FJRStiction-v0")
    # It knows the Coulomb friction, but neither stiction nor the bristle.
    assert 0.8 < rows["frr"][0] < fo_gym.evaluate("pid-high", "FJRStiction-v0")["frr"][0]


def test_the_pages_name_every_argument_of_an_environment() -> None:
    page = (ROOT / "docs" / "gymnasium.md").read_text(encoding="utf-8")
    (listed,) = re.findall(r"Arguments of every\s+environment: (.*?);\s+they are", page, re.DOTALL)
    assert re.findall(r"`(\w+)`", listed) == [*(each.name for each in fields(fo_gym.Settings)), "render_mode"]


def test_every_file_that_the_pages_name_exists() -> None:
    for page in (*PAGES, "envs_assets/README.md"):
        text = (ROOT / page).read_text(encoding="utf-8")
        named = re.findall(r"\]\(([^)#:]+)\)", text) + re.findall(
            r"`((?:fo_gym|baselines|tests|examples)/[\w./]+)`", text
        )
        missing = [
            name
            for name in named
            if not (ROOT / name).exists()
            and not (ROOT / page).parent.joinpath(name).exists()
            and Path(name).name not in MADE
            and Path(name).stem not in fo_gym.ENVIRONMENTS
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
