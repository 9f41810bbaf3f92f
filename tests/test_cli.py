"""The command line: what it prints, and what it writes."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest
from commands import MINE, TINY, Outcome, run, strangers_folder, written

import fo_gym
from fo_gym.evaluation.competitors.entry import shipped_entries
from fo_gym.evaluation.metrics import METRICS
from fo_gym.robots import shipped_robots
from fo_gym.tasks.variants import VARIANTS

pytestmark = pytest.mark.usefixtures("short_episodes")
SQUARE = "FJRSquare-v0"
SIX = ("pid-low", "pid-high", "pd-low", "pd-high", "letien-low", "letien-high")
FILES = {"episodes.csv", "leaderboard.csv", "timing.csv", "leaderboard.md", "processor.json"}
FILES |= {f"ranking-{SQUARE}.png", f"{SQUARE}.png"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with strangers_folder(tmp_path_factory.mktemp("stranger")) as folder:
        yield folder


def line_of(text: str) -> int:
    """The number of a line of MINE."""
    return next(number for number, line in enumerate(MINE.splitlines(), start=1) if text in line)


def table_rows(text: str) -> dict[str, list[str]]:
    """The lines of printed tables by their second cell, the compensator."""
    lines = [line.strip("│").split("│") for line in text.splitlines() if line.startswith("│")]
    return {
        cells[1].strip().removesuffix(" *"): [cell.strip() for cell in cells] for cells in lines if cells[1].strip()
    }


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


def test_an_entry_may_have_gains_for_ones_own_environment(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fo_gym.envs.registry.ENVIRONMENTS", dict(fo_gym.ENVIRONMENTS))
    task = "fo_gym.Task(fo_gym.Step(size=0.05), duration=0.1)"
    (folder / "own.py").write_text(f'import fo_gym\n\nfo_gym.register("OfAnEntry-v0", "single_link", {task})\n')
    entry = 'spec = "eso"\nauthors = ["Me"]\nlink = ""\n[[sets]]\nenv = "OfAnEntry-v0"\nvariant = "nominal"\n'
    (folder / "for_own.toml").write_text(f"{entry}gains = {{ bandwidth = -1.0 }}\n")
    result = run("evaluate", "for_own.toml", "--env", "own.py:OfAnEntry-v0", "--baselines", "none", "--jobs", "1")
    assert "bandwidth is -1.0; it must be finite and above 0" in result.err, "it has these gains"


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
