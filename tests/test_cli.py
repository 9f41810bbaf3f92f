"""The command line: what it prints, what it writes, and how it says no."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from typer.testing import CliRunner

import fo_gym
from fo_gym.cli import app
from fo_gym.evaluation.entry import shipped_entries
from fo_gym.evaluation.metrics import METRICS

pytestmark = pytest.mark.usefixtures("short_episodes")
SQUARE = "FJRSquare-v0"
SIX = ("pid-low", "pid-high", "pd-low", "pd-high", "letien-low", "letien-high")
FILES = {"episodes.csv", "leaderboard.csv", "timing.csv", "leaderboard.md", "ranking.png", f"{SQUARE}.png"}

MINE = """\
import numpy as np


class Mine:
    feedback = "measured"

    def reset(self, joints, num_envs):
        self.gain = 80.0 * joints.motor_inertia

    def estimate(self, signals):
        return -self.gain * (signals.theta_n_dot - signals.theta_dot)


class Broken(Mine):
    def estimate(self, signals):
        raise KeyError("no [/such] key in [red]")


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


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A stranger's working directory."""
    folder = tmp_path_factory.mktemp("stranger")
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
    result = CliRunner().invoke(app, list(arguments))
    assert "Traceback" not in result.output
    assert result.exception is None or isinstance(result.exception, SystemExit), repr(result.exception)
    out, err = (re.sub(r"\x1b\[[0-9;]*m", "", text) for text in (result.stdout, result.stderr))
    return Outcome(result.exit_code, out, err)


def written(folder: Path) -> set[Path]:
    return {path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts}


def table_rows(text: str) -> dict[str, list[str]]:
    """The lines of printed tables by their second cell, the compensator."""
    lines = [line.strip("│").split("│") for line in text.splitlines() if line.startswith("│")]
    return {cells[1].strip(): [cell.strip() for cell in cells] for cells in lines if cells[1].strip()}


# What there is


def test_list_shows_everything() -> None:
    result = run("list")
    assert result.code == 0
    lines = [line.split() for line in result.out.splitlines()]
    shown = {kind: [line[1].rstrip(":") for line in lines if line[0] == kind] for kind in {line[0] for line in lines}}
    assert shown == {
        "environment": list(fo_gym.ENVIRONMENTS),
        "compensator": fo_gym.list_compensators(),
        "metric": list(METRICS),
        "protocol": ["full", "quick"],
    } | ({"entry": list(shipped_entries())} if shipped_entries() else {})


COMMANDS = {
    "list": "fo-gym list",
    "evaluate": "fo-gym evaluate my.py:Mine",
    "leaderboard": "fo-gym leaderboard --quick",
    "verify": "fo-gym verify build/mine --sample 20",
}


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_examples(command: str) -> None:
    result = run(command, "--help")
    assert result.code == 0
    assert "Example" in result.out
    assert COMMANDS[command] in result.out


def test_help_names_every_command() -> None:
    result = run("--help")
    assert result.code == 0
    assert all(command in result.out for command in COMMANDS)


def test_the_installed_command(folder: Path) -> None:
    script = Path(sys.executable).with_name("fo-gym")
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "FORCE_COLOR")}
    arguments = {"cwd": folder, "env": environment, "capture_output": True, "text": True}
    listed = subprocess.run([script, "list"], check=False, **arguments)
    assert (listed.returncode, listed.stderr) == (0, "")
    assert "environment  FJRSquare-v0\n" in listed.stdout
    refused = subprocess.run([script, "evaluate", "nobody"], check=False, **arguments)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr.startswith("error: unknown compensator 'nobody'; registered are none, ideal, ")
    assert refused.stderr.count("\n") == 1


# evaluate


@pytest.fixture(scope="module")
def scored(folder: Path) -> Outcome:
    """A stranger's compensator, scored and written."""
    return run("evaluate", "mine.py:Mine", "--env", SQUARE, "--jobs", "1", "--out", "results/mine")


def test_a_stranger_stands_beside_the_others(scored: Outcome) -> None:
    assert scored.code == 0, scored.err
    assert scored.out.count("┏") == 1
    rows = table_rows(scored.out)
    assert set(rows) == {"mine.py:Mine", "none", "ideal", *SIX}
    ranks = {name: cells[0] for name, cells in rows.items()}
    assert sorted(ranks.values()) == ["", "", *"1234567"]
    assert ranks["none"] == ranks["ideal"] == ""
    assert (rows["none"][2], rows["ideal"][2]) == ("0.0000", "1.0000")
    # The stranger's observer is Le Tien's with a gain between the two of the paper.
    frr = {name: float(cells[2]) for name, cells in rows.items()}
    assert frr["letien-low"] < frr["mine.py:Mine"] < frr["letien-high"]


def test_out_is_written_and_told(scored: Outcome, folder: Path) -> None:
    files = written(folder / "results")
    assert {path.name for path in files} == FILES
    told = {line.removeprefix("wrote ") for line in scored.out.splitlines() if line.startswith("wrote ")}
    assert {folder / path for path in told} == files


