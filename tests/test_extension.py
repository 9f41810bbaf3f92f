"""CONTRIBUTING's table is true: of each row one is added from outside, and runs."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import fo_gym
from fo_gym.certificate.statement import at_most
from fo_gym.cli import app
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.runs.store import Store
from fo_gym.hardware import Effect, Hardware
from fo_gym.reproduction import claim, run
from fo_gym.tuning.study import Case, run_study

ROOT = Path(__file__).parents[1]
TABLE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
CASES: dict[str, Callable[..., None]] = {}

ENTRY_POINTS = """
[fo_gym.compensators]
theirs = theirs.compensator:Constant
[fo_gym.commands]
greet = theirs.command:greet
[fo_gym.metrics]
theirs = theirs.metrics
[fo_gym.environments]
theirs = theirs.environment
"""
PROTOCOL = """
name = "mine"
split = "validation"
seeds = 1
environments = ["own.py:Own-v0", "Theirs-v0"]
variants = ["nominal"]
compensators = ["pid-high", "theirs", "mine.py:Mine"]

[robots]
two = "two.toml"
"""
PROGRAM = """
import json, sys
from pathlib import Path

from fo_gym.cli import app

for command in ("list own.py", "greet world", "robot new two_links.xml --out two.toml",
                "leaderboard --protocol mine.toml --out out --jobs 2"):
    app(command.split(), standalone_mode=False)

from fo_gym.evaluation.runs.contest import contests_in
from fo_gym.evaluation.runs.protocol import load_protocol
from fo_gym.evaluation.runs.store import key_of

def keys():
    return [key_of(each.episodes, each.everybody[0]) for each in contests_in(load_protocol("mine.toml"))]

told = {"before": keys()}
for name in ("own.py", "site/theirs/metrics.py"):
    text = Path(name).read_text()
    Path(name).write_text(text + "# changed")
    told[name] = keys()
    Path(name).write_text(text)
told["after"] = keys()
print(json.dumps(told), file=sys.stderr)
"""


@dataclass(frozen=True)
class Outside:
    """What the program left: its output, the rows of its leaderboard, and keys of the store by what was changed."""

    output: str
    episodes: pd.DataFrame
    keys: dict[str, list[str]]

    def rows(self, **columns: str) -> pd.DataFrame:
        """Rows with these cells; there are some."""
        found = self.episodes
        for name, value in columns.items():
            found = found[found[name] == value]
        assert len(found), columns
        return found


@pytest.fixture(scope="module")
def outside(tmp_path_factory: pytest.TempPathFactory) -> Outside:
    """A folder with files of one's own, and a package that is installed in `site`."""
    folder = tmp_path_factory.mktemp("outside")
    for name in ("own.py", "mine.py"):
        shutil.copy(ROOT / "tests" / "outside" / name, folder)
    shutil.copy(ROOT / "examples" / "arms" / "two_links.xml", folder)
    shutil.copytree(ROOT / "tests" / "outside" / "theirs", folder / "site" / "theirs")
    info = folder / "site" / "theirs-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: theirs\nVersion: 1.0\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(ENTRY_POINTS, encoding="utf-8")
    (folder / "mine.toml").write_text(PROTOCOL, encoding="utf-8")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(folder / "site"), str(ROOT)])}
    command = [sys.executable, "-c", PROGRAM]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    keys = json.loads(done.stderr.splitlines()[-1])
    return Outside(done.stdout, pd.read_csv(folder / "out" / "episodes.csv"), keys)


