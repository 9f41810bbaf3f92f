"""What the page is made of: packed traces, motion in words, the report's sentences, and the libraries at hand."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tables import SQUARE, STICTION, synthetic

from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.files import csv, read_csv
from fo_gym.page import vendor
from fo_gym.page.board import digits, key_of, overview, rankings
from fo_gym.page.motion import look_at, turning_points
from fo_gym.page.packing import packed, trace_script
from fo_gym.page.recording import telling_seed
from fo_gym.page.site import Content, write_site
from fo_gym.page.stories import stories
from fo_gym.page.summary import Summary, summarized, worst_seeds
from fo_gym.page.who import everybody

ROOT = Path(__file__).parents[1]
TIME = np.linspace(0.0, 20.0, 2001)
NAMES = {"mine": [0.5, 0.6, 0.4, 0.55], "pid-high": [0.9, 0.91, 0.92, 0.9], "pd-low": [0.1, 0.2, 0.15, 0.12]}
WHO = everybody([Competitor(name, name) for name in NAMES])


def trace_of(theta: np.ndarray, seed: int = 0, **more: np.ndarray) -> Trace:
    """A trace of one joint whose target and friction-free motion is 0.01 m from 1 s on."""
    ideal = np.where(TIME < 1.0, 0.0, 0.01)
    columns = {"theta": theta, "theta_ideal": ideal, "theta_d": ideal, "tau_f": 0.0 * TIME, "tau_f_hat": 0.0 * TIME}
    signals = {name: values[:, None].astype(np.float32) for name, values in columns.items()}
    return Trace(
        STICTION, "single_link", "randomized", "mine", seed, "median", 0.5, "m",
        {"time": TIME.astype(np.float32), **signals, **more},
    )  # fmt: skip


def results() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Episodes of four seeds, and their table as it is read from its file."""
    episodes = synthetic(NAMES, env=STICTION, torque_roughness_ratio=0.01)
    episodes.loc[episodes["compensator"] == "mine", ["torque_roughness_ratio", "origin"]] = [0.02, "yours"]
    episodes.loc[episodes["compensator"] == "pid-high", "torque_roughness_ratio"] = 0.005
    return episodes, read_csv(csv(leaderboard(episodes)))


# Traces as scripts


def unpacked(column: dict[str, object], length: int) -> np.ndarray:
    levels = np.frombuffer(base64.b64decode(str(column["data"])), "<u2").astype(float)
    levels = levels if len(levels) else np.zeros(length)
    return np.where(levels == 65535, np.nan, float(column["low"]) + float(column["step"]) * levels)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "values",
    [np.linspace(-3.0, 5.0, 100), np.array([1.0, np.nan, np.inf, 2.0]), np.full(5, 0.25), np.full(3, np.nan)],
    ids=["range", "gaps", "constant", "nothing"],
)
def test_a_packed_column_is_exact_to_its_step(values: np.ndarray) -> None:
    found = packed(values.astype(np.float32))
    expected = np.where(np.isfinite(values), values, np.nan)
    span = np.ptp(expected[np.isfinite(expected)]) if np.isfinite(expected).any() else 0.0
    np.testing.assert_allclose(unpacked(found, len(values)), expected, atol=span / 65_534)


def test_small_differences_to_the_friction_free_motion_survive() -> None:
    """Nanometres beside a motion of centimetres."""
    error = 1e-7 * np.sin(TIME)
    trace = trace_of(np.where(TIME < 1.0, 0.0, 0.01) + error)
    told = json.loads(trace_script("key", trace).removeprefix('fg.trace("key",').removesuffix(");\n"))
    found = unpacked(told["error"][0], len(TIME))
    exact = trace.signals["theta"][:, 0] - trace.signals["theta_ideal"][:, 0]
    np.testing.assert_allclose(found, exact, atol=1e-11)
    np.testing.assert_allclose(np.cumsum(told["ticks"]) * told["tick"], TIME, atol=1e-5)


# Motion in words


def test_turning_points_are_those_of_swings_above_the_threshold() -> None:
    values = np.sin(2.0 * np.pi * TIME / 8.0) + 0.01 * np.sin(40.0 * TIME)
    assert TIME[turning_points(values, 0.1)] == pytest.approx([2.0, 6.0, 10.0, 14.0, 18.0], abs=0.1)
    assert len(turning_points(TIME, 0.1)) == 0
    assert len(turning_points(0.04 * values, 0.1)) == 0


def test_an_oscillation_is_told_with_its_second_and_size() -> None:
    ideal = np.where(TIME < 1.0, 0.0, 0.01)
    hunting = ideal + np.where(TIME < 5.0, 0.0, 5e-4 * np.sign(np.sin(2.0 * np.pi * (TIME - 5.0) / 4.0)))
    found = look_at(trace_of(hunting))
    assert found.text.startswith("the joint oscillates from 5.0 s on, 1 mm from peak to peak")
    assert found.span == (4.01, 20.0)


def test_a_joint_that_stops_short_is_told_with_where_and_when() -> None:
    found = look_at(trace_of(np.where(TIME < 1.0, 0.0, np.minimum(0.008, 0.008 * (TIME - 1.0)))))
    assert found.text == "the joint stops 2 mm off the target at 2.0 s"
    rests = look_at(trace_of(np.where(TIME < 1.0, 0.0, 0.01)))
    assert rests.text.startswith("comes to rest on the target")


