"""The command line: what it prints, what it writes, and how it says no."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import EntryPoint, PackageNotFoundError
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import pandas as pd
import pytest
from rich.console import Console
from typer.testing import CliRunner

import fo_gym
from fo_gym import cli, extras
from fo_gym.cli import app, view
from fo_gym.evaluation.competitors.entry import shipped_entries
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.results.tables import Ranking
from fo_gym.robots import shipped_robots
from fo_gym.tasks.variants import VARIANTS

pytestmark = pytest.mark.usefixtures("short_episodes")
SQUARE = "FJRSquare-v0"
SIX = ("pid-low", "pid-high", "pd-low", "pd-high", "letien-low", "letien-high")
FILES = {"episodes.csv", "leaderboard.csv", "timing.csv", "leaderboard.md", "processor.json"}
FILES |= {"ranking.png", f"{SQUARE}.png"}

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
    """Outcome of the command; a traceback is at most that of a user's own lines."""
    result = CliRunner().invoke(app, list(arguments))
    assert f'File "{Path(fo_gym.__file__).parent}' not in result.output
    assert result.exception is None or isinstance(result.exception, SystemExit), repr(result.exception)
    out, err = (re.sub(r"\x1b\[[0-9;]*m", "", text) for text in (result.stdout, result.stderr))
    return Outcome(result.exit_code, out, err)


def line_of(text: str) -> int:
    """The number of a line of MINE."""
    return next(number for number, line in enumerate(MINE.splitlines(), start=1) if text in line)


def written(folder: Path) -> set[Path]:
    return {path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts}


def table_rows(text: str) -> dict[str, list[str]]:
    """The lines of printed tables by their second cell, the compensator."""
    lines = [line.strip("│").split("│") for line in text.splitlines() if line.startswith("│")]
    return {
        cells[1].strip().removesuffix(" *"): [cell.strip() for cell in cells] for cells in lines if cells[1].strip()
    }


# What there is


def test_list_shows_everything() -> None:
    result = run("list")
    assert result.code == 0
    lines = [line.split() for line in result.out.splitlines()]
    shown = {kind: [line[1].rstrip(":") for line in lines if line[0] == kind] for kind in {line[0] for line in lines}}
    assert shown == {
        "environment": list(fo_gym.ENVIRONMENTS),
        "robot": list(shipped_robots()),
        "variant": list(VARIANTS),
        "compensator": fo_gym.list_compensators(),
        "metric": list(METRICS),
        "protocol": ["full", "laws", "quick"],
    } | ({"entry": list(shipped_entries())} if shipped_entries() else {})


def test_list_says_which_source_cannot_be_had(tmp_path: Path) -> None:
    broken = tmp_path / "broken.py"
    broken.write_text("raise RuntimeError('not today')\n", encoding="utf-8")
    for source, told in (
        (str(broken), "raised RuntimeError: not today"),
        ("nothing.py", "there is no file nothing.py"),
    ):
        result = run("list", source)
        assert (result.code, result.out) == (2, "")
        assert result.err.startswith(f"error: source {source!r}: ")
        assert told in " ".join(result.err.split())


COMMANDS = {
    "list": "fo-gym list",
    "evaluate": "fo-gym evaluate mine.py:Mine",
    "sweep": "fo-gym sweep pd-high --gains L=20:400:10",
    "leaderboard": "fo-gym leaderboard --quick",
    "verify": "fo-gym verify build/mine --sample 20",
}


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_examples(command: str) -> None:
    result = run(command, "--help")
    assert result.code == 0
    assert "Example" in result.out
    assert COMMANDS[command] in result.out
    if "--variant" in result.out:
        assert all(variant in result.out for variant in VARIANTS)


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
    assert "environment  FJRSquare-v0 (arm, square): on miro_like\n" in listed.stdout
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
    assert set(rows) == {"mine.py:Mine", "none", "ideal", "bound", *SIX}
    ranks = {name: cells[0] for name, cells in rows.items()}
    assert sorted(ranks.values()) == ["", "", "", *"1234567"]
    assert ranks["none"] == ranks["ideal"] == ranks["bound"] == ""
    assert (rows["none"][2], rows["ideal"][2]) == ("0.0000", "1.0000")
    # The stranger's observer is Le Tien's with a gain between the two of the paper.
    frr = {name: float(cells[2]) for name, cells in rows.items()}
    assert frr["letien-low"] < frr["mine.py:Mine"] < frr["letien-high"]