def case(row: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """The decorated test adds what this row of the table says."""

    def named(test: Callable[..., None]) -> Callable[..., None]:
        CASES[row] = test
        return test

    return named


def test_every_row_has_a_case() -> None:
    rows = re.findall(r"^\| (an? [^|]*|gains[^|]*) \| [^|]+ \| [^|]+ \|$", TABLE, re.MULTILINE)
    lines = TABLE.split("| --- | --- | --- |\n")[1].split("\n\n")[0].splitlines()
    assert len(rows) == len(lines)
    assert rows == list(CASES)


@case("a compensator")
def test_compensator(outside: Outside) -> None:
    assert "compensator  theirs\n" in outside.output
    for name in ("theirs", "mine.py:Mine"):
        rows = outside.rows(compensator=name)
        assert set(rows["status"]) == {"ok"}
        assert rows["frr"].notna().all()
        assert len(rows) == 2


@case("a learned compensator")
def test_learned_compensator(outside: Outside) -> None:
    learned = outside.episodes.groupby("compensator")["learned"].agg(set).to_dict()
    assert learned == {
        name: {name == "mine.py:Mine"} for name in ("none", "ideal", "bound", "pid-high", "theirs", "mine.py:Mine")
    }


@pytest.mark.slow
@case("gains to tune")
def test_gains(tmp_path: Path, short_episodes: None) -> None:
    spec = f"{ROOT / 'tests' / 'outside' / 'mine.py'}:Mine"
    case = Case(spec, "FJRStiction-v0", "randomized", trials=2, episodes=1, seed=0, final_episodes=1)
    outcome = run_study(case, Store(tmp_path, notice=pytest.fail))
    assert outcome.trials["level"].iloc[0] == 1.0
    assert outcome.trials["level"].between(0.2, 5.0).all()
    assert outcome.trials["frr_tuning"].notna().all()


@case("a robot")
def test_robot(outside: Outside) -> None:
    assert outside.rows(robot="two")["env"].unique().tolist() == ["Own-v0"]
    assert set(outside.rows(compensator="pid-high", env="Own-v0")["status"]) == {"ok"}


@case("a task")
def test_task(outside: Outside) -> None:
    """Its reference is fitted to each robot: farther away, the error at the start is larger."""
    first = outside.rows(compensator="none").set_index("robot")["theirs_largest_ju"]
    assert first["two"] == pytest.approx(0.05 * max(3.0 - 0.3, np.deg2rad(150.0) + 0.6), abs=5e-3)
    assert first["single_link"] == pytest.approx(5e-3, abs=1e-4)


@case("an environment")
def test_environment(outside: Outside) -> None:
    """That of a package and that of a file are listed, named in a protocol, known to workers, in the store's key."""
    assert re.search(
        r"^environment  Theirs-v0 \(link, own\): on single_link, from theirs\.environment$", outside.output, re.M
    )
    assert re.search(r"^environment  Own-v0 \(arm, own\): on miro_like, from \S+own\.py$", outside.output, re.M)
    assert len(outside.rows(env="Own-v0")) == len(outside.rows(env="Theirs-v0")) == 6
    before, changed = outside.keys["before"], outside.keys["own.py"]
    assert outside.keys["after"] == before
    assert [old != new for old, new in zip(before, changed, strict=True)] == [True, False]


@case("a metric")
def test_metric(outside: Outside) -> None:
    """Its column comes behind ours; what it is computed by counts in the store."""
    assert "metric       theirs_largest_ju (m or rad, lower is better): Largest |theta - theta_d|" in outside.output
    columns = list(outside.episodes)
    assert columns[columns.index("frr") :][: len(METRICS) + 1] == [*METRICS, "theirs_largest_ju"]
    assert outside.episodes["theirs_largest_ju"].gt(0.0).all()
    assert not set(outside.keys["site/theirs/metrics.py"]) & set(outside.keys["before"])


@dataclass(frozen=True)
class Offset(Effect):
    """Torque sensors that are off by what is drawn for the episode."""

    largest: float

    def draw(self, dof: int, generator: np.random.Generator) -> dict[str, Any]:
        return {"offset": generator.uniform(-self.largest, self.largest, dof)}

    def measure(self, readings: Any, episodes: Any) -> Any:
        return readings._replace(tau_j=readings.tau_j + episodes.drawn["offset"])


def scores(largest: float, **options: Any) -> list[float]:
    hardware = Hardware(others=(Offset(largest),))
    rows = fo_gym.evaluate("pid-high", "FJRStiction-v0", duration=0.3, hardware=hardware, **options)
    assert set(rows["status"]) == {"ok"}
    return list(rows["frr"])


@case("a hardware effect")
def test_hardware_effect() -> None:
    without = fo_gym.evaluate("pid-high", "FJRStiction-v0", duration=0.3)["frr"].tolist()
    assert scores(0.0) == without
    assert scores(1.0) != without


@case("a random draw of an episode")
def test_random_draw() -> None:
    """It is the seed's."""
    drawn = scores(1.0, variant="randomized", seeds=[1, 2, 3])
    assert len(set(drawn)) == 3
    assert drawn == [scores(1.0, variant="randomized", seeds=[seed])[0] for seed in (1, 2, 3)]


@case("a protocol")
def test_protocol(outside: Outside) -> None:
    assert outside.episodes["protocol"].str.startswith("mine@").all()
    assert len(outside.episodes) == 2 * 6


@case("a command of `fo-gym`")
def test_command(outside: Outside) -> None:
    assert "\nhello world\n" in outside.output


@case("a claim of the paper, or a check of the physics")
def test_claim(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that holds, and one that does not and is not known to fail, which ends the command."""
    monkeypatch.setattr(claim, "CLAIMS", {})
    monkeypatch.setattr(run, "TABLES", {"claims": claim.CLAIMS})
    claim.claim("two", source="arithmetic", text="Two is at most three.")(lambda subject: at_most(2.0, 3.0, "", "2"))
    reproduce = ["reproduce", "--only", "claims", "--out", str(tmp_path), "--jobs", "1"]
    assert CliRunner().invoke(app, reproduce).exit_code == 0
    claim.claim("four", source="arithmetic", text="Four is at most three.")(lambda subject: at_most(4.0, 3.0, "", "4"))
    assert CliRunner().invoke(app, reproduce).exit_code == 2
    table = pd.read_csv(tmp_path / "paper" / "claims.csv").set_index("id")
    assert table["verdict"].to_dict() == {"two": "holds", "four": "fails"}
