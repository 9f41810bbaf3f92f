"""`fo-gym verify`: published rows are computed again, and whatever is not what was published is told."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pandas as pd
import pytest
from tables import SQUARE
from typer.testing import CliRunner

from fo_gym.cli import app
from fo_gym.evaluation.results.published import contests_of, published, sampled
from fo_gym.evaluation.runs.contest import episodes_in
from fo_gym.evaluation.runs.episodes import KEY
from fo_gym.evaluation.runs.processor import processor
from fo_gym.evaluation.runs.protocol import load_protocol

ROOT = Path(__file__).parents[1]
PROTOCOL = f"""
name = "small"
split = "validation"
seeds = 2
environments = ["{SQUARE}"]
variants = ["nominal", "randomized"]
compensators = ["pd-low", "mine.py:Mine", "mine.py:Broken", "by-path.toml"]
"""
MINE = """
from baselines import LeTienObserver


class Mine(LeTienObserver):
    def __init__(self, L=80.0):
        super().__init__(L)


class Broken(Mine):
    def estimate(self, signals):
        raise KeyError("broken, and published so")
"""
ENTRY = 'spec = "mine.py:Mine"\nauthors = ["A. Author"]\nlink = ""\ngains = { L = 70.0 }\n'
ROWS, RUNS = 32, 16


class Outcome(NamedTuple):
    """What a command printed, and its exit code."""

    code: int
    out: str
    err: str


def run(*arguments: str) -> Outcome:
    result = CliRunner().invoke(app, [*arguments, "--jobs", "1"])
    assert result.exception is None or isinstance(result.exception, SystemExit), repr(result.exception)
    return Outcome(result.exit_code, result.stdout, result.stderr)


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory, short_episodes: None) -> Path:
    """A folder with published results, a submission among them."""
    folder = tmp_path_factory.mktemp("verify")
    (folder / "leaderboard" / "submissions").mkdir(parents=True)
    for name, text in {"small.toml": PROTOCOL, "mine.py": MINE, "by-path.toml": ENTRY}.items():
        (folder / name).write_text(text, encoding="utf-8")
    for name, text in {"mine.py": MINE, "theirs.toml": ENTRY.replace("70", "90")}.items():
        (folder / "leaderboard" / "submissions" / name).write_text(text, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert run("leaderboard", "--protocol", "small.toml", "--out", "out").code == 2  # for the broken one
    return folder


@pytest.fixture
def folder(original: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of it, as the working directory."""
    shutil.copytree(original, tmp_path, dirs_exist_ok=True, ignore=shutil.ignore_patterns("build", "figures"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def only(*names: str) -> None:
    """Leave the nominal rows, of seed 0, of these competitors."""
    nominal = {"variant": "nominal", "seed": "0"}
    change(lambda table: table[(table[list(nominal)] == nominal).all(axis=1) & table["compensator"].isin(names)])


def change(how: Callable[[pd.DataFrame], pd.DataFrame]) -> None:
    """Change the published rows."""
    how(published(Path("out"))).to_csv("out/episodes.csv", index=False)


@pytest.mark.slow
@pytest.mark.usefixtures("folder")
def test_what_was_published_is_computed_again() -> None:
    """Failed rows and submissions included."""
    result = run("verify", "out", "--sample", "99", "--protocol", "small.toml")
    assert (result.code, result.out) == (
        0,
        f"published on {processor()}, as here: compared to the byte\n"
        f"{ROWS} rows of {RUNS} runs: {ROWS} same to the byte, 0 within tolerance, 0 chaotic, 0 of other versions, "
        "0 mismatch\n",
    )
    assert "12/12" in result.err
    assert "12/12" not in run("verify", "out", "--sample", "1", "--protocol", "small.toml").err


@pytest.mark.usefixtures("folder")
def test_a_wrong_number_is_found() -> None:
    only("pd-low", "none")
    change(lambda table: table.assign(frr=table["frr"].mask(table["compensator"] == "pd-low", "0.999")))
    result = run("verify", "out", "--sample", "2")
    assert result.code == 2
    _, first, second, *_, last = result.out.splitlines()
    assert first == f"mismatch: {SQUARE} miro_like nominal pd-low 0"
    assert re.fullmatch(r"    frr: 0\.999 published, 0\.\d+ now", second)
    assert (
        last == "2 rows of 2 runs: 1 same to the byte, 0 within tolerance, 0 chaotic, 0 of other versions, 1 mismatch"
    )
    assert "1 rows cannot be reproduced" in result.err


@pytest.mark.usefixtures("folder")
def test_other_versions_may_give_other_numbers() -> None:
    only("pd-low")
    change(lambda table: table.assign(version_numpy="1.0"))
    assert "1 rows of 1 runs: 1 same to the byte" in run("verify", "out").out
    change(lambda table: table.assign(frr="0.999"))
    result = run("verify", "out")
    assert result.code == 0
    assert "of other versions: " in result.out
    assert "    version_numpy: 1.0 published, " in result.out


def test_a_changed_competitor_is_told(folder: Path) -> None:
    only("mine.py:Mine")
    (folder / "mine.py").write_text(MINE.replace("80.0", "81.0"), encoding="utf-8")
    result = run("verify", "out")
    assert result.code == 0
    assert "    competitor_hash: " in result.out
    assert "    frr: " in result.out


@pytest.mark.usefixtures("folder")
def test_a_column_that_is_not_there_is_a_difference() -> None:
    only("none")
    change(lambda table: table.drop(columns="steady_state_error_ju").assign(older="1"))
    result = run("verify", "out")
    assert result.code == 2
    assert "    older: 1 published, no such column now" in result.out
    assert "    steady_state_error_ju: no such column published, " in result.out


@pytest.mark.usefixtures("folder")
def test_a_competitor_that_is_not_known_is_named() -> None:
    only("by-path")
    result = run("verify", "out")
    assert result.code == 2
    assert "competitor 'by-path' is not known here; install its package" in result.err


@pytest.mark.usefixtures("folder")
def test_results_that_are_none_are_refused() -> None:
    assert "there is no nowhere/episodes.csv; write one with" in run("verify", "nowhere").err
    change(lambda table: table.drop(columns="competitor_hash"))
    assert "lacks the columns ['competitor_hash']" in run("verify", "out").err
    assert run("verify", "nowhere").code == 2


def test_rows_under_laws_are_of_the_episodes_that_were_run() -> None:
    table = published(ROOT / "leaderboard" / "laws")
    again = [each.episodes for each in contests_of(table[table["compensator"] == "none"])]
    ran = episodes_in(load_protocol("laws"))
    assert [(each.label, each.robot.fingerprint) for each in again] == [
        (each.label, each.robot.fingerprint) for each in ran
    ]


def test_the_protocol_says_what_a_robot_and_its_law_are(folder: Path) -> None:
    protocol = folder / "laws.toml"
    law = ROOT / "tests" / "outside" / "own_laws.py"
    protocol.write_text(f'{PROTOCOL}laws = ["{law.as_posix()}:SmoothCoulomb"]\nrobots = {{ mine = "miro_like" }}\n')
    row = {"env": SQUARE, "robot": "mine with SmoothCoulomb", "variant": "nominal", "compensator": "none", "seed": "0"}
    table = pd.DataFrame([{**row, "competitor_hash": "", "protocol": ""}])
    (contest,) = contests_of(table, protocol=protocol)
    robot = contest.episodes.robot
    assert (robot.name, type(robot.friction).__name__) == ("mine with SmoothCoulomb", "SmoothCoulomb")
    with pytest.raises(ValueError, match="robot 'mine with SmoothCoulomb' is not known here; name the protocol"):
        contests_of(table)


@pytest.mark.usefixtures("folder")
def test_the_sample_is_whole_runs_and_repeatable() -> None:
    table = published(Path("out"))
    seen = set()
    for seed in range(20):
        some = sampled(table, 2, seed)
        pd.testing.assert_frame_equal(some, sampled(table, 2, seed))
        runs = set(some[KEY].itertuples(index=False, name=None))
        assert len(runs) <= 2
        assert len(some) == sum(table[KEY].apply(tuple, axis=1).isin(runs))
        seen |= runs
    assert len(seen) > RUNS / 2
    pd.testing.assert_frame_equal(sampled(table, ROWS, 3), table)
