"""What figures share: colours, and names as figures show them."""

from __future__ import annotations

from matplotlib.font_manager import FontProperties, findfont, get_font

from fo_gym.text import one_line

BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILLION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
"""Colours of Okabe and Ito, told apart by colour-blind readers (without their yellow, which is pale on white)."""

_LIMIT = 32

__all__ = ["BLACK", "BLUE", "GREEN", "ORANGE", "PURPLE", "SKY", "VERMILLION", "label"]


def label(text: str, limit: int = _LIMIT) -> str:
    """The text as a figure shows it: in one line, "$" for itself, and characters that the font lacks as escapes."""
    font = get_font(findfont(FontProperties()))
    shown = (
        char if font.get_char_index(ord(char)) else char.encode("unicode_escape").decode("ascii")
        for char in one_line(text, limit)
    )
    return "".join(shown).replace("$", r"\$")
