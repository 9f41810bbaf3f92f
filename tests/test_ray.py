"""The Ray backend: the same bytes as in one process, nothing lost when a worker is killed; and how it says no."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from tables import SQUARE
from typer.testing import CliRunner

from fo_gym.cli import app
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.runs import backends
from fo_gym.evaluation.runs.protocol import load_protocol
from fo_gym.evaluation.runs.run import run_protocol
from fo_gym.extras import install_command
from fo_gym.files import csv

PROTOCOL = f"""
name = "small"
split = "validation"
seeds = 1
environments = ["{SQUARE}"]
variants = ["nominal"]
compensators = ["pd-low", "theirs.py:Calm", "pid-high"]
"""
THEIRS = """
from baselines import LeTienObserver


class Calm(LeTienObserver):
    def __init__(self):
        super().__init__(80.0)
"""
DEATHS = """
import sys
from dying import ANSWERS, answer, tasks
from fo_gym.evaluation.runs.backends import backend_of
with backend_of("ray", 2) as workers:
    assert dict(workers.run(answer, tasks(sys.argv[1]))) == ANSWERS
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, with the protocol and the strangers' file."""
    folder = tmp_path / "here"
    folder.mkdir()
    (folder / "small.toml").write_text(PROTOCOL, encoding="utf-8")
    (folder / "theirs.py").write_text(THEIRS, encoding="utf-8")
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.slow
def test_a_killed_worker_costs_nothing_but_time(folder: Path) -> None:
    """In a process of its own, as Ray wants it."""
    paths = {"PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])}
    program = [sys.executable, "-c", DEATHS, str(folder)]
    done = subprocess.run(program, env=os.environ | paths, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_what_runs_on_ray_is_what_runs_here(folder: Path) -> None:
    """To the byte, with two workers."""
    command = [sys.executable, "-m", "fo_gym.cli", "leaderboard", "--protocol", "small.toml", "--out", "out"]
    done = subprocess.run([*command, "--jobs", "2", "--backend", "ray"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "0 of 4 runs were taken from" in done.stderr
    assert not list(Path("build").rglob("*.part*"))
    here = run_protocol(load_protocol("small.toml")).episodes
    assert Path("out/episodes.csv").read_text(encoding="utf-8") == csv(here)
    assert Path("out/leaderboard.csv").read_text(encoding="utf-8") == csv(leaderboard(here))


@pytest.mark.usefixtures("folder")
def test_without_ray_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    result = CliRunner().invoke(app, ["leaderboard", "--protocol", "small.toml", "--backend", "ray"])
    assert result.exit_code == 2
    assert result.stdout == ""
    assert install_command("ray") in result.stderr
    assert result.stderr.count("\n") == 1


class NoCluster:
    """Ray, where there is no cluster."""

    def init(self, **options: object) -> None:
        raise ConnectionError(f"nothing at {options['address']}")


@pytest.mark.usefixtures("folder")
def test_without_a_cluster_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", NoCluster())
    options = ["--backend", "ray", "--address", "10.0.0.1:6379"]
    result = CliRunner().invoke(app, ["leaderboard", "--protocol", "small.toml", *options])
    assert result.exit_code == 2
    assert "there is no Ray cluster at 10.0.0.1:6379: nothing at 10.0.0.1:6379" in result.stderr


@pytest.mark.usefixtures("folder")
def test_an_address_needs_ray() -> None:
    result = CliRunner().invoke(app, ["leaderboard", "--protocol", "small.toml", "--address", "10.0.0.1:6379"])
    assert result.exit_code == 2
    assert "add --backend ray" in result.stderr


@pytest.mark.slow
def test_lost_workers_end_the_run_with_a_word(monkeypatch: pytest.MonkeyPatch) -> None:
    import ray  # noqa: PLC0415 (slow)

    def lose(task: object) -> None:
        raise ray.exceptions.ObjectLostError("a" * 56, "127.0.0.1", "")

    monkeypatch.setattr(ray, "get", lose)
    with pytest.raises(backends.BackendError, match="Ray lost its workers"):
        backends.RayWorkers(ray)._result(None)
