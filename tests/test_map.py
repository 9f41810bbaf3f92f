"""Maps: cells side by side give what each gives alone, and those that are refused or fail stop nobody."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from commands import run, strangers_folder

import fo_gym
from fo_gym.evaluation.competitors.content import Content
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.results.map import Map, column_of, map_table
from fo_gym.evaluation.results.map_drawing import Drawing, Marks
from fo_gym.evaluation.results.map_figure import map_figure
from fo_gym.evaluation.runs import cells as cells_module
from fo_gym.evaluation.runs import store as store_module
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.cells import CellSet, changed_law, friction_names
from fo_gym.evaluation.runs.store import Store, key_of
from fo_gym.reproduction.marks import paper_marks

STICTION, SQUARE = "FJRStiction-v0", "FJRSquare-v0"
SHORT = {"duration": 0.3}
LUGRE = fo_gym.Robot.from_toml("fo_gym/robots/data/single_link.toml").friction


def plan_of(spec: str, x: tuple[str, list[float]], y: tuple[str, list[float]], **kwargs: Any) -> Map:
    return Map(spec, x, y, **{"env_kwargs": SHORT, **kwargs})


def scores(rows: pd.DataFrame) -> pd.DataFrame:
    """All but the hunting, whose window is another one in a short episode."""
    hunting = ("hunting", "limit_cycle", "stick_slip")
    return rows[[name for name in METRICS if not name.startswith(hunting)]].reset_index(drop=True)


@pytest.mark.parametrize(
    ("spec", "x", "y"),
    [
        ("pid", ("L", [50.0, 100.0]), ("Li", [10.0, 25.0])),
        ("supertwisting", ("S1", [100.0, 200.0]), ("T1", [20.0, 28.0])),
    ],
    ids=["array gains", "team"],
)
def test_cells_are_what_each_is_alone(spec: str, x: Any, y: Any) -> None:
    table = map_table(plan_of(spec, x, y), Processes(1))
    assert table[[x[0], y[0]]].to_numpy().tolist() == [[one, other] for one in x[1] for other in y[1]]
    for place, row in table.iterrows():
        made = fo_gym.make_compensator(spec, **{x[0]: row[x[0]], y[0]: row[y[0]]})
        alone = fo_gym.evaluate(made, STICTION, **SHORT)
        pd.testing.assert_frame_equal(scores(table.loc[[place]]), scores(alone), check_exact=True)


def test_friction_is_that_of_the_cell() -> None:
    table = map_table(plan_of("pid-low", ("f_s/f_c", [1.5, 2.0]), ("v_s", [0.01, 0.1])), Processes(1))
    for place, row in table.iterrows():
        friction = replace(LUGRE, f_s=row["f_s/f_c"] * LUGRE.f_c, v_s=row["v_s"])
        alone = fo_gym.evaluate("pid-low", STICTION, friction=friction, **SHORT)
        pd.testing.assert_frame_equal(scores(table.loc[[place]]), scores(alone), check_exact=True)
    assert table["frr"].nunique() == 4


def test_gain_against_friction_and_several_joints() -> None:
    table = map_table(
        plan_of("pd", ("L", [50.0, 100.0]), ("f_s/f_c", [1.1, 1.5]), env_id=SQUARE, env_kwargs={"duration": 0.05}),
        Processes(1),
    )
    assert table["status"].tolist() == 4 * ["ok"]
    assert table["joint_unit"].unique() == ["rad"]
    assert table["frr"].nunique() == 4


def test_refused_cells_are_not_run(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = plan_of("pid", ("L", [10.0, 100.0]), ("Li", [1.0, 2.5]))
    told: list[str] = []
    table = map_table(plan, Processes(1), on_run=told.append)
    assert list(plan.refused) == [1]
    assert table["status"].tolist() == ["ok", "failed", "ok", "ok"]
    assert "Lp^2 = 4 is not above 2 Li = 5; raise Lp" in table["error"][1]
    assert told == 3 * [f"{STICTION}, nominal: pid"]


def test_a_cell_that_fails_is_found_among_the_others() -> None:
    """A bandwidth that the sampling cannot follow is refused when the episodes begin."""
    table = map_table(plan_of("pd", ("L", [50.0, 1500.0]), ("Lp", [10.0, 20.0])), Processes(1))
    assert table["status"].tolist() == ["ok", "ok", "failed", "failed"]
    assert table["error"].str.contains("L = 1500.0 1/s is too fast").tolist() == [False, False, True, True]
    alone = map_table(plan_of("pd", ("L", [50.0]), ("Lp", [10.0, 20.0])), Processes(1))
    assert table["frr"][:2].tolist() == alone["frr"].tolist()


def test_a_friction_that_no_law_has_is_refused() -> None:
    plan = plan_of("pid-low", ("f_s/f_c", [0.5, 1.5]), ("v_s", [0.001]))
    assert "stiction must be at least the Coulomb friction" in plan.refused[0]
    with pytest.raises(ValueError, match="stiction must be at least"):
        _ = plan_of("pid-low", ("f_s/f_c", [0.5]), ("v_s", [0.001])).refused


def test_the_names_of_friction() -> None:
    assert friction_names(LUGRE) == ("sigma_0", "sigma_1", "sigma_2", "f_c", "f_s", "v_s", "f_s/f_c")
    both = changed_law(LUGRE, {"f_s/f_c": 3.0, "f_c": 2.0})
    assert (both.f_c, both.f_s) == (2.0, 6.0)  # type: ignore[attr-defined]


def test_finished_batches_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fo_gym.evaluation.results.map._BATCH", 2)
    plan = plan_of("pd", ("L", [50.0, 100.0]), ("Lp", [10.0, 20.0]))
    store = Store(tmp_path, notice=pytest.fail)
    first = map_table(plan, Processes(1), store)
    assert len(list(tmp_path.rglob("*.trial"))) == 2
    told: list[str] = []
    monkeypatch.setattr(cells_module, "cells_trial", pytest.fail)
    again = map_table(plan, Processes(1), store, told.append)
    pd.testing.assert_frame_equal(first, again, check_exact=True)
    assert told == 4 * [f"{STICTION}, nominal: pd, from the store"]


def test_what_is_kept_is_of_these_cells_and_of_this_source(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = plan_of("pd", ("L", [50.0, 100.0]), ("Lp", [10.0]))
    sets = [CellSet.of(plan.episode, [cell]) for cell in plan.cells]
    one, other, same = (key_of(each, plan.competitor) for each in (*sets, CellSet.of(plan.episode, plan.cells[:1])))
    assert one == same
    assert len({one, other, key_of(plan.episode, plan.competitor)}) == 3
    changed = Content({"cells.py": "another"}, {})
    monkeypatch.setattr(store_module, "content_of_source", lambda source: changed)
    monkeypatch.setattr(store_module, "_kind", store_module._kind.__wrapped__)
    assert key_of(sets[0], plan.competitor) != one


def test_limit_cycles_of_short_episodes() -> None:
    """The low gains hunt: seen in the last half of 8 s, where the task's window is not reached."""
    table = map_table(plan_of("pid", ("L", [50.0]), ("Li", [25.0]), env_kwargs={"duration": 8.0}), Processes(1))
    assert 5e-4 < table["limit_cycle_peak_to_peak_ju"][0] < 2e-3
    assert np.isnan(fo_gym.evaluate("pid-low", STICTION, duration=8.0)["limit_cycle_peak_to_peak_ju"][0])