def test_out_is_written_and_told(scored: Outcome, folder: Path) -> None:
    files = written(folder / "results")
    assert {path.name for path in files} == FILES
    told = {line.removeprefix("wrote ") for line in scored.out.splitlines() if line.startswith("wrote ")}
    assert {folder / path for path in told} == files


def test_what_fails_late_fails_after_the_table(folder: Path) -> None:
    command = ["evaluate", "pid-high", "mine.py:Late", "--env", SQUARE, "--store", "short"]
    result = run(*command, "--jobs", "1", "--baselines", "none")
    assert result.code == 2
    rows = table_rows(result.out)
    assert set(rows) == {"mine.py:Late", "pid-high", "none", "ideal", "bound"}
    assert rows["mine.py:Late"][:3] == ["", "mine.py:Late *", ""]
    assert "failed" in rows["mine.py:Late"][-1]
    assert float(rows["pid-high"][2]) > 0.0
    last = result.err.rpartition("error: ")[2]
    assert last.startswith("CompensatorError: mine.py:Late: estimate raised KeyError at tick 60: ")
    assert "no [/such] key in [red]" in last
    assert last.endswith(f"(mine.py, line {line_of('raise KeyError')}, in estimate)\n")


def test_what_fails_at_once_is_shown_at_once_with_its_own_lines(folder: Path) -> None:
    """Before anybody else runs, hence without a progress bar, a table or a file."""
    before = written(folder)
    result = run("evaluate", "pid-high", "mine.py:Broken", "--env", SQUARE, "--jobs", "1", "--store", "untouched")
    assert (result.code, result.out) == (2, "")
    lines = result.err.splitlines()
    assert lines[0] == "Traceback (most recent call last):"
    assert [line.strip() for line in lines if line.startswith("  File ")] == [
        f'File "{folder / "mine.py"}", line {line_of("return np.linalg")}, in estimate',
    ]
    assert lines[-2] == "numpy.linalg.LinAlgError: Singular matrix"
    assert lines[-1].startswith(
        "error: mine.py:Broken: estimate raised LinAlgError at tick 0: Singular matrix (mine.py"
    )
    assert written(folder) == before


def test_gains_and_a_name_and_chosen_baselines(folder: Path) -> None:
    """The gains arrive, the row is the user's own, and the same command again computes nothing."""
    command = ["evaluate", "mine.py:Mine", "--gains", "bandwidth=50", "--gains", "sign=1.0", "--store", "short"]
    command += ["--env", SQUARE, "--jobs", "1", "--baselines", "letien-low,none", "--out", "results/gains"]
    first = run(*command, "--name", "as low")
    assert first.code == 0, first.err
    rows = table_rows(first.out)
    assert set(rows) == {"as low", "letien-low", "none", "ideal", "bound"}
    board = pd.read_csv(folder / "results/gains/leaderboard.csv").set_index("compensator")
    assert board["origin"].to_dict() == {
        **dict.fromkeys(["none", "ideal", "bound"], "reference"), "as low": "yours", "letien-low": "baseline"
    }  # fmt: skip
    assert board.loc["as low", "frr"] == pytest.approx(board.loc["letien-low", "frr"], abs=1e-6)
    again = run(*command, "--name", "again")
    assert "3 of 3 runs were taken from short" in again.err
    assert set(table_rows(again.out)) == {"again", "letien-low", "none", "ideal", "bound"}


def test_a_file_that_is_no_python_is_shown_where(folder: Path) -> None:
    result = run("evaluate", "syntax.py:Mine")
    assert (result.code, result.out) == (2, "")
    first, *_, last = result.err.splitlines()
    assert first == f'  File "{folder / "syntax.py"}", line 1'
    assert last.startswith("error: compensator 'syntax.py:Mine': making it raised SyntaxError")