def test_a_tool_is_told_where_it_is_furthest() -> None:
    away = np.zeros((len(TIME), 3), np.float32)
    away[700, 1] = 4e-3
    still = np.zeros((len(TIME), 3), np.float32)
    found = look_at(trace_of(0.0 * TIME, tool=away, tool_ideal=still, tool_d=still))
    assert found.text == "the tool is furthest from its friction-free path at 7.00 s: 4 mm"


# Rankings


def test_the_axis_is_logarithmic_and_holds_every_row() -> None:
    _, table = results()
    (ranking,) = rankings(table, WHO)
    assert [row.who.name for row in ranking.rows] == ["pid-high", "mine", "pd-low"]
    assert digits(0.1) == pytest.approx(1.0)
    places = {row.who.name: row.places[0] for row in ranking.rows}
    assert 0.0 <= places["pd-low"] < places["mine"] < places["pid-high"] <= 100.0
    for row in ranking.rows:
        assert row.places[1] <= row.places[0] <= row.places[2]
    assert dict(ranking.ticks)["0.1"] == pytest.approx(100.0 * (1.0 - 0.0) / 2.0)
    assert [row.own for row in ranking.rows] == [False, True, False]


def test_who_has_no_score_is_last_and_says_why() -> None:
    episodes, _ = results()
    episodes.loc[episodes["compensator"] == "pd-low", ["frr", "status", "error"]] = [np.nan, "failed", "it <broke>"]
    table = read_csv(csv(leaderboard(episodes)))
    (ranking,) = rankings(table, WHO)
    assert (ranking.rows[-1].who.name, ranking.rows[-1].standing) == ("pd-low", "failed")
    assert "it <broke>" in ranking.rows[-1].note
    assert ranking.rows[-1].places == ()
    assert overview(table, WHO).rows[-1][3][0][1] == -1


def test_competitors_are_told_by_family() -> None:
    who = everybody([Competitor("pid-high", "pid-high"), Competitor("x", "some/mine.py:Mine", authors=("A. B.",))])
    assert (who["pid-high"].family, who["x"].family, who["none"].family) == ("kim2019", "mine", "references")
    assert who["pid-high"].about == "PID-type observer with the paper's high gains."
    assert who["x"].about == "By A. B."


def test_the_episode_of_a_set_is_the_middling_one() -> None:
    episodes, _ = results()
    assert telling_seed(episodes) == 0  # mine is in the middle everywhere, and seed 0 the second of its four
    assert telling_seed(episodes.assign(variant="nominal")) == 0


# The report


def summary_of(traces: list[Trace]) -> Summary:
    episodes, table = results()
    return summarized("mine", episodes, table, traces, key_of(STICTION, "single_link", "randomized"))


def test_a_report_tells_wins_losses_and_the_worst_episodes_first() -> None:
    episodes, _ = results()
    assert worst_seeds(episodes[episodes["compensator"] == "mine"]) == [2, 0, 3, 1]
    stuck = trace_of(np.zeros(len(TIME)), seed=2)
    told = summary_of([stuck])
    assert "It undoes 52.5 % of that (FRR 0.525" in told.headline
    assert "Rank 2 of 3" in told.headline
    assert told.losses[-1] == "Worst of all in roughness: 2 %; the next has 1."
    assert [episode.seed for episode in told.episodes] == ["2", "0", "3", "1"]
    assert told.episodes[0].text == "FRR 0.400; the joint stops 10 mm off the target at 0.0 s"
    assert told.episodes[0].span
    assert told.episodes[1].span == ""
    assert told.shown == ("pid-high", "mine")


# Stories, libraries


def test_stories_are_told_where_their_rows_are() -> None:
    table = read_csv((ROOT / "leaderboard" / "leaderboard.csv").read_text(encoding="utf-8"))
    found = {story.key: story for story in stories(table)}
    assert list(found) == ["pid-low", "pd-low", "pid-high", "square"]
    row = table[(table["env"] == STICTION) & (table["variant"] == "nominal") & (table["compensator"] == "pid-low")]
    assert f"{1e3 * row['limit_cycle_peak_to_peak_ju'].iloc[0]:.2f} mm" in found["pid-low"].answer
    assert stories(results()[1]) == []


def test_another_uplot_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(vendor.UPLOT, "uplot.js", ("youplot/vendor/uplot.min.css", vendor.UPLOT["uplot.js"][1]))
    with pytest.raises(vendor.MissingPackageError, match=r"has the SHA-256 .* install youplot 1\.0\.0"):
        vendor.uplot()


def test_texts_of_strangers_stay_texts(tmp_path: Path) -> None:
    """A name and an error that look like markup, in a folder that an earlier page is in."""
    name = "<img src=x onerror=alert(1)>"
    episodes = synthetic({name: [0.5, 0.6], "pid-high": [0.9, 0.8]}, env=SQUARE, error="</script><b>")
    table = read_csv(csv(leaderboard(episodes)))
    who = everybody([Competitor(name, "mine.py:Mine"), Competitor("pid-high", "pid-high")])
    for _ in range(2):
        page = write_site(Content(table, who, {}), tmp_path / "site")
    text = page.read_text(encoding="utf-8")
    assert "&lt;img src=x" in text
    assert "<img" not in text
    assert "</script><b>" not in text


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(ValueError, match="is not empty, and what is in it is no page"):
        write_site(Content(results()[1], WHO, {}), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
