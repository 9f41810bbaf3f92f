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
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.runs import store
from fo_gym.evaluation.runs.protocol import load_protocol
from fo_gym.evaluation.runs.run import run_protocol
from fo_gym.files import atomic, csv

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
from baselines import LeTienObserver


class Calm(LeTienObserver):
    def __init__(self):
        super().__init__(80.0)
"""
STOPPED = """
import os
import sys
from pathlib import Path

import gymnasium

import fo_gym
from fo_gym.cli import app

for env_id in fo_gym.ENVIRONMENTS:  # as short as in the test
    gymnasium.spec(env_id).kwargs["duration"] = 1.0

signum, number, share = int(sys.argv.pop(1)), int(sys.argv.pop(1)), float(sys.argv.pop(1))
write_bytes = Path.write_bytes
drafts = 0


def stopped(path, content):
    global drafts
    drafts += path.suffix == ".trial"
    if drafts < number:
        return write_bytes(path, content)
    write_bytes(path, content[: int(share * len(content))])
    os.killpg(0, signum)


Path.write_bytes = stopped
app()
"""
"""The command, to which and to whose workers a signal comes when so much of the n-th draft of a trial is on disk."""

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


def stopped(signum: int, number: int, share: float, options: list[str]) -> subprocess.CompletedProcess[str]:
    """Run the command until it is stopped, in a process group of its own, as a terminal's is."""
    # What a shell starts in the background, as these tests may be, inherits that Ctrl-C is ignored.
    attended = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    program = [sys.executable, "-c", STOPPED, str(int(signum)), str(number), str(share), *options]
    return subprocess.run(
        program, capture_output=True, text=True, check=False, start_new_session=True, preexec_fn=attended
    )


@pytest.mark.slow
def test_killed_again_and_again_the_result_is_the_same(whole: dict[str, str]) -> None:
    options = ["leaderboard", "--protocol", "small.toml", "--out", "survived", "--store", "survivors", "--jobs", "1"]
    counts = []
    for number, share in KILLS:
        assert stopped(signal.SIGKILL, number, share, options).returncode == -signal.SIGKILL
        counts.append(kept("survivors"))
    assert counts == KEPT
    done = CliRunner().invoke(app, options)
    assert done.exit_code == 0, done.stderr
    # The first competitor; what the references are held against is computed anew where one of them is missing.
    assert f"1 of {RUNS} runs were taken from survivors" in done.stderr
    assert {name: Path("survived", name).read_text(encoding="utf-8") for name in whole} == whole


@pytest.fixture
def square(folder: Path) -> list[str]:
    """The command on one environment alone: four runs."""
    (folder / "square.toml").write_text(PROTOCOL.replace(f'"{STICTION}", ', ""), encoding="utf-8")
    return ["leaderboard", "--protocol", "square.toml"]


def test_an_interrupted_run_says_how_to_go_on(square: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Interrupted when none, ideal, bound and the first competitor are kept."""
    options = [*square, "--out", "stopped-out", "--store", "kept", "--jobs", "1"]

    def stop(path: Path, content: bytes) -> None:
        if kept("kept") == 4:
            raise KeyboardInterrupt
        atomic(path, content)

    with monkeypatch.context() as patch:
        patch.setattr(store, "atomic", stop)
        first = CliRunner().invoke(app, options)
    assert first.exit_code == 130
    assert "interrupted; finished runs are kept in kept, the same command goes on with them" in first.stderr
    assert kept("kept") == 4
    assert not Path("stopped-out").exists()
    second = CliRunner().invoke(app, options)
    assert second.exit_code == 0, second.stderr
    assert "1 of 4 runs were taken from kept" in second.stderr
    third = CliRunner().invoke(app, options)
    assert "4 of 4 runs were taken from kept" in third.stderr


@pytest.mark.slow
def test_ctrl_c_ends_the_workers_too(square: list[str]) -> None:
    """As the terminal does it, when the first of three competitors on two workers is done."""
    options = [*square, "--out", "signalled-out", "--store", "signalled", "--jobs"]
    first = stopped(signal.SIGINT, 3, 0.0, [*options, "2"])
    assert first.returncode == 130, first.stderr
    assert "interrupted; finished runs are kept in signalled" in first.stderr
    assert "Traceback" not in first.stderr
    assert kept("signalled") == 2
    second = CliRunner().invoke(app, [*options, "1"])
    assert second.exit_code == 0, second.stderr
    assert Path("signalled-out", "leaderboard.csv").is_file()
