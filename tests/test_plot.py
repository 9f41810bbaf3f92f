"""`fo_gym.plot`: what a notebook draws is what was run, on new figures and on those that are there."""

from __future__ import annotations

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

import fo_gym
from fo_gym.evaluation.episode.trace import Trace

pytestmark = pytest.mark.looks

STICTION, SQUARE = "FJRStiction-v0", "FJRSquare-v0"
NAMES = ("none", "pid-low", "pid-high")


@pytest.fixture(scope="module")
def traces() -> tuple[Trace, ...]:
    return tuple(fo_gym.trace(name, STICTION, duration=0.5) for name in NAMES)


@pytest.fixture(scope="module")
def rows() -> pd.DataFrame:
    found = [fo_gym.evaluate(name, STICTION, variant="randomized", seeds=3, duration=0.5) for name in NAMES]
    return pd.concat(found, ignore_index=True)


def test_a_trace_is_the_episode_that_is_scored(traces: tuple[Trace, ...]) -> None:
    for name, trace in zip(NAMES, traces, strict=True):
        scored = fo_gym.evaluate(name, STICTION, duration=0.5)
        assert (trace.compensator, trace.env, trace.variant, trace.seed) == (name, STICTION, "nominal", 0)
        assert trace.frr == scored["frr"][0]
        assert trace.signals["time"][-1] == pytest.approx(0.5)
    other = fo_gym.trace("pid-low", STICTION, variant="randomized", seed=7, duration=0.5)
    assert (other.variant, other.seed) == ("randomized", 7)
    assert not np.array_equal(other.signals["theta"][:10], traces[1].signals["theta"][:10])


def test_an_episode(traces: tuple[Trace, ...]) -> None:
    figure = fo_gym.plot.episode(*traces)
    left, right = figure.axes
    low = traces[1].signals
    drawn = {str(line.get_color()): line.get_ydata() for line in left.lines}
    expected = 1e3 * (low["theta"] - low["theta_d"])[:, 0]
    assert any(np.array_equal(values, expected) for values in drawn.values())
    assert (len(left.lines), len(right.lines)) == (3, 2)
    names = [text.get_text().split("  ")[0] for text in figure.legends[0].get_texts()]
    assert sorted(names) == sorted(NAMES)
    assert figure._repr_png_().startswith(b"\x89PNG")  # type: ignore[attr-defined]


def test_on_axes_that_are_there(traces: tuple[Trace, ...], rows: pd.DataFrame) -> None:
    figure, axes = plt.subplots(1, 3)
    assert fo_gym.plot.episode(*traces, axes=(axes[0], axes[1])) is figure
    assert fo_gym.plot.ranking(rows, ax=axes[2]) is figure
    assert [text.get_text() for text in axes[2].get_yticklabels()] == ["pid-low", "pid-high"]
    assert len(axes[0].get_legend().get_texts()) == 3
    plt.close(figure)


def test_a_ranking_is_of_episodes_or_of_a_leaderboard(rows: pd.DataFrame) -> None:
    first = fo_gym.plot.ranking(rows)
    (axis,) = first.axes
    assert axis.get_title() == f"{STICTION}, randomized"
    from fo_gym.evaluation.results.leaderboard import leaderboard  # noqa: PLC0415 (what leaderboard.csv holds)

    (again,) = fo_gym.plot.ranking(leaderboard(rows)).axes
    assert [line.get_xdata().tolist() for line in axis.lines] == [line.get_xdata().tolist() for line in again.lines]


def test_what_cannot_be_drawn(traces: tuple[Trace, ...], rows: pd.DataFrame) -> None:
    with pytest.raises(ValueError, match="give one or more, all of the same episode"):
        fo_gym.plot.episode()
    with pytest.raises(ValueError, match="all of the same episode"):
        fo_gym.plot.episode(traces[0], replace(traces[1], seed=1))
    with pytest.raises(ValueError, match="there is nobody to rank"):
        fo_gym.plot.ranking(rows[rows["compensator"] == "none"])
    figure, axis = plt.subplots()
    both = pd.concat([rows, rows.assign(variant="hardware")], ignore_index=True)
    with pytest.raises(ValueError, match="of 2 environments and variants; leave ax out"):
        fo_gym.plot.ranking(both, ax=axis)
    plt.close(figure)