def test_a_broken_compensator_fails_after_the_table_and_writes_nothing(folder: Path) -> None:
    before = written(folder)
    result = run("evaluate", "pid-high", "mine.py:Broken", "--env", SQUARE, "--jobs", "1")
    assert result.code == 2
    rows = table_rows(result.out)
    assert set(rows) == {"mine.py:Broken", "none", "ideal", *SIX}
    assert rows["mine.py:Broken"][:3] == ["", "mine.py:Broken", ""]
    assert "failed" in rows["mine.py:Broken"][-1]
    assert float(rows["pid-high"][2]) > 0.9
    last = result.err.rpartition("error: ")[2]
    assert last.startswith("CompensatorError: mine.py:Broken: estimate raised KeyError at tick 0")
    assert "no [/such] key in [red]" in last
    assert written(folder) == before


def test_an_entry_is_evaluated_as_any_other(folder: Path) -> None:
    (folder / "mine.toml").write_text(
        'name = "m"\nspec = "mine.py:Mine"\nauthors = ["Me"]\nlink = ""\n', encoding="utf-8"
    )
    result = run("evaluate", "mine.toml", "--env", SQUARE, "--jobs", "1")
    assert result.code == 0, result.err
    assert set(table_rows(result.out)) == {"m", "none", "ideal", *SIX}


# leaderboard


def test_a_protocol_of_ones_own(folder: Path) -> None:
    result = run("leaderboard", "--protocol", "tiny.toml", "--out", "tiny", "--traces", "--jobs", "1")
    assert result.code == 0, result.err
    traces = {path.name.rpartition("-")[0] or path.name for path in (folder / "tiny" / "traces").rglob("*.npz")}
    assert traces == {"none.median.npz", "ideal.median.npz", "mine-py-Mine"}
    named = {path.name for path in written(folder / "tiny") if path.suffix != ".npz"}
    assert named == FILES | {"index.csv"}
    assert "wrote tiny/traces/index.csv" in result.out
    assert set(table_rows(result.out)) == {"mine.py:Mine", "none", "ideal"}
    assert "2/2" in result.err


def test_a_leaderboard_with_a_failed_row_is_written_and_fails(folder: Path) -> None:
    (folder / "partly.toml").write_text(TINY.replace("mine.py:Mine", "mine.py:Broken"), encoding="utf-8")
    result = run("leaderboard", "--protocol", "partly.toml", "--out", "partly", "--jobs", "1")
    assert result.code == 2
    assert "KeyError" in result.err
    assert {path.name for path in written(folder / "partly")} == FILES


# How it says no

REFUSED = [
    ("evaluate nobody", "unknown compensator 'nobody'; registered are none, ideal"),
    ("evaluate nowhere.py:Mine", "there is no file nowhere.py"),
    ("evaluate mine.py:Yours", "mine.py has no 'Yours'"),
    ("evaluate mine.py:Undecided", "feedback is 'both'; allowed are 'measured', 'nominal'"),
    ("evaluate pid-high --env FJRNothing-v0", "unknown environment 'FJRNothing-v0'; known are FJRStiction-v0"),
    ("evaluate pid-high --variant wild", "unknown variant 'wild'; known are nominal, randomized"),
    ("evaluate pid-high --seeds 1001", "1001 seeds were asked for; give a number from 1 to 1000"),
    ("evaluate pid-high --traces", "--traces are written beside the results; add --out DIR"),
    ("evaluate pid-high pid-high", "names one of them twice"),
    ("leaderboard --quick --protocol full", "--quick and --protocol exclude each other"),
    ("leaderboard --protocol nothing.toml", "there is no protocol 'nothing.toml'; name a TOML file or one of full"),
    ("leaderboard --protocol [notes].toml", "protocol [notes].toml: "),
    ("evaluate syntax.py:Mine", "syntax.py:Mine"),
    ("evaluate tiny.toml", "entry tiny.toml: missing keys ['spec', 'authors', 'link'], unknown keys ['split', "),
    ("leaderboard --protocol tiny.toml --submissions nowhere", "there is no folder nowhere"),
    ("leaderboard --protocol tiny.toml --address here", "add --backend ray"),
    ("verify nowhere", "there is no nowhere/episodes.csv"),
    ("verify --jobs 0", "jobs"),
    ("leaderboard --protocol tiny.toml --jobs 0", "jobs"),
]


@pytest.mark.parametrize(("command", "message"), REFUSED)
def test_refused_in_one_line(folder: Path, command: str, message: str) -> None:
    before = written(folder)
    result = run(*command.split())
    assert result.code == 2
    assert result.out == ""
    assert result.err.startswith("error: ")
    assert message in result.err
    assert result.err.count("\n") == 1
    assert written(folder) == before


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("evaluate", "COMPENSATOR"),
        ("evaluate pid-high --seeds 0", "--seeds"),
        ("evaluate pid-high --wobble", "--wobble"),
        ("evaluate pid-high --out mine.py", "mine.py"),
        ("leaderboard --out mine.py", "mine.py"),
        ("evaluat pid-high", "evaluat"),
    ],
)
def test_wrong_usage(folder: Path, command: str, message: str) -> None:
    result = run(*command.split())
    assert result.code == 2
    assert message in result.err
    assert "Usage" in result.err
