"""The figure on friction laws: competitors over laws."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from fo_gym.evaluation.results.laws import over_laws
from fo_gym.evaluation.results.style import figure_of, label, save_figure
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.specs import BUILT_IN

_WIDTH, _ROW = 4.2, 0.24

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
    size = (_WIDTH * len(panels), 1.4 + _ROW * rows)
    figure = figure_of(*size)
    for axis, (place, by_law) in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        first = next(iter(by_law.values()))
        order = [name for name in first.sort_values("frr", ascending=False).index if name not in BUILT_IN]
        frr = np.array([part["frr"].reindex(order).to_numpy(dtype=float) for part in by_law.values()]).T
        axis.set_facecolor("0.85")
        axis.imshow(frr, vmin=0.5, vmax=1.0, aspect="auto", cmap="viridis")
        for (i, j), value in np.ndenumerate(frr):
            if np.isfinite(value):
                axis.text(
                    j, i, f"{value:.3f}", ha="center", va="center", size=7, color="white" if value < 0.8 else "black"
                )
        axis.set_xticks(range(len(by_law)), [label(law) for law in by_law], rotation=20)
        axis.set_yticks(range(len(order)), [label(str(name)) for name in order], size=7)
        axis.set_title(label(place, 60), fontsize="small")
    figure.suptitle("friction rejection ratio under each law", fontsize="medium")
    (path,) = save_figure(figure, folder / "laws")
    return path
