"""Runs that survive: killed or interrupted, at chosen moments, the files come out the same to the byte."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from tables import SQUARE, STICTION
from typer.testing import CliRunner

from fo_gym.cli import app
from fo_gym.evaluation.leaderboard import leaderboard
from fo_gym.evaluation.protocol import load_protocol
from fo_gym.evaluation.run import run_protocol
from fo_gym.files import csv

pytestmark = pytest.mark.usefixtures("short_episodes")
PROTOCOL = f"""
name = "small"
split = "validation"
seeds = 1
environments = ["{STICTION}", "{SQUARE}"]
variants = ["nominal"]
compensators = ["pd-low", "letien-high", "theirs.py:Calm"]
"""
THEIRS = """
import os
import signal
from pathlib import Path

from baselines import LeTienObserver


class Calm(LeTienObserver):
    def __init__(self):
        super().__init__(80.0)


class Stopped(Calm):
    def reset(self, joints, num_envs):
        super().reset(joints, num_envs)
        if not Path("../stopped").exists():
            Path("../stopped").touch()
            raise KeyboardInterrupt


class Signalled(Calm):
    def reset(self, joints, num_envs):
        super().reset(joints, num_envs)
        if not Path("../signalled").exists():
            Path("../signalled").touch()
            os.kill(os.getppid(), signal.SIGINT)
            signal.pause()
"""
KILLED = """
import os
import signal
import sys
from pathlib import Path

import gymnasium

import fo_gym
from fo_gym.cli import app

for env_id in fo_gym.ENVIRONMENTS:  # as short as in the test
    gymnasium.spec(env_id).kwargs["duration"] = 1.0

number, share = int(sys.argv.pop(1)), float(sys.argv.pop(1))
write_bytes = Path.write_bytes
drafts = 0


def killed(path, content):
    global drafts
    drafts += path.suffix == ".trial"
    if drafts < number:
        return write_bytes(path, content)
    write_bytes(path, content[: int(share * len(content))])
    os.kill(os.getpid(), signal.SIGKILL)


Path.write_bytes = killed
app()
"""
"""The command, killed when so much of the draft of the n-th trial that it keeps is on disk."""

KILLS = [(1, 0.0), (4, 0.5), (3, 1.0), (3, 0.0)]
"""One after the other, on one store: before anything is kept, within a draft, before it takes its place, after that."""

KEPT = [0, 3, 5, 7]
"""Trials in the store after each: those of none and ideal of both environments come first."""

RUNS = 8


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The working directory, with the protocol and the strangers' file."""
    folder = tmp_path_factory.mktemp("resume") / "here"
    folder.mkdir()
    (folder / "small.toml").write_text(PROTOCOL, encoding="utf-8")
    (folder / "theirs.py").write_text(THEIRS, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield folder


@pytest.fixture(scope="module")
def whole(folder: Path) -> dict[str, str]:
    """The files of an uninterrupted run, without a store."""
    episodes = run_protocol(load_protocol("small.toml")).episodes
    return {"episodes.csv": csv(episodes), "leaderboard.csv": csv(leaderboard(episodes))}


def kept(folder: str) -> int:
    """How many trials a store holds; drafts that were left behind do not count."""
    return len([path for path in Path(folder).rglob("*.trial") if not path.name.startswith(".")])


@pytest.mark.slow
def test_killed_again_and_again_the_result_is_the_same(whole: dict[str, str]) -> None:
    options = ["leaderboard", "--protocol", "small.toml", "--out", "survived", "--store", "survivors", "--jobs", "1"]
    counts = []
    for number, share in KILLS:
        program = [sys.executable, "-c", KILLED, str(number), str(share), *options]
        assert subprocess.run(program, capture_output=True, check=False).returncode == -signal.SIGKILL
        counts.append(kept("survivors"))
    assert counts == KEPT
    done = CliRunner().invoke(app, options)
    assert done.exit_code == 0, done.stderr
    # All of the first environment: its three competitors, and none and ideal, which count as one run.
    assert f"4 of {RUNS} runs were taken from survivors" in done.stderr
    assert {name: Path("survived", name).read_text(encoding="utf-8") for name in whole} == whole


def only(folder: Path, name: str, compensators: str) -> None:
    """A protocol on one environment, with these compensators."""
    content = PROTOCOL.replace(f'"{STICTION}", ', "")
    (folder / name).write_text(content[: content.index("compensators")] + f"compensators = [{compensators}]\n")


def test_an_interrupted_run_says_how_to_go_on(folder: Path) -> None:
    only(folder, "stopped.toml", '"pd-low", "theirs.py:Stopped", "letien-high"')
    options = ["leaderboard", "--protocol", "stopped.toml", "--out", "stopped-out", "--store", "kept", "--jobs", "1"]
    first = CliRunner().invoke(app, options)
    assert first.exit_code == 130
    assert "interrupted; finished runs are kept in kept, the same command goes on with them" in first.stderr
    assert kept("kept") == 3
    assert not Path("stopped-out").exists()
    second = CliRunner().invoke(app, options)
    assert second.exit_code == 0, second.stderr
    assert "1 of 4 runs were taken from kept" in second.stderr
    third = CliRunner().invoke(app, options)
    assert "4 of 4 runs were taken from kept" in third.stderr


@pytest.mark.slow
def test_ctrl_c_ends_the_workers_too(folder: Path) -> None:
    """As the terminal does it, but at a moment that a worker chooses."""
    only(folder, "small-signalled.toml", '"theirs.py:Signalled", "pd-low"')
    options = ["--protocol", "small-signalled.toml", "--out", "signalled-out", "--store", "kept", "--jobs", "2"]
    arguments = [sys.executable, "-m", "fo_gym.cli", "leaderboard", *options]
    # What a shell starts in the background, as these tests may be, inherits that Ctrl-C is ignored.
    attended = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    first = subprocess.run(
        arguments, capture_output=True, text=True, check=False, start_new_session=True, preexec_fn=attended
    )
    assert first.returncode == 130, first.stderr
    assert "interrupted; finished runs are kept in kept" in first.stderr
    assert "Traceback" not in first.stderr
    second = CliRunner().invoke(app, ["leaderboard", *options[:-1], "1"])
    assert second.exit_code == 0, second.stderr
    assert Path("signalled-out", "leaderboard.csv").is_file()
