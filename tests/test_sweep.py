"""Sweeps: many sets of gains in one batch give what each gives alone, and those that are refused stop nobody."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import fo_gym
from fo_gym.cli import app
from fo_gym.cli.gains import gain_sets
from fo_gym.console import Stop
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.results.sweep import Grid, Plan, summary_of
from fo_gym.evaluation.results.sweep_figure import sweep_figure
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.run import run_contests

STICTION = "FJRStiction-v0"
SHORT = {"variant": "randomized", "seeds": 2, "duration": 0.2}

THEIRS = """
import os


class Theirs:
    feedback = "measured"

    def __init__(self, level=1.0):
        if level > 8.0:
            raise ValueError(f"level is {level}; at most 8")
        self.level = level

    def reset(self, joints, num_envs):
        self.ticks = 0

    def estimate(self, signals):
        self.ticks += 1
        if self.level == 3.0 and self.ticks == 7:
            raise KeyError("lost")
        if self.level == 4.0:
            return signals.theta[:1]
        if self.level == 5.0:
            os._exit(1)
        return -self.level * (signals.theta_d > signals.theta)
"""


@pytest.fixture
def theirs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A stranger's class, in the working directory."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "theirs.py").write_text(THEIRS, encoding="utf-8")
    return "theirs.py:Theirs"


def test_together_is_what_each_is_alone() -> None:
    gains = {"L": [50.0, 100.0], "Lp": [16.0, 20.0]}
    rows = fo_gym.sweep("pid-high", STICTION, gains, **SHORT)
    assert list(rows.columns[:6]) == ["env", "robot", "variant", "compensator", "L", "Lp"]
    assert rows["compensator"].unique() == ["pid-high"]
    assert rows[["L", "Lp"]].drop_duplicates().to_numpy().tolist() == [[50, 16], [50, 20], [100, 16], [100, 20]]
    for (L, Lp), group in rows.groupby(["L", "Lp"]):
        alone = fo_gym.evaluate(fo_gym.make_compensator("pid-high", L=L, Lp=Lp), STICTION, **SHORT)
        pd.testing.assert_frame_equal(
            group[list(METRICS)].reset_index(drop=True), alone[list(METRICS)], check_exact=True
        )


def test_an_environment_is_the_same_however_it_is_named() -> None:
    """The gains that are not swept are those that the entry has for it."""
    one, other = (fo_gym.sweep("pid-tuned", name, {"L": [50.0]}, **SHORT) for name in (STICTION, f"fo_gym:{STICTION}"))
    pd.testing.assert_frame_equal(one, other)


def test_the_references_run_once_and_refused_sets_never() -> None:
    told: list[str] = []
    episodes = EpisodeSet(STICTION, "nominal", (1,), {"duration": 0.05})
    plan = Plan(Grid("pid-high", {"Lp": [10.0, 14.5, 20.0]}), [episodes])
    rows = plan.table(run_contests(plan.contests, "", backend=Processes(1), on_run=told.append))
    assert [label.rpartition(": ")[2] for label in told] == ["none, ideal, bound", "pid-high Lp=14.5", "pid-high Lp=20"]
    assert rows["status"].tolist() == ["failed", "ok", "ok"]
    assert "Lp^2 = 100 is not above 2 Li = 200" in rows["error"][0]
    assert np.isnan(rows["frr"][0])


def test_who_fails_in_a_batch_spoils_no_other() -> None:
    """A bandwidth that the sampling cannot follow is refused when the episodes begin."""
    rows = fo_gym.sweep("pid-high", STICTION, {"L": [50.0, 1500.0]}, **SHORT).set_index("L")
    assert rows.loc[1500.0, "status"].eq("failed").all()
    assert rows.loc[1500.0, "error"].str.contains("L = 1500.0 1/s is too fast for an estimate every 0.001 s").all()
    alone = fo_gym.sweep("pid-high", STICTION, {"L": [50.0]}, **SHORT)
    assert rows.loc[50.0, "status"].eq("ok").all()
    assert rows.loc[50.0, "frr"].tolist() == alone["frr"].tolist()


def test_strangers_fail_one_by_one(theirs: str) -> None:
    levels = [1.0, 2.0, 3.0, 4.0, 5.0, 9.0]
    rows = fo_gym.sweep(theirs, STICTION, {"level": levels}, **SHORT).set_index("level")
    reasons = {
        3.0: r"KeyError at tick 6: 'lost' \(theirs.py, line \d+, in estimate\)",
        4.0: r"returned shape \(1, 1\)",
        5.0: "process",
        9.0: "level is 9.0; at most 8",
    }
    for level, reason in reasons.items():
        assert (rows.loc[level, "status"] == "failed").all()
        assert all(re.search(reason, error) for error in rows.loc[level, "error"])
    assert rows.loc[[1.0, 2.0], "status"].eq("ok").all()


@pytest.mark.parametrize(
    ("option", "values"),
    [
        ("L=20:200:3", [20.0, 63.2456, 200.0]),
        ("L=20:200:3:linear", [20.0, 110.0, 200.0]),
        ("L=0:1:3", [0.0, 0.5, 1.0]),
        ("L=50,100, 2e2", [50.0, 100.0, 200.0]),
        ("L=-1:1:2", [-1.0, 1.0]),
    ],
)
def test_values_of_a_gain(option: str, values: list[float]) -> None:
    assert gain_sets([option]) == {"L": values}


def test_values_that_are_none() -> None:
    wrong = [
        "L=1:2",
        "L=1:2:1",
        "L=1:2:10001",
        "L=1:2:1000000000",
        f"L=1:2:{5000 * '1'}",
        "L=2:1:3",
        "L=1:inf:3",
        "L=nan:1:3",
        "L=",
        "L=1,,2",
        "L=1:2:3:log",
        "=1",
        "L=1979-05-27",
    ]
    accepted = []
    for option in wrong:
        try:
            accepted.append(gain_sets([option]))
        except Stop:
            continue
    assert accepted == []


@pytest.mark.parametrize(
    ("compensator", "gains", "message"),
    [
        ("pid-high", {}, "no gain is swept"),
        ("pid-high", {"L": []}, r"gain 'L' is \[\]"),
        ("pid-high", {"L": [1.0, 1.0]}, "none twice"),
        ("pid-high", {"L": [np.nan]}, "finite"),
        ("pid-high", {"L": 50.0}, "gain 'L' is 50.0; give a list of finite numbers"),
        ("pid-high", {"L": "50"}, "gain 'L' is '50'; give a list of finite numbers"),
        ("pid-high", {"L": [True]}, r"gain 'L' is \[True\]; give a list of finite numbers"),
        ("pid-high", {"L": range(1, 102), "Lp": range(1, 101)}, "make 10100 sets; at most 10000 are swept"),
        ("pid-high", {"seed": [1.0]}, "gain 'seed' has the name of a column"),
        ("pid-high", {"Lp": [1.0, 2.0]}, "is not above 2 Li"),
        ("nobody", {"L": [1.0]}, "unknown compensator 'nobody'"),
    ],
)
def test_what_is_refused(compensator: str, gains: dict[str, list[float]], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fo_gym.sweep(compensator, STICTION, gains)


def test_whole_numbers_stay_whole() -> None:
    sets = Grid("pid-high", {"order": [1, np.int64(2)], "L": [np.float64(50.0), *gain_sets(["L=60,70.0"])["L"]]}).sets
    assert [[type(value) for value in each.values()] for each in sets[:3]] == [[int, float], [int, int], [int, float]]
    assert [tuple(each.values()) for each in sets[3:]] == [(2, 50.0), (2, 60), (2, 70.0)]


def test_a_generator_gives_values_as_a_list_does() -> None:
    gains: Any = {"L": (value for value in (50.0, 60.0))}
    assert Grid("pid-high", gains).sets == [{"L": 50.0}, {"L": 60.0}]


@pytest.mark.parametrize(("env_id", "variant", "message"), [(7, "nominal", "env_id is 7"), (STICTION, "wild", "wild")])
def test_where_it_is_swept_is_checked(env_id: Any, variant: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fo_gym.sweep("pid-high", env_id, {"L": [50.0]}, variant=variant)


def test_no_workers_are_refused() -> None:
    with pytest.raises(ValueError, match="jobs is 0; give the number of worker processes"):
        fo_gym.sweep("pid-high", STICTION, {"L": [50.0]}, jobs=0)


def table(*names: str, failed: int = 0) -> pd.DataFrame:
    """A sweep over the gains of these names, 1, 2, 3 each, that is best where all are 2."""
    grid = pd.MultiIndex.from_product([[1.0, 2.0, 3.0]] * len(names), names=names).to_frame(index=False)
    frr = 1.0 - 0.1 * ((grid - 2.0) ** 2).sum(axis=1)
    rows = grid.assign(
        env=STICTION, robot="single_link", variant="nominal", compensator="a_$b", frr=frr, status="ok", error=""
    )
    rows.loc[: failed - 1, ["frr", "status", "error"]] = [np.nan, "failed", "refused"]
    return pd.concat([rows, rows.assign(frr=rows["frr"] - 0.02)], ignore_index=True)


def test_the_summary_of_a_sweep() -> None:
    summary = summary_of(table("k", failed=1), ["k"])
    assert list(summary) == ["env", "robot", "variant", "k", "frr", "frr_worst", "frr_best", "status", "error"]
    assert summary["k"].tolist() == [1.0, 2.0, 3.0]
    assert summary["status"].tolist() == ["failed", "ok", "ok"]
    assert summary["error"].tolist() == ["refused", "", ""]
    np.testing.assert_allclose(summary["frr"], [np.nan, 0.99, 0.89])
    np.testing.assert_allclose(summary["frr_worst"], [np.nan, 0.98, 0.88])


def test_a_curve_over_one_gain_and_a_map_over_two() -> None:
    curve, map_ = (sweep_figure(table(*names, failed=1), names) for names in (["k"], ["k", "m"]))
    for figure in (curve, map_):
        figure.canvas.draw()
    assert curve.axes[0].lines[0].get_xdata().tolist() == [1.0, 2.0, 3.0]
    np.testing.assert_allclose(curve.axes[0].lines[0].get_ydata(), [np.nan, 0.99, 0.89])
    image = map_.axes[0].images[0].get_array()
    assert image.shape == (3, 3)
    assert np.ma.masked_invalid(image).mask.sum() == 1
    best = map_.axes[0].lines[0]
    assert (best.get_xdata(), best.get_ydata()) == ([1], [1])
    with pytest.raises(ValueError, match="over 3 gains"):
        sweep_figure(table("a", "b", "c"), ["a", "b", "c"])


@pytest.mark.usefixtures("short_episodes")
def test_the_command(theirs: str) -> None:
    command = ["sweep", theirs, "--gains", "level=0.5,1.0,9.0", "--jobs", "1", "--out", "out"]
    outcomes = [CliRunner().invoke(app, command) for _ in range(2)]
    for outcome in outcomes:
        assert outcome.exit_code == 0, outcome.output
        assert "1 of 3 sets failed; the first: ValueError: level is 9.0; at most 8" in outcome.stderr
    assert "3 of 3 runs were taken from build/store" in outcomes[1].stderr
    assert "the best 2 of 3 sets" in outcomes[0].stdout
    rows = pd.read_csv("out/sweep.csv")
    assert rows["level"].tolist() == [0.5, 1.0, 9.0]
    assert rows["status"].tolist() == ["ok", "ok", "failed"]
    assert {path.name for path in Path("out").iterdir()} == {"sweep.csv", "sweep.png"}
