"""The figure of a map: a metric as colour over two parameters."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colorizer import Colorizer
from matplotlib.colors import ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import LogLocator, NullLocator
from numpy.typing import NDArray

from fo_gym.evaluation.results.map_drawing import Drawing, Layer, Marks, is_logarithmic, layer_of, symbol, unit_of
from fo_gym.evaluation.results.style import VERMILLION, figure_of, label, plain_number
from fo_gym.evaluation.runs.episodes import place_of

Array = NDArray[np.float64]

_SIZE = (5.2, 4.3)
_AT_REST, _LOST = "0.9", "0.45"
"""Greys of cells that do not hunt, and of those without a number."""

__all__ = ["map_figure"]


def map_figure(table: pd.DataFrame, drawing: Drawing) -> Figure:
    """A metric as colour over two parameters, refused and failed cells hatched.

    Args:
        table: as `map_table` gives it.
        drawing: what is drawn of it.
    """
    figure = figure_of(*_SIZE)
    axis = figure.subplots()
    x, y = (np.unique(table[name].to_numpy(float)) for name in (drawing.x, drawing.y))
    layer, failed = layer_of(table, drawing, drawing.metric)
    edges = _edges(axis, "x", x), _edges(axis, "y", y)
    axis.patch.set(facecolor="white", edgecolor="0.6", hatch="////")
    lost = np.isnan(layer.values) & ~failed
    axis.pcolormesh(*edges, np.ma.masked_array(lost, ~lost), cmap=ListedColormap([_LOST]), rasterized=True)
    # A logarithm of 0 would leave a hole.
    values = np.maximum(layer.values, 0.5 * layer.low) if layer.logarithmic else layer.values
    image = axis.pcolormesh(*edges, np.ma.masked_invalid(values), colorizer=_colorizer(layer), rasterized=True)
    bar = figure.colorbar(image, ax=axis, label=label(layer.title, 60))
    if layer.logarithmic:
        bar.ax.yaxis.set_major_formatter(plain_number)
    _add_marks(axis, drawing.marks)
    unit = unit_of(table)
    axis.set_xlabel(symbol(drawing.x, unit) or label(drawing.x))
    axis.set_ylabel(symbol(drawing.y, unit) or label(drawing.y))
    place = place_of(table["env"].iloc[0], table["robot"].iloc[0])
    axis.set_title(f"{label(table['compensator'].iloc[0])}, {label(place)}", fontsize="medium")
    entries: dict[str, tuple[bool, Artist]] = {
        f"at rest (below {layer.low:g})": (layer.rest, Patch(color=_AT_REST)),
        "refused or failed": (bool(failed.any()), Patch(facecolor="white", edgecolor="0.6", hatch="////")),
        "ended early, or does not apply": (bool(lost.any()), Patch(color=_LOST)),
        drawing.marks.line_name: (drawing.marks.line is not None, Line2D([], [], color=VERMILLION, linewidth=1.6)),
    }
    shown = {name: entry for name, (there, entry) in entries.items() if there}
    if shown:
        figure.legend(list(shown.values()), list(shown), loc="outside lower center", ncols=2, fontsize=8)
    return figure


def _colorizer(layer: Layer) -> Colorizer:
    """Its colours and their scale."""
    colours = colormaps["viridis"]
    norm = LogNorm(layer.low, layer.high) if layer.logarithmic else Normalize()
    return Colorizer(colours.with_extremes(under=_AT_REST if layer.rest else colours(0.0)), norm)


def _edges(axis: Axes, which: str, values: Array) -> Array:
    """Where cells end, half way between values; the axis becomes logarithmic where they are spaced like that."""
    logarithmic = is_logarithmic(values)
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
        shown.set_major_formatter(plain_number)
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
