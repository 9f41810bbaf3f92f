"""The figures: names that do not overlap, nothing that flattens the rest, no more curves than colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from tables import REGULATION, SQUARE, STICTION, synthetic
from test_text import HOSTILE

from fo_gym.evaluation.competitors.competitor import SUBMISSION, YOURS
from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.results.figures import ranking_figure
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.results.style import label
from fo_gym.evaluation.results.tables import marked
from fo_gym.evaluation.results.trace_figure import trace_figure

pytestmark = pytest.mark.looks

LEVELS = [0.999, 0.998, 0.99, 0.9, 0.5, 0.0, -5.0, -20.0, 1.0, 0.99999]


def drawn(figure: Figure) -> Figure:
    """The figure after it was drawn, so that everything has its place."""
    figure.draw_without_rendering()
    return figure


def boxes(texts: Sequence[Text]) -> list[Bbox]:
    return [text.get_window_extent() for text in texts if text.get_text()]


def table_of(levels: Sequence[float], env: str = SQUARE, variant: str = "nominal") -> pd.DataFrame:
    """What `ranking_figure` reads of a leaderboard."""
    rows = pd.DataFrame({"frr": levels, "robot": "", "compensator": [f"long-name-{i}" for i in range(len(levels))]})
    wide = {"frr_ci_low": rows["frr"] - 0.1, "frr_ci_high": np.minimum(rows["frr"] + 0.1, 1.0)}
    return rows.assign(env=env, variant=variant, origin="baseline", verdict="behind", tied_group="abc", **wide)


def sets_of(envs: Sequence[str], variants: Sequence[str]) -> pd.DataFrame:
    """A table of these sets, twenty-four competitors in each."""
    rng = np.random.default_rng(0)
    sets = [(env, variant) for env in envs for variant in variants]
    return pd.concat([table_of(list(1.0 - 10.0 ** rng.uniform(-3.0, 1.5, 24)), *each) for each in sets])


NINE = ((STICTION, REGULATION, SQUARE), ("nominal", "randomized", "hardware"))


@pytest.mark.parametrize(
    ("envs", "variants"),
    [((SQUARE,), ("nominal",)), pytest.param(*NINE, marks=pytest.mark.slow)],
    ids=["one", "nine"],
)
def test_no_name_covers_another(envs: Sequence[str], variants: Sequence[str]) -> None:
    figure = drawn(ranking_figure(sets_of(envs, variants)))
    assert len(figure.axes) == len(envs) * len(variants)
    names = [text for axis in figure.axes for text in axis.get_yticklabels()]
    numbers = [text for axis in figure.axes for text in axis.child_axes[0].get_yticklabels()]
    everything = boxes([*names, *numbers])
    assert len(everything) == 2 * 24 * len(figure.axes)
    whole = figure.bbox.padded(1.0)
    assert all(whole.containsx(box.x0) and whole.containsx(box.x1) for box in everything)
    assert [(a, b) for i, a in enumerate(everything) for b in everything[i + 1 :] if a.overlaps(b)] == []


def test_an_outlier_does_not_flatten_the_rest() -> None:
    """0.99, 0.999 and 0.9999 stay apart beside -1e6, which gets an arrow, and every number is printed."""
    levels = [0.9995, 0.99, 0.9, 0.0, -1e6]
    (axis,) = ranking_figure(table_of(levels)).axes
    low, high = axis.get_xlim()
    at = {float(line.get_ydata()[0]): line for line in axis.lines}
    places = [(at[4.0 - i].get_xdata()[0] - low) / (high - low) for i in range(5)]
    assert all(better - worse > 0.1 for better, worse in pairwise(places))
    assert [at[float(i)].get_marker() for i in range(5)] == ["<", "o", "o", "o", "o"]
    numbers = [text.get_text().split()[0] for text in axis.child_axes[0].get_yticklabels()]
    assert numbers == ["1e+06", "1", "0.1", "0.01", "0.0005"]


def test_who_is_tied_is_filled_and_who_is_not_ours_has_a_colour() -> None:
    episodes = synthetic({"a": [0.9, 0.8] * 5, "b": [0.8, 0.9] * 5, "c": [0.1, 0.1] * 5})
    episodes["origin"] = episodes["compensator"].map({"a": "baseline", "b": YOURS, "c": SUBMISSION})
    (axis,) = ranking_figure(leaderboard(episodes)).axes
    faces = [line.get_markerfacecolor() for line in axis.lines]
    assert [face == "white" for face in faces] == [True, False, False]
    assert len({line.get_color() for line in axis.lines}) == 3
    assert [text.get_text() for text in axis.get_yticklabels()] == ["c †", "a", "b *"]
    assert [text.get_fontweight() for text in axis.get_yticklabels()] == ["normal", "normal", "bold"]


def test_a_ranking_without_scores_is_drawn() -> None:
    (axis,) = drawn(ranking_figure(table_of([np.nan, np.nan]).assign(tied_group=np.nan))).axes
    assert [text.get_text() for text in axis.child_axes[0].get_yticklabels()] == ["no score", "no score"]


# Names are text


def test_names_in_figures_are_text() -> None:
    """No mathematics, no missing glyphs (a warning, which is an error here), no name left out."""
    episodes = synthetic({name: [0.5] for name in HOSTILE[::2]}, "nominal")
    (axis,) = drawn(ranking_figure(leaderboard(episodes))).axes
    assert len(axis.get_yticklabels()) == len(HOSTILE[::2])
    assert label("$x$ \\$ \u89b3\n") == r"\$x\$ \\$ \u89b3\n"
    for text in HOSTILE:
        shown, is_math = Text(text=label(text))._preprocess_math(label(text))
        assert not is_math
        assert shown.isprintable()
        assert len(shown) < 200


# The episodes


def trace(name: str, frr: float, env: str = STICTION, offset: float = 1e-3) -> Trace:
    n, dof = 200, 1 if env == STICTION else 7
    time = np.linspace(0.0, 20.0, n, dtype=np.float32)
    joints = np.zeros((n, dof), np.float32)
    angle = np.linspace(0.0, 2.0 * np.pi, n)
    tool = (0.1 * np.stack([0 * angle, np.cos(angle), np.sin(angle)], axis=1)).astype(np.float32)
    signals = {"time": time, "theta": joints + np.float32(offset), "theta_ideal": joints, "theta_d": joints}
    if env == SQUARE:
        signals |= {"tool": tool + np.float32(offset), "tool_d": tool, "tool_ideal": tool}
    robot = "single_link" if env == STICTION else "miro_like"
    return Trace(env, robot, "nominal", name, 0, "median", frr, "m" if dof == 1 else "rad", signals)


@pytest.mark.parametrize("env", [STICTION, REGULATION, SQUARE])
def test_there_are_no_more_curves_than_colours(env: str) -> None:
    """References, yours, and the best of the others; the legend is below and covers nothing."""
    others = [trace(f"n{i:02}", 0.9 - 0.01 * i, env, 1e-3 * (i + 1)) for i in range(20)]
    traces = [trace("none", 0.0, env, 0.01), trace("ideal", 1.0, env, 0.0), *others, trace("_own$$", -3.0, env, -0.02)]
    figure = drawn(trace_figure(traces, {"_own$$": YOURS}))
    left, right = figure.axes
    (legend,) = figure.legends
    names = [text.get_text().split("  ")[0] for text in legend.get_texts()]
    expected = ["none", "ideal", label(marked("_own$$", YOURS)), *(f"n{i:02}" for i in range(5))]
    assert names == expected + (["reference"] if env == SQUARE else [])
    styles = [(line.get_color(), str(line.get_linestyle())) for line in left.lines]
    assert len({color for color, _ in styles}) == len(styles) == len(names)
    own = left.lines[2]
    assert own.get_linewidth() == max(line.get_linewidth() for line in left.lines)
    box = legend.get_window_extent()
    assert figure.bbox.padded(1.0).containsx(box.x0)
    assert figure.bbox.padded(1.0).containsx(box.x1)
    assert box.y1 < min(axis.get_tightbbox().y0 for axis in (left, right))
    assert len(right.lines) == (7 if env == SQUARE else 6)
    assert "6 of 21" in left.get_title()


def test_a_single_competitor_is_drawn_without_references() -> None:
    figure = drawn(trace_figure([trace("a", 0.5)], {}))
    assert figure.axes[0].get_title() == f"{STICTION}, nominal"


@pytest.mark.parametrize(("settles", "shown"), [(0.0, 0.0), (8.0, 8.0), (19.9, 15.0)])
def test_the_magnified_panel_shows_rest_alone_and_as_high_as_it_is(settles: float, shown: float) -> None:
    """From where the joint would have come to rest, or the last quarter; the motion before is far larger."""
    own = trace("a", 0.5)
    time = own.signals["time"]
    moves = np.float32(time < settles)[:, None]
    signals = {**own.signals, "theta_ideal": moves * 0.1 * time[:, None], "theta": np.full_like(moves, 1e-5)}
    figure = drawn(trace_figure([replace(own, signals=signals)], {}))
    left, right = figure.axes[1].get_xlim()
    assert left == pytest.approx(shown, abs=0.2)
    assert right == 20.0
    if settles < 15.0:
        assert figure.axes[1].get_ylim() == pytest.approx((-0.013, 0.013), rel=1e-3)  # mm