@pytest.mark.parametrize(
    ("kwargs", "message"),
    [
        ({"y": ("L", [1.0])}, "x and y are both 'L'"),
        ({"env_id": "Nothing-v0"}, "unknown environment 'Nothing-v0'"),
        ({"env_kwargs": {"duration": -1.0}}, "duration is -1"),
        ({"env_kwargs": {"feedback": "nominal"}}, "feedback cannot be chosen"),
    ],
)
def test_what_is_no_map(kwargs: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Map(**{"spec": "pid", "x": ("L", [50.0]), "y": ("Li", [1.0]), **kwargs})


def test_the_names_of_metrics() -> None:
    assert [column_of(name) for name in ("hunting", "rest", "frr", "overshoot_percent")] == [
        "limit_cycle_peak_to_peak_ju", "steady_state_error_ju", "frr", "overshoot_percent"
    ]  # fmt: skip
    with pytest.raises(ValueError, match="metric is 'huntng'"):
        column_of("huntng")


# What is marked


def test_the_papers_gains_and_condition_are_marked() -> None:
    marks = paper_marks(plan_of("pid", ("L", [50.0, 100.0]), ("Li", [1.0])))
    assert marks.points == {"paper's low gains": (50.0, 25.0), "paper's high gains": (100.0, 100.0)}
    assert marks.line is not None
    np.testing.assert_allclose(marks.line, [[50.0, 50.0], [100.0, 200.0]])
    pd_marks = paper_marks(plan_of("pd", ("L", [50.0]), ("Lp", [10.0])))
    assert pd_marks.points == {"paper's low gains": (50.0, 10.0), "paper's high gains": (100.0, 20.0)}
    assert pd_marks.line is None
    only_high = paper_marks(plan_of("pid-high", ("L", [50.0]), ("Li", [1.0])))
    assert list(only_high.points) == ["paper's high gains"]
    assert paper_marks(plan_of("pid-low", ("v_s", [0.1]), ("f_c", [1.0]))) == Marks()


# The figure


def synthetic(metric: str, values: list[float]) -> pd.DataFrame:
    grid = pd.MultiIndex.from_product([[10.0, 30.0, 100.0], [1.0, 2.0, 3.0]], names=["L", "f_s/f_c"])
    rows = grid.to_frame(index=False).assign(env=STICTION, robot="single_link", compensator="a_$b", joint_unit="m")
    return rows.assign(status="ok", **{metric: values})


@pytest.mark.looks
@pytest.mark.parametrize("metric", ["limit_cycle_peak_to_peak_ju", "steady_state_error_ju", "frr", "overshoot_percent"])
def test_a_figure_of_each_kind(metric: str) -> None:
    table = synthetic(metric, [0.0, 2e-4, 1e-3, 5e-3, np.nan, 1e-2, 0.1, 0.2, np.nan])
    table.loc[8, "status"] = "failed"
    marks = Marks({"here": (30.0, 2.0), "far away": (1e4, 2.0)}, np.array([[10.0, 1.0], [100.0, 3.0]]), "a line")
    figure = map_figure(table, Drawing("L", "f_s/f_c", metric, marks))
    figure.draw_without_rendering()
    axis, bar = figure.axes
    lost, image = (mesh.get_array() for mesh in axis.collections)
    assert (np.ma.count(lost), np.ma.count(image)) == (1, 7)
    # 0 has the lowest colour; of the hunting a grey one below the least that counts.
    lowest = {"limit_cycle_peak_to_peak_ju": 0.05, "frr": 1.0, "overshoot_percent": 1e-4}
    expected = lowest.get(metric, 0.1)
    assert image[0, 0] == pytest.approx(expected)
    assert axis.get_xscale() == "log"
    assert axis.get_yscale() == "linear"
    assert [text.get_text() for text in axis.texts] == ["here"]
    texts = [*axis.texts, axis.xaxis.label, axis.yaxis.label, axis.title, bar.yaxis.label]
    whole = figure.bbox.padded(1.0)
    boxes = [text.get_window_extent() for text in texts]
    assert all(whole.containsx(box.x0) and whole.containsx(box.x1) for box in boxes)
    assert all(whole.containsy(box.y0) and whole.containsy(box.y1) for box in boxes)


# The command


@pytest.mark.usefixtures("short_episodes")
def test_the_command(tmp_path: Path) -> None:
    with strangers_folder(tmp_path):
        command = ["map", "pid", "--x", "L=10,50", "--y", "Li=1:9:2", "--jobs", "1", "--metric", "frr"]
        first, again = run(*command), run(*command)
        assert (first.code, again.code) == (0, 0), first.err
        assert "4 cells, 1 refused or failed; frr from" in first.out
        assert "the first that was refused or failed: ValueError: PIDObserver: Lp^2 = 4" in first.err
        assert "from the store" in again.err
        assert {path.name for path in Path("build/map").iterdir()} == {"map.csv", "map.json", "map.png", "map.pdf"}
        rows = pd.read_csv("build/map/map.csv")
        assert rows[["L", "Li"]].to_numpy().tolist() == [[10, 1], [10, 9], [50, 1], [50, 9]]
        theirs = run("map", "mine.py:Mine", "--x", "bandwidth=40,80", "--y", "f_c=0.5,1", "--jobs", "1", "--out", "b")
        assert theirs.code == 0, theirs.err
        assert pd.read_csv("b/map.csv")["status"].tolist() == 4 * ["ok"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--x L --y Li=1,2", "--x is 'L'; give NAME=VALUES"),
        ("--x L=1:2 --y Li=1,2", "--x: L is '1:2'"),
        ("--x L=50 --y Li=1,1", "--y: Li is '1,1'; it names a value twice"),
        ("--x L=50 --y Lx=1", "has no gain 'Lx'"),
        ("--x L=50 --y Li=1 --metric speed", "metric is 'speed'"),
        ("--x L=50 --y Li=1 --env Nothing-v0", "unknown environment"),
        ("--x L=1:300:101 --y Li=1:400:100", "make 10100 sets; at most 10000"),
    ],
)
def test_what_the_command_refuses(options: str, message: str) -> None:
    outcome = run("map", "pid", *options.split())
    assert (outcome.code, message in " ".join(outcome.err.split())) == (2, True), outcome.err
