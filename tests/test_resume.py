"""Runs that survive: killed, interrupted, on any number of workers, the files come out the same to the byte."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from tables import SQUARE, STICTION
from typer.testing import CliRunner

from fo_gym.cli import app
from fo_gym.evaluation.leaderboard import leaderboard
from fo_gym.evaluation.protocol import load_protocol
from fo_gym.evaluation.run import run_protocol
from fo_gym.files import csv

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
KILLS = 5
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


def published(jobs: int) -> dict[str, str]:
    """The files of an uninterrupted run, without a store, with so many workers."""
    episodes = run_protocol(load_protocol("small.toml"), jobs=jobs).episodes
    return {"episodes.csv": csv(episodes), "leaderboard.csv": csv(leaderboard(episodes))}


@pytest.fixture(scope="module")
def whole(folder: Path) -> dict[str, str]:
    """The files of an uninterrupted run in this process."""
    return published(jobs=1)


def command(*options: str) -> list[str]:
    return [sys.executable, "-m", "fo_gym.cli", "leaderboard", "--protocol", "small.toml", *options]


def killed(moment: float, lines: int) -> int:
    """Start the command, kill it with its workers some time after it told of so many runs; how it ended."""
    options = command("--out", "survived", "--store", "survived-store", "--jobs", "1")
    with subprocess.Popen(
        options, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        assert process.stderr is not None
        told = [line for _, line in zip(range(lines), process.stderr, strict=False)]
        assert len(told) == lines
        try:
            process.wait(moment)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
    return process.returncode


def kept() -> int:
    """How many trials the store holds."""
    return len(list(Path("survived-store").rglob("*.trial")))


def test_killed_again_and_again_the_result_is_the_same(whole: dict[str, str]) -> None:
    rng = np.random.default_rng(9)
    ends, counts = [], []
    for _ in range(KILLS):
        # A run takes up to a second: a kill hits it anywhere, or while its trial is written.
        ends.append(killed(moment=rng.uniform(0.0, 1.0), lines=min(RUNS, kept() + 1)))
        counts.append(kept())
    assert ends[0] == -signal.SIGKILL
    assert counts == sorted(counts)
    assert counts[-1] > 0
    options = command("--out", "survived", "--store", "survived-store", "--jobs", "1")
    done = subprocess.run(options, capture_output=True, text=True, check=True)
    assert f" of {RUNS} runs were taken from survived-store" in done.stderr
    assert f"\n0 of {RUNS} runs" not in done.stderr
    assert {name: Path("survived", name).read_text(encoding="utf-8") for name in whole} == whole


def test_the_number_of_workers_does_not_matter(whole: dict[str, str]) -> None:
    assert published(jobs=4) == whole


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
    assert len(list(Path("kept").rglob("*.trial"))) == 3
    assert not Path("stopped-out").exists()
    second = CliRunner().invoke(app, options)
    assert second.exit_code == 0, second.stderr
    assert "1 of 4 runs were taken from kept" in second.stderr
    third = CliRunner().invoke(app, options)
    assert "4 of 4 runs were taken from kept" in third.stderr


def test_ctrl_c_ends_the_workers_too(folder: Path) -> None:
    """As the terminal does it, but at a moment that a worker chooses."""
    only(folder, "small-signalled.toml", '"theirs.py:Signalled", "pd-low"')
    options = ["--protocol", "small-signalled.toml", "--out", "signalled-out", "--store", "kept", "--jobs", "2"]
    arguments = [*command()[:4], *options]
    # What a shell starts in the background, as these tests may be, inherits that Ctrl-C is ignored.
    attended = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    first = subprocess.run(
        arguments, capture_output=True, text=True, check=False, start_new_session=True, timeout=60, preexec_fn=attended
    )
    assert first.returncode == 130, first.stderr
    assert "interrupted; finished runs are kept in kept" in first.stderr
    assert "Traceback" not in first.stderr
    second = CliRunner().invoke(app, ["leaderboard", *options[:-1], "1"])
    assert second.exit_code == 0, second.stderr
    assert Path("signalled-out", "leaderboard.csv").is_file()
