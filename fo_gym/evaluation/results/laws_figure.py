"""The figure on friction laws: competitors over laws."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from fo_gym.evaluation.results.laws import over_laws
from fo_gym.evaluation.results.style import PAGE, figure_of, label, save_figure
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.specs import BUILT_IN

_ROW, _SMALL = 0.19, 6
"""Height of a row [in], and size of its letters [pt]."""

__all__ = ["laws_figure"]


def laws_figure(protocol: Protocol, table: pd.DataFrame, folder: Path) -> Path:
    """Write laws.png: a panel per set of episodes, a row per competitor, a column per law, FRR in each cell.

    Args:
        protocol: whose laws they are.
        table: as `leaderboard` gives it.
        folder: for the figure.
    """
    panels = list(over_laws(protocol, table))
    rows = max(len(next(iter(by_law.values()))) for _, by_law in panels)
    figure = figure_of(max(PAGE, PAGE / 3.0 * len(panels)), 1.1 + _ROW * rows)
    for axis, (place, by_law) in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        first = next(iter(by_law.values()))
        order = [name for name in first.sort_values("frr", ascending=False).index if name not in BUILT_IN]
        frr = np.array([part["frr"].reindex(order).to_numpy(dtype=float) for part in by_law.values()]).T
        axis.set_facecolor("0.85")
        axis.imshow(frr, vmin=0.5, vmax=1.0, aspect="auto", cmap="viridis")
        for (i, j), value in np.ndenumerate(frr):
            if np.isfinite(value):
                color = "white" if value < 0.8 else "black"
                axis.text(j, i, f"{value:.3f}", ha="center", va="center", size=_SMALL, color=color)
        axis.set_xticks(range(len(by_law)), [label(law) for law in by_law], size=_SMALL, rotation=30, ha="right")
        axis.set_yticks(range(len(order)), [label(str(name)) for name in order], size=_SMALL)
        axis.set_title(label(place, 60), fontsize="x-small")
    figure.suptitle("friction rejection ratio under each law", fontsize="medium")
    (path,) = save_figure(figure, folder / "laws")
    return path
