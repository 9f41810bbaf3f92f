"""Figures of the leaderboard: the ranking with its intervals, and the nominal episodes to look at."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from fo_gym.evaluation.competitors.competitor import BASELINE, SUBMISSION, YOURS
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.results.style import BLUE, ORANGE, PAGE, VERMILLION, figure_of, label, save_figure
from fo_gym.evaluation.results.tables import marked
from fo_gym.evaluation.results.ties import RELEVANT
from fo_gym.evaluation.results.trace_figure import trace_figure
from fo_gym.evaluation.runs.contest import Results
from fo_gym.evaluation.runs.episodes import SET, label_of, place_of
from fo_gym.evaluation.runs.provenance import is_reference
from fo_gym.tasks.variants import NOMINAL

Array = NDArray[np.float64]

_COLORS = {BASELINE: BLUE, SUBMISSION: ORANGE, YOURS: VERMILLION}
_WIDTHS, _ROW, _AROUND, _LEGEND = {1: PAGE / 2.0, 2: 0.75 * PAGE, 3: PAGE}, 0.128, 0.62, 0.42
"""Width of a figure by its panels in a row: three fill a page; height of a row of a panel, of what is around them, and
of the legend [in]."""
_SMALL, _TINY = 6.8, 6.2
"""Sizes of letters in print [pt]."""
_SPAN = (-1.0, 4.0)
"""What the axis may show at most, as digits: FRR from -9 to 0.9999."""

__all__ = ["draw_ranking", "figures", "ranking_figure"]


def ranking_figure(table: pd.DataFrame) -> Figure:
    """1 - FRR of every competitor with its interval: a row of panels per environment, a panel per variant, best on top.

    The axis is logarithmic and falls to the right, so that 0.01 and 0.001 lie as far apart as 1 and 0.1, and no outlier
    flattens the rest; what lies outside gets an arrow. A band reaches from the best to where a difference to it begins
    to count. At the right stand the numbers and the letters of tied groups.

    Args:
        table: rows as `leaderboard` gives them.
    """
    table = table[~is_reference(table)]
    sets = list(table[SET].drop_duplicates().itertuples(index=False, name=None))
    envs = list(dict.fromkeys(place_of(env, robot) for env, robot, _ in sets))
    variants = list(dict.fromkeys(variant for _, _, variant in sets))
    rows = max(len(group) for _, group in table.groupby(SET))
    size = (_WIDTHS[min(len(variants), 3)], (_ROW * rows + _AROUND) * len(envs) + _LEGEND)
    figure = figure_of(*size)
    axes = figure.subplots(len(envs), len(variants), squeeze=False)
    places = [place_of(*key[:2]) for key in table[SET].itertuples(index=False, name=None)]
    limits = {str(place): _limits(part["frr"]) for place, part in table.groupby(pd.Series(places, table.index))}
    for key, group in table.groupby(SET, sort=False):
        axis: Axes = axes[envs.index(place_of(*key[:2])), variants.index(key[2])]
        draw_ranking(axis, group, limits[place_of(*key[:2])])
    entries = _entries([origin for origin in _COLORS if (table["origin"] == origin).any()])
    columns = 2 if len(variants) == 1 else 4
    figure.legend(list(entries.values()), list(entries), loc="outside lower center", ncols=columns, fontsize=_SMALL)
    return figure


def _digits(frr: pd.Series[float]) -> Array:
    """The place of an FRR on the axis: 0 at 0, 1 at 0.9, 2 at 0.99, -1 at -9; infinite at 1."""
    with np.errstate(divide="ignore"):
        return -np.log10(np.maximum(1.0 - frr.to_numpy(dtype=np.float64), 0.0))


def _limits(frr: pd.Series[float]) -> tuple[float, float]:
    """The part of the axis that holds every row, but no more than `_SPAN`."""
    places = _digits(frr.dropna())
    low, high = np.clip([np.min(places, initial=1.0), np.max(places, initial=1.0)], *_SPAN)
    return float(np.floor(2.0 * low) / 2.0), max(float(np.ceil(2.0 * high + 0.3) / 2.0), float(np.floor(low)) + 1.0)


def draw_ranking(axis: Axes, rows: pd.DataFrame, limits: tuple[float, float] | None = None) -> None:
    """The ranking of one environment and variant on axes that are there, best on top.

    Args:
        axis: where.
        rows: of one set, as `leaderboard` gives them.
        limits: of the axis, as digits, see `_digits`; by default those that hold every row.
    """
    limits = _limits(rows["frr"]) if limits is None else limits
    axis.set_title(label_of(*rows[SET].iloc[0]), fontsize=_SMALL + 1.0)
    rows = rows.sort_values("frr", na_position="first", kind="stable")
    heights = np.arange(len(rows))
    colors = [_COLORS.get(origin, BLUE) for origin in rows["origin"]]
    values, lows, highs = (np.clip(_digits(rows[name]), *limits) for name in ("frr", "frr_ci_low", "frr_ci_high"))
    axis.hlines(heights, lows, highs, colors=colors, linewidth=1.1)
    axis.scatter([lows, highs], [heights, heights], s=16.0, marker="|", color="0.25", linewidth=0.8)
    for height, value, frr, color, verdict in zip(
        heights, values, _digits(rows["frr"]), colors, rows["verdict"], strict=True
    ):
        marker = "<" if frr < limits[0] else ">" if frr > limits[1] else "o"
        face = "white" if verdict == "behind" else color
        axis.plot(value, height, marker, color=color, markerfacecolor=face, markersize=3.2, clip_on=False)
    _draw_band(axis, rows["frr"].max(), limits)
    _name_rows(axis, rows, heights)
    axis.set_ylim(-0.7, len(rows) - 0.3)
    digits = np.arange(np.ceil(limits[0]), limits[1] + 1e-9)
    axis.set_xlim(*limits)
    axis.set_xticks(digits, [f"{10.0**-digit:.4g}" for digit in digits])
    axis.tick_params(axis="both", labelsize=_TINY, length=2.0, pad=1.5)
    axis.grid(alpha=0.3, linewidth=0.5)
    axis.set_xlabel("1 - FRR, what is left of friction's effect", fontsize=_SMALL)


def _name_rows(axis: Axes, rows: pd.DataFrame, heights: NDArray[np.intp]) -> None:
    """Names at the left, numbers and letters of tied groups at the right; what is yours stands out."""
    names = [label(marked(name, origin)) for name, origin in zip(rows["compensator"], rows["origin"], strict=True)]
    axis.set_yticks(heights, names)
    told = ["no score" if np.isnan(frr) else f"{1.0 - frr:.2g}" for frr in rows["frr"]]
    letters = ["" if pd.isna(group) else _shortened(str(group)) for group in rows["tied_group"]]
    numbers = axis.secondary_yaxis("right")
    numbers.set_yticks(heights, [f"{rest} {group}".rstrip() for rest, group in zip(told, letters, strict=True)])
    numbers.tick_params(labelsize=_TINY, length=2.0, pad=1.5)
    for height, origin, text in zip(heights, rows["origin"], axis.get_yticklabels(), strict=True):
        if origin == YOURS:
            axis.axhspan(height - 0.5, height + 0.5, color=VERMILLION, alpha=0.12, linewidth=0)
            text.set(color=VERMILLION, fontweight="bold")


def _shortened(letters: str) -> str:
    """Runs of four or more letters of the alphabet by their ends: "f-q" of "fghijklmnopq"."""
    starts = [i for i in range(len(letters)) if i == 0 or ord(letters[i]) != ord(letters[i - 1]) + 1]
    runs = [letters[start:end] for start, end in pairwise([*starts, len(letters)])]
    return "".join(run if len(run) < 4 else f"{run[0]}-{run[-1]}" for run in runs)


def _draw_band(axis: Axes, best: float, limits: tuple[float, float]) -> None:
    """From the best to where a row is behind it by the smallest difference that counts."""
    if not np.isnan(best):
        low, high = np.clip(_digits(pd.Series([best - RELEVANT, best])), *limits)
        axis.axvspan(low, high, color="0.5", alpha=0.25, linewidth=0)


def _entries(origins: list[str]) -> dict[str, Artist]:
    """Of the legend: what filled and empty marks are, and the colours where there are several."""
    dot = {"linestyle": "", "marker": "o", "markersize": 3.2}
    entries: dict[str, Artist] = {
        "best, or tied with it": Line2D([], [], color="0.3", **dot),  # type: ignore[arg-type]
        "behind": Line2D([], [], color="0.3", markerfacecolor="white", **dot),  # type: ignore[arg-type]
        "95 % interval": Line2D([], [], color="0.3", linewidth=1.1, marker="|", markersize=4.0, markeredgewidth=0.8),
        f"within {RELEVANT:g} of the best": Patch(color="0.5", alpha=0.25, linewidth=0),
    }
    if len(origins) > 1:
        entries |= {marked(each, each): Line2D([], [], color=_COLORS[each], **dot) for each in origins}  # type: ignore[arg-type]
    return entries


def figures(results: Results, folder: Path, table: pd.DataFrame | None = None) -> list[Path]:
    """Draw everything that the results hold into `folder`.

    Args:
        results: what was run.
        folder: where the files go.
        table: `leaderboard` of the results' episodes, where it is at hand already.

    Returns:
        The files.
    """
    table = leaderboard(results.episodes) if table is None else table
    origins = dict(zip(table["compensator"], table["origin"], strict=True))
    ranked = table[~is_reference(table)]
    places = ranked.apply(lambda row: _file(place_of(row["env"], row["robot"])), axis=1)
    drawn = {f"ranking-{place}": ranking_figure(part) for place, part in ranked.groupby(places, sort=False)}
    nominal = [trace for trace in results.traces if trace.variant == NOMINAL]
    for place in dict.fromkeys(place_of(trace.env, trace.robot) for trace in nominal):
        there = [trace for trace in nominal if place_of(trace.env, trace.robot) == place]
        drawn[_file(place)] = trace_figure(there, origins)
    return [path for name, figure in drawn.items() for path in save_figure(figure, folder / name)]


def _file(place: str) -> str:
    """The name for a file of a place."""
    return place.replace(" ", "-")
