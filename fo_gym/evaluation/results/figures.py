"""Figures of the leaderboard: the ranking with its intervals, and the nominal episodes to look at."""

from __future__ import annotations

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
from fo_gym.evaluation.results.style import BLUE, ORANGE, VERMILLION, label, save_figure
from fo_gym.evaluation.results.tables import marked
from fo_gym.evaluation.results.ties import RELEVANT
from fo_gym.evaluation.results.trace_figure import trace_figure
from fo_gym.evaluation.runs.contest import Results
from fo_gym.evaluation.runs.episodes import SET, label_of, place_of
from fo_gym.evaluation.runs.provenance import is_reference
from fo_gym.tasks.variants import NOMINAL

Array = NDArray[np.float64]

_COLORS = {BASELINE: BLUE, SUBMISSION: ORANGE, YOURS: VERMILLION}
_WIDTH, _ROW, _AROUND = 4.3, 0.17, 0.75
"""Width of a panel, height of a row, and height of a panel without its rows [in]."""
_SPAN = (-1.0, 4.0)
"""What the axis may show at most, as digits: FRR from -9 to 0.9999."""

__all__ = ["figures", "ranking_figure"]


def ranking_figure(table: pd.DataFrame) -> Figure:
    """1 - FRR of every competitor with its interval, a panel per environment and variant, best on top.

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
    size = (_WIDTH * len(envs), (_ROW * rows + _AROUND) * len(variants) + 0.3)
    figure = Figure(figsize=size, layout="constrained")
    figure.get_layout_engine().set(w_pad=0.08)  # type: ignore[union-attr,call-arg]
    axes = figure.subplots(len(variants), len(envs), squeeze=False, sharex=True)
    limits = _limits(table)
    for key, group in table.groupby(SET, sort=False):
        axis: Axes = axes[variants.index(key[2]), envs.index(place_of(*key[:2]))]
        _draw_ranking(axis, group.sort_values("frr", na_position="first", kind="stable"), limits)
        axis.set_title(label_of(*key), fontsize="medium")
    origins = [origin for origin in _COLORS if (table["origin"] == origin).any()]
    _add_legend(figure, origins, ncols=2 if len(envs) == 1 else 4)
    return figure


def _digits(frr: pd.Series[float]) -> Array:
    """The place of an FRR on the axis: 0 at 0, 1 at 0.9, 2 at 0.99, -1 at -9; infinite at 1."""
    with np.errstate(divide="ignore"):
        return -np.log10(np.maximum(1.0 - frr.to_numpy(dtype=np.float64), 0.0))


def _limits(table: pd.DataFrame) -> tuple[float, float]:
    """The part of the axis that holds every row, but no more than `_SPAN`."""
    places = _digits(table["frr"].dropna())
    low, high = np.clip([np.min(places, initial=1.0), np.max(places, initial=1.0)], *_SPAN)
    return float(np.floor(low)), max(float(np.ceil(high)), float(np.floor(low)) + 1.0)


def _draw_ranking(axis: Axes, rows: pd.DataFrame, limits: tuple[float, float]) -> None:
    """The rows from bottom to top."""
    heights = np.arange(len(rows))
    colors = [_COLORS.get(origin, BLUE) for origin in rows["origin"]]
    values, lows, highs = (np.clip(_digits(rows[name]), *limits) for name in ("frr", "frr_ci_low", "frr_ci_high"))
    axis.hlines(heights, lows, highs, colors=colors, linewidth=1.4)
    for height, value, frr, color, verdict in zip(
        heights, values, _digits(rows["frr"]), colors, rows["verdict"], strict=True
    ):
        marker = "<" if frr < limits[0] else ">" if frr > limits[1] else "o"
        face = "white" if verdict == "behind" else color
        axis.plot(value, height, marker, color=color, markerfacecolor=face, markersize=4.5, clip_on=False)
    _draw_band(axis, rows["frr"].max(), limits)
    names = [label(marked(name, origin)) for name, origin in zip(rows["compensator"], rows["origin"], strict=True)]
    axis.set_yticks(heights, names, fontsize=8)
    told = ["no score" if np.isnan(frr) else f"{1.0 - frr:.2g}" for frr in rows["frr"]]
    letters = ["" if pd.isna(group) else str(group) for group in rows["tied_group"]]
    numbers = axis.secondary_yaxis("right")
    numbers.set_yticks(
        heights, [f"{rest} {group}".rstrip() for rest, group in zip(told, letters, strict=True)], fontsize=8
    )
    for height, origin, text in zip(heights, rows["origin"], axis.get_yticklabels(), strict=True):
        if origin == YOURS:
            axis.axhspan(height - 0.5, height + 0.5, color=VERMILLION, alpha=0.12, linewidth=0)
            text.set(color=VERMILLION, fontweight="bold")
    axis.set_ylim(-0.7, len(rows) - 0.3)
    digits = np.arange(limits[0], limits[1] + 1.0)
    axis.set_xlim(*limits)
    axis.set_xticks(digits, [f"{10.0**-digit:.4g}" for digit in digits])
    axis.tick_params(axis="x", labelbottom=True)
    axis.grid(alpha=0.3)
    axis.set_xlabel("1 - FRR, what is left of friction's effect", fontsize="small")


def _draw_band(axis: Axes, best: float, limits: tuple[float, float]) -> None:
    """From the best to where a row is behind it by the smallest difference that counts."""
    if not np.isnan(best):
        low, high = np.clip(_digits(pd.Series([best - RELEVANT, best])), *limits)
        axis.axvspan(low, high, color="0.5", alpha=0.25, linewidth=0)


def _add_legend(figure: Figure, origins: list[str], ncols: int) -> None:
    """Below all panels: what filled and empty marks are, and the colours where there are several."""
    dot = {"linestyle": "", "marker": "o", "markersize": 4.5}
    entries: dict[str, Artist] = {
        "best, or tied with it": Line2D([], [], color="0.3", **dot),  # type: ignore[arg-type]
        "behind": Line2D([], [], color="0.3", markerfacecolor="white", **dot),  # type: ignore[arg-type]
        "95 % interval": Line2D([], [], color="0.3", linewidth=1.4),
        f"within {RELEVANT:g} of the best": Patch(color="0.5", alpha=0.25, linewidth=0),
    }
    if len(origins) > 1:
        entries |= {marked(each, each): Line2D([], [], color=_COLORS[each], **dot) for each in origins}  # type: ignore[arg-type]
    figure.legend(list(entries.values()), list(entries), loc="outside lower center", ncols=ncols, fontsize=8)


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
    drawn = {"ranking": ranking_figure(table)}
    nominal = [trace for trace in results.traces if trace.variant == NOMINAL]
    for place in dict.fromkeys(place_of(trace.env, trace.robot) for trace in nominal):
        there = [trace for trace in nominal if place_of(trace.env, trace.robot) == place]
        drawn[place.replace(" ", "-")] = trace_figure(there, origins)
    return [path for name, figure in drawn.items() for path in save_figure(figure, folder / name)]
