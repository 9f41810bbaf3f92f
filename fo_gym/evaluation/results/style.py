"""What figures share: colours, names as figures show them, and how they become files."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.ticker import LogLocator, NullFormatter

from fo_gym.files import draft_of
from fo_gym.text import one_line

BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILLION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
"""Colours of Okabe and Ito, told apart by colour-blind readers (without their yellow, which is pale on white)."""
COLOURS = (BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY, BLACK)
"""The same in the order in which curves without a colour of their own take them."""

PAGE = 7.2
"""Width of a figure over a page [in]."""

_LIMIT = 32
_DPI = 150
# No dates and no versions: the same figure is the same file.
_METADATA: dict[str, dict[str, None]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}

__all__ = [
    "BLACK",
    "BLUE",
    "COLOURS",
    "GREEN",
    "ORANGE",
    "PAGE",
    "PURPLE",
    "SKY",
    "VERMILLION",
    "figure_of",
    "label",
    "plain_number",
    "plain_ticks",
    "save_figure",
]


class _Figure(Figure):
    """A figure that notebooks show where it is the value of a cell."""

    def _repr_png_(self) -> bytes:
        content = io.BytesIO()
        self.savefig(content, format="png", dpi=_DPI)
        return content.getvalue()


def figure_of(width: float, height: float) -> Figure:
    """An empty figure of this size [in], laid out so that nothing is cut or covered."""
    return _Figure(figsize=(width, height), layout="constrained")


def plain_number(value: float, _: float) -> str:
    """How an axis names a value at some place: in as few digits as it has."""
    return f"{value:g}"


def plain_ticks(axis: Axis, *steps: float) -> None:
    """Mark a logarithmic axis by plain numbers, at these multiples of powers of ten."""
    axis.set_major_locator(LogLocator(subs=steps))
    axis.set_major_formatter(plain_number)
    axis.set_minor_formatter(NullFormatter())


def label(text: str, limit: int = _LIMIT) -> str:
    """The text as a figure shows it: in one line, "$" for itself, and characters that the font lacks as escapes."""
    font = get_font(findfont(FontProperties()))
    shown = (
        char if font.get_char_index(ord(char)) else char.encode("unicode_escape").decode("ascii")
        for char in one_line(text, limit)
    )
    return "".join(shown).replace("$", r"\$")


def save_figure(figure: Figure, stem: Path, endings: Sequence[str] = ("png",), dpi: float = _DPI) -> list[Path]:
    """Write a figure, whole or not at all; returns the files.

    Args:
        figure: what is written.
        stem: where, without an ending; the folder is made if need be.
        endings: "png", "pdf".
        dpi: dots per inch of what is no line or letter.
    """
    paths = []
    for ending in endings:
        path = stem.with_name(f"{stem.name}.{ending}")
        with draft_of(path) as draft:
            figure.savefig(draft, dpi=dpi, metadata=_METADATA[ending])
        paths.append(path)
    return paths