def test_an_entry_is_evaluated_as_any_other(folder: Path) -> None:
    (folder / "mine.toml").write_text(
        'name = "m"\nspec = "mine.py:Mine"\nauthors = ["Me"]\nlink = ""\n', encoding="utf-8"
    )
    result = run("evaluate", "mine.toml", "--env", SQUARE, "--jobs", "1")
    assert result.code == 0, result.err
    assert set(table_rows(result.out)) == {"m", "none", "ideal", "bound", *SIX}


# leaderboard


def test_a_protocol_of_ones_own(folder: Path) -> None:
    result = run("leaderboard", "--protocol", "tiny.toml", "--out", "tiny", "--traces", "--jobs", "1")
    assert result.code == 0, result.err
    traces = {path.name.rpartition("-")[0] or path.name for path in (folder / "tiny" / "traces").rglob("*.npz")}
    assert traces == {"none.median.npz", "ideal.median.npz", "bound.median.npz", "mine-py-Mine"}
    named = {path.name for path in written(folder / "tiny") if path.suffix != ".npz"}
    assert named == FILES | {"index.csv"}
    assert "wrote tiny/traces/index.csv" in result.out
    assert set(table_rows(result.out)) == {"mine.py:Mine", "none", "ideal", "bound"}
    assert "2/2" in result.err


def test_a_leaderboard_with_a_failed_row_is_written_and_fails(folder: Path) -> None:
    (folder / "partly.toml").write_text(TINY.replace("mine.py:Mine", "mine.py:Late"), encoding="utf-8")
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
    ("evaluate pid-high pid-high", "two competitors are called 'pid-high'"),
    ("evaluate mine.py:Mine --gains L=70", "'mine.py:Mine' has no gain 'L'; it takes bandwidth, sign"),
    ("evaluate pid-high --gains Lx=70", "'pid-high' has no gain 'Lx'; it takes L, Lp, Li"),
    ("evaluate pid-high --gains L=7O", "L is '7O'; give a value as TOML has it"),
    ("evaluate pid-high --gains L", "--gains is 'L'; give NAME=VALUE"),
    ("evaluate pid-high --gains L=1 --gains L=2", "names 'L' twice"),
    ("evaluate pid-high --gains Li=200", "Lp^2 = 400 is not above 2 Li = 400; raise Lp above 20"),
    ("evaluate pid-high pd-high --gains L=70", "--gains and --name are for one compensator; 2 were given"),
    ("evaluate pid-high --name a|b", "--name is 'a|b'; give letters"),
    ("evaluate pid-high --baselines nobody", "unknown compensator 'nobody'"),
    ("evaluate mine.py:Mine --name pid-high", "two competitors are called 'pid-high'"),
    ("sweep nobody --gains L=1:2:3", "unknown compensator 'nobody'"),
    ("sweep mine.py:Mine --gains L=1:2:3", "'mine.py:Mine' has no gain 'L'; it takes bandwidth, sign"),
    ("sweep pid-high --gains L=20:10:3", "L is '20:10:3'; give LOW below HIGH"),
    ("sweep pid-high --gains L=a,b", "L is 'a'; give a value as TOML has it"),
    ("sweep pid-high --gains L=true,false", "L is 'true'; a sweep is over numbers"),
    ("sweep pid-high --gains L=1,1.0", "L is '1,1.0'; it names a value twice"),
    ("sweep pid-high --gains Lp=1,2 --env FJRNothing-v0", "unknown environment 'FJRNothing-v0'"),
    ("leaderboard --quick --protocol full", "--quick and --protocol exclude each other"),
    ("leaderboard --protocol nothing.toml", "there is no protocol 'nothing.toml'; name a TOML file or one of full"),
    ("leaderboard --protocol [notes].toml", "protocol [notes].toml: "),
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


# Tables on a narrow terminal

