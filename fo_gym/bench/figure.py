"""The figure of growth: times over what they grow with."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from fo_gym.bench.bars import CORES, ENVS, JOINTS, LENGTH
from fo_gym.evaluation.results.style import BLACK, COLOURS, plain_ticks
from fo_gym.files import draft_of

_PANELS = {
    ENVS: ("number of environments", 1.0),
    JOINTS: ("number of joints", 1.0),
    CORES: ("number of threads", -1.0),
    LENGTH: ("length of the episode [s]", 1.0),
}
"""What is below each panel, and the power of what takes the same time for each of them, or shares it."""

_SIZE = (7.2, 5.6)

__all__ = ["draw_growth", "growth_figure"]


def growth_figure(times: pd.DataFrame) -> Figure:
    """A panel for each thing that times grow with, both axes logarithmic; dashed is linear.

    Args:
        times: rows as `Growth.tables` gives them.
    """
    figure = Figure(figsize=_SIZE, layout="constrained")
    envs = list(dict.fromkeys(times["env"]))
    colors = {env: COLOURS[i % len(COLOURS)] for i, env in enumerate(envs)}
    for axis, (over, (text, slope)) in zip(figure.subplots(2, 2).flat, _PANELS.items(), strict=True):
        rows = times[times["over"] == over]
        for env, line in rows.groupby("env", sort=False):
            errors = np.abs(line[["q1", "q3"]].to_numpy().T - line["ms"].to_numpy())
            axis.errorbar(line["size"], line["ms"], errors, label=env, color=colors[env], marker="o", markersize=3)
        if len(rows):
            _add_linear(axis, rows, slope)
        axis.set_xlabel(text)
        axis.set_ylabel("time of an evaluation [ms]" if over == LENGTH else "time of a batch's step [ms]")
        axis.grid(alpha=0.3)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize="small")
    return figure


def _add_linear(axis: Axes, rows: pd.DataFrame, slope: float) -> None:
    """Logarithmic axes, and a line of that slope through the first environment's last point."""
    line = rows[rows["env"] == rows["env"].iloc[0]]
    points, end = np.sort(line["size"].to_numpy()), line["ms"].to_numpy()[-1]
    axis.plot(points, end * (points / points[-1]) ** slope, color=BLACK, linestyle="--", linewidth=0.8)
    axis.set_xscale("log", base=2)
    axis.set_yscale("log")
    axis.set_xticks(points, [f"{point:g}" for point in points])
    axis.xaxis.set_minor_locator(NullLocator())
    low, high = axis.get_ylim()
    plain_ticks(axis.yaxis, *((1.0,) if high > 30.0 * low else (1.0, 2.0, 5.0)))


def draw_growth(times: pd.DataFrame, path: Path) -> None:
    """Write the figure."""
    with mpl.rc_context({"savefig.dpi": 110}), draft_of(path) as draft:
        growth_figure(times).savefig(draft, metadata={"Software": None})
