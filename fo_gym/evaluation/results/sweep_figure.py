"""The figure of a sweep: a curve over one gain, a map over two."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fo_gym.evaluation.results.style import figure_of, label
from fo_gym.evaluation.results.sweep import summary_of
from fo_gym.evaluation.runs.episodes import SET, label_of

_SIZE = (4.6, 3.4)

__all__ = ["sweep_figure"]


def sweep_figure(table: pd.DataFrame, gains: Sequence[str]) -> Figure:
    """FRR over one or two gains, a panel per environment and variant.

    Args:
        table: as `sweep` gives it.
        gains: names of its gains, one or two.

    Raises:
        ValueError: there are more gains.
    """
    if len(gains) > 2:
        raise ValueError(f"a sweep over {len(gains)} gains, {', '.join(gains)}, is not drawn; sweep one or two")
    summary = summary_of(table, gains)
    panels = list(summary.groupby(SET, sort=False))
    figure = figure_of(_SIZE[0] * len(panels), _SIZE[1])
    for axis, (key, rows) in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        draw = _curve if len(gains) == 1 else _map
        draw(axis, rows, gains)
        axis.set_title(f"{label(table['compensator'].iloc[0])}: {label_of(*key)}", fontsize="medium")
    return figure


def _curve(axis: Axes, rows: pd.DataFrame, gains: Sequence[str]) -> None:
    """The interquartile mean, within the range of the episodes."""
    rows = rows.sort_values(gains[0])
    values = rows[gains[0]]
    axis.fill_between(values, rows["frr_worst"], rows["frr_best"], alpha=0.2, label="episodes")
    axis.plot(values, rows["frr"], marker="o", markersize=3, label="interquartile mean")
    if (values > 0).all() and values.max() > 5.0 * values.min():
        axis.set_xscale("log")
    axis.set_xlabel(label(gains[0]))
    axis.set_ylabel("friction rejection ratio")
    axis.grid(alpha=0.3)
    axis.legend(fontsize="small")


def _map(axis: Axes, rows: pd.DataFrame, gains: Sequence[str]) -> None:
    """A cell per set of gains, grey where it failed; the best one is marked."""
    axis.set_facecolor("0.85")
    frr = rows.pivot(index=gains[1], columns=gains[0], values="frr")
    image = axis.imshow(frr.to_numpy(), origin="lower", aspect="auto")
    for ticks, values in ((axis.set_xticks, frr.columns), (axis.set_yticks, frr.index)):
        ticks(range(len(values)), [f"{value:.4g}" for value in values])
    axis.tick_params(axis="x", labelrotation=90)
    axis.set_xlabel(label(gains[0]))
    axis.set_ylabel(label(gains[1]))
    if frr.notna().to_numpy().any():
        row, column = np.unravel_index(np.nanargmax(frr.to_numpy()), frr.shape)
        axis.plot(column, row, marker="*", color="white", markeredgecolor="black", markersize=11)
    axis.figure.colorbar(image, ax=axis, label="friction rejection ratio")