WIDE = Ranking(
    "FJRStiction-v0, nominal",
    ["rank", "compensator", "FRR", "95 % interval", "ranks", "group", "steady-state error [mm]", "lag [ms]", "verdict"],
    [["1", "a-long-name of mine", "0.9838", "0.9821 ... 0.9852", "1 ... 3", "ab", "0.0124", "5.1", "best"]] * 2
    + [["", "theirs", "", "", "", "", "", "", "failed: KeyError: a long tale, which is told to its very end"]],
)
SETS = [f"{env}, {variant}" for env in ("FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0") for variant in VARIANTS]
SUMMARY = Ranking("Friction rejection ratio", ["compensator", *SETS], [["pid-measured", *map(str, range(9))]])


@pytest.mark.parametrize("width", [60, 80, 100, 140])
@pytest.mark.parametrize("ranking", [WIDE, SUMMARY])
def test_tables_fit_the_terminal(
    ranking: Ranking, width: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(view, "console", Console(width=width))
    view.print_tables([ranking])
    printed = capsys.readouterr().out
    assert max(len(line) for line in printed.splitlines() if not line.startswith("left out")) <= width
    assert "…" not in printed
    named = {heading for heading in ranking.headings if all(word in printed for word in heading.split())}
    assert named == set(ranking.headings)  # as a column, or as what was left out
    if ranking is SUMMARY:
        places = [cell for line in printed.splitlines() if "pid-measured" in line for cell in line.strip("│ ").split()]
        assert [cell for cell in places if cell.isdigit()] == list("012345678")


def test_a_wide_terminal_has_every_column(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    for width, left_out in ((150, False), (80, True)):
        monkeypatch.setattr(view, "console", Console(width=width))
        view.print_tables([WIDE])
        assert ("left out" in capsys.readouterr().out) == left_out


# Extras and plug-ins


def test_how_to_install_an_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    """In a clone as the Makefile does it; else by the name of the package."""
    clone = json.dumps({"url": "file:///somewhere", "dir_info": {"editable": True}})
    in_place = ".venv/bin/pip install -c constraints.txt -e '.[tune]' (in the folder of the clone)"
    for noted, command in (
        (clone, in_place),
        (None, "pip install 'fo-gym[tune]'"),
        (json.dumps({"url": "file:///somewhere", "dir_info": {}}), "pip install 'fo-gym[tune]'"),
    ):
        installed = SimpleNamespace(read_text=lambda name, noted=noted: noted)
        monkeypatch.setattr(extras, "distribution", lambda name, installed=installed: installed)
        assert extras.install_command("tune") == command

    def nowhere(name: str) -> None:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(extras, "distribution", nowhere)
    assert extras.install_command("tune") == in_place


def test_extras_are_those_of_the_project() -> None:
    """Every message names an extra that pyproject.toml has."""
    root = Path(__file__).parents[1]
    known = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    sources = [
        path.read_text(encoding="utf-8") for part in ("fo_gym", "baselines") for path in (root / part).rglob("*.py")
    ]
    named = {extra for source in sources for extra in re.findall(r"install_command\(['\"](\w+)", source)}
    assert {"ray", "reproduce", "rl", "tune"} == named <= set(known)
    assert not [
        source for source in sources if "pip install 'fo-gym[" in source and "def install_command" not in source
    ]


def test_commands_of_plug_ins(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Listed without being imported, run when called; one that is broken or has a name of ours spoils nothing."""
    (tmp_path / "greeting.py").write_text(
        'def greet(name: str) -> None:\n    """Greet somebody."""\n    print(f"hello {name}")\n', encoding="utf-8"
    )
    monkeypatch.syspath_prepend(tmp_path)
    values = {"greet": "greeting:greet", "broken": "nowhere:at_all", "list": "greeting:greet"}
    entries = [EntryPoint(name, value, "fo_gym.commands") for name, value in values.items()]
    monkeypatch.setattr(cli, "entry_points", lambda group: entries)
    listed = run("--help")
    assert "greet" in listed.out
    assert "fo-gym: command 'list' of greeting:greet is left out: the name is taken" in capsys.readouterr().err
    assert "greeting" not in sys.modules
    assert run("greet", "you").out == "hello you\n"
    assert "Greet somebody." in run("greet", "--help").out
    wrong = run("broken")
    assert wrong.code == 2
    assert "command 'broken' of nowhere:at_all cannot be loaded: No module named 'nowhere'" in wrong.err
    assert "FJRStiction-v0" in run("list").out
