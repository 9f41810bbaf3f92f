"""How every figure of the reproduction looks: fonts, colours, names, and long traces made short."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fo_gym.reproduction.runs import GAINS

Array = NDArray[np.float64]

MILLI, MICRO = 1e3, 1e6
"""Factors from m and rad to mm and mrad, and to um."""

PAGE = 7.2
"""Width of a figure over both columns of a page [in]."""

RC: dict[str, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "lines.linewidth": 1.1,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.5,
    "figure.constrained_layout.w_pad": 0.07,
    "pdf.fonttype": 42,  # TrueType: what publishers ask for
    "savefig.dpi": 200,
}
"""Settings of Matplotlib that every figure is drawn with, on top of its defaults."""

KINDS = ("pid", "pd", "letien")
"""The observers without their gains, in the paper's order."""

NAMES = {"ideal": "ideal", "none": "none", "pid": "PID-type", "pd": "PD-type", "letien": "Le Tien et al."}

# Colours of Okabe and Ito, told apart by colour-blind readers; the dashes tell them apart in grey.
LINES: dict[str, dict[str, Any]] = {
    "ideal": {"color": "0.65", "linestyle": "-", "linewidth": 2.2, "zorder": 1.8},
    "none": {"color": "0.2", "linestyle": ":"},
    "pid": {"color": "#0072B2", "linestyle": "-"},
    "pd": {"color": "#D55E00", "linestyle": (0, (5, 1.5))},
    "letien": {"color": "#009E73", "linestyle": (0, (5, 1.2, 1, 1.2))},
}
"""Line of each compensator, the same in every figure."""

BLACK, PURPLE, SKY, ORANGE = "#000000", "#CC79A7", "#56B4E9", "#E69F00"
"""Colours for what is no compensator."""

_BINS = 600

__all__ = [
    "BLACK",
    "KINDS",
    "LINES",
    "MICRO",
    "MILLI",
    "NAMES",
    "ORANGE",
    "PAGE",
    "PURPLE",
    "RC",
    "SKY",
    "figure_of",
    "gains_label",
    "kind_of",
    "letter",
    "thin",
]


def figure_of(height: float) -> Figure:
    """An empty figure over both columns of a page, `height` in inches."""
    return Figure(figsize=(PAGE, height), layout="constrained")


def kind_of(name: str) -> str:
    """The observer without its gains: "pid" of "pid-low"; none and ideal as they are."""
    return name.partition("-")[0]


def gains_label(level: str, kind: str = "pid") -> str:
    """The paper's gains at the level "low" or "high", as far as this kind of observer has them."""
    symbols = {"L": ("L", "s^{-1}"), "Lp": ("L_p", "s^{-1}"), "Li": ("L_i", "s^{-2}")}
    count = {"pid": 3, "pd": 2, "letien": 1}[kind]
    texts = []
    for name, value in list(GAINS[level].items())[:count]:
        symbol, unit = symbols[name]
        texts.append(rf"${symbol}={value:g}\,\mathrm{{{unit}}}$")
    return ", ".join(texts)


def letter(axes: Axes, index: int, text: str = "") -> None:
    """Title of a part of a figure: (a), (b), ... and what it shows."""
    axes.set_title(f"({chr(ord('a') + index)}) {text}".rstrip(), loc="left")


def thin(time: Array, values: Array, bins: int = _BINS) -> tuple[Array, Array]:
    """A long trace with few points that draws the same: of each bin the lowest and the highest value, and both ends.

    Args:
        time, values: (n,).
        bins: how many; traces of up to two points per bin stay as they are.
    """
    n = len(values)
    if n <= 2 * bins:
        return time, values
    keep = {0, n - 1}
    for start, end in pairwise(np.linspace(0, n, bins + 1).astype(int).tolist()):
        part = values[start:end]
        keep |= {start + int(part.argmin()), start + int(part.argmax())}
    index = np.array(sorted(keep))
    return time[index], values[index]
