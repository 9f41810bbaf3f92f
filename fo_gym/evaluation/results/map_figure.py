"""The figure of a map: a metric as colour over two parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colorizer import Colorizer
from matplotlib.colors import Colormap, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
from numpy.typing import NDArray

from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.metrics.hunting import HUNTING
from fo_gym.evaluation.metrics.registry import HEADLINE
from fo_gym.evaluation.results.style import VERMILLION, figure_of, label
from fo_gym.evaluation.runs.episodes import FAILED, place_of

Array = NDArray[np.float64]

_SIZE = (5.2, 4.3)
_MILLI = 1e3
_DECADES = 4.0
"""Decades below the largest value that a logarithmic colour shows."""
_SYMBOLS = {
    "L": "$L$ [1/s]",
    "Lp": "$L_p$ [1/s]",
    "Li": "$L_i$ [1/s²]",
    "f_s/f_c": "$f_s/f_c$",
    "v_s": "$v_s$ [{unit}/s]",
}
_HUNTING = "limit_cycle_peak_to_peak_ju"
_AT_REST, _LOST = "0.9", "0.45"
"""Greys of cells that do not hunt, and of those without a number."""
_PLAIN = FuncFormatter(lambda value, _: f"{value:g}")

__all__ = ["Marks", "map_figure"]


@dataclass(frozen=True)
class Marks:
    """What is marked on a map.

    Attributes:
        points: places (x, y) by their names.
        line: a curve of points (n, 2), or None.
        line_name: what that is.
    """

    points: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    line: Array | None = None
    line_name: str = ""


def map_figure(table: pd.DataFrame, x: str, y: str, metric: str, marks: Marks = Marks()) -> Figure:
    """A metric as colour over two parameters, refused and failed cells hatched.

    Limit cycles are coloured above what counts as hunting; of the friction rejection ratio, what is missing to 1.

    Args:
        table: as `map_table` gives it.
        x, y: names of the two parameters.
        metric: column of the metric.
        marks: what is marked.
    """
    figure = figure_of(*_SIZE)
    axis = figure.subplots()
    grid = table.pivot(index=y, columns=x, values=metric)
    unit = str(table["joint_unit"].max())
    values, title = _values(grid.to_numpy(dtype=np.float64), metric, unit)
    failed = (table.assign(failed=table["status"] == FAILED).pivot(index=y, columns=x, values="failed")).to_numpy()
    edges = _edges(axis, "x", grid.columns.to_numpy(float)), _edges(axis, "y", grid.index.to_numpy(float))
    axis.patch.set(facecolor="white", edgecolor="0.6", hatch="////")
    lost = np.isnan(values) & ~failed
    axis.pcolormesh(*edges, np.ma.masked_array(lost, ~lost), cmap=ListedColormap([_LOST]), rasterized=True)
    colour = Colorizer(*_colours(values, metric))
    image = axis.pcolormesh(*edges, np.ma.masked_invalid(values), colorizer=colour, rasterized=True)
    bar = figure.colorbar(image, ax=axis, label=title)
    if isinstance(image.norm, LogNorm):
        bar.ax.yaxis.set_major_formatter(_PLAIN)
    _add_marks(axis, marks)
    axis.set_xlabel(_SYMBOLS.get(x, label(x)).replace("{unit}", unit))
    axis.set_ylabel(_SYMBOLS.get(y, label(y)).replace("{unit}", unit))
    place = place_of(table["env"].iloc[0], table["robot"].iloc[0])
    axis.set_title(f"{label(table['compensator'].iloc[0])}, {label(place)}", fontsize="medium")
    entries: dict[str, tuple[bool, Artist]] = {
        f"at rest (below {_MILLI * HUNTING:g})": (metric == _HUNTING, Patch(color=_AT_REST)),
        "refused or failed": (bool(failed.any()), Patch(facecolor="white", edgecolor="0.6", hatch="////")),
        "ended early, or does not apply": (bool(lost.any()), Patch(color=_LOST)),
        marks.line_name: (marks.line is not None, Line2D([], [], color=VERMILLION, linewidth=1.6)),
    }
    shown = {name: entry for name, (there, entry) in entries.items() if there}
    if shown:
        figure.legend(list(shown.values()), list(shown), loc="outside lower center", ncols=2, fontsize=8)
    return figure


def _values(values: Array, metric: str, joint_unit: str) -> tuple[Array, str]:
    """What is coloured, and what the colour bar says."""
    if metric == HEADLINE:
        return 1.0 - values, "1 - FRR, what is left of friction's effect"
    told = METRICS[metric]
    if metric == _HUNTING:
        return _MILLI * values, f"limit cycle, peak to peak [m{joint_unit}]"
    if told.unit == "ju":
        return _MILLI * values, f"{label(metric.removesuffix('_ju').replace('_', ' '))} [m{joint_unit}]"
    return values, f"{label(metric.replace('_', ' '), 60)}"


def _colours(values: Array, metric: str) -> tuple[Colormap, Normalize]:
    """Colours and their scale: logarithmic where all is above 0."""
    finite = values[np.isfinite(values)]
    high = float(np.max(finite, initial=0.0))
    if metric == _HUNTING:
        low = _MILLI * HUNTING
        return colormaps["viridis"].with_extremes(under=_AT_REST), LogNorm(low, max(high, 10.0 * low))
    if high > 0.0 and (finite >= 0.0).all():
        low = max(float(np.min(finite[finite > 0.0], initial=high)), high * 10.0**-_DECADES)
        return colormaps["viridis"].with_extremes(under=colormaps["viridis"](0.0)), LogNorm(
            min(low, 0.999 * high), high
        )
    return colormaps["viridis"], Normalize()


def _edges(axis: Axes, which: str, values: Array) -> Array:
    """Where cells end, half way between values; the axis becomes logarithmic where they are spaced like that."""
    logarithmic = bool(values[0] > 0.0 and values[-1] > 4.0 * values[0])
    places = np.log(values) if logarithmic else values
    if len(places) == 1:
        ends = np.array([places[0] - 0.5, places[0] + 0.5])
    else:
        middles = 0.5 * (places[1:] + places[:-1])
        ends = np.array([2.0 * places[0] - middles[0], *middles, 2.0 * places[-1] - middles[-1]])
    if logarithmic:
        shown = axis.xaxis if which == "x" else axis.yaxis
        axis.set(**{f"{which}scale": "log"})
        shown.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        shown.set_major_formatter(_PLAIN)
        shown.set_minor_locator(NullLocator())
    return np.exp(ends) if logarithmic else ends


def _add_marks(axis: Axes, marks: Marks) -> None:
    """Points with their names and a line, on the map as it is."""
    low_x, high_x, low_y, high_y = *axis.get_xlim(), *axis.get_ylim()
    halo = [withStroke(linewidth=2.5, foreground="white")]
    for name, (x, y) in marks.points.items():
        if low_x <= x <= high_x and low_y <= y <= high_y:
            axis.plot(x, y, "D", color=VERMILLION, markeredgecolor="white", markersize=7)
            right = axis.transData.transform((x, y))[0] > axis.bbox.x0 + 0.6 * axis.bbox.width
            place, side = (-9, "right") if right else (9, "left")
            axis.annotate(
                name, (x, y), (place, -9), textcoords="offset points", ha=side, fontsize=8.5, path_effects=halo
            )
    if marks.line is not None:
        axis.plot(*marks.line.T, color=VERMILLION, linewidth=1.6)
    axis.set(xlim=(low_x, high_x), ylim=(low_y, high_y))
