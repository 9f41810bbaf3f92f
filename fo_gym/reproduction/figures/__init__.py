"""The figures of the reproduction: what they are called, what they show, and how they are written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from matplotlib import style as matplotlib_style
from matplotlib.figure import Figure

from fo_gym.certificate.subject import Subject
from fo_gym.evaluation.results.style import save_figure
from fo_gym.reproduction.figures import convergence, interaction, lugre, motivating, panels, regulation, square
from fo_gym.reproduction.figures.style import RC

__all__ = ["FIGURES", "FigureSpec", "draw"]


@dataclass(frozen=True)
class FigureSpec:
    """A figure of the reproduction.

    Attributes:
        title: what it is.
        caption: what it shows, in our words.
        function: draws it from what is under test.
    """

    title: str
    caption: str
    function: Callable[[Subject], Figure]


FIGURES = {
    "simulation": FigureSpec(panels.TITLE, panels.CAPTION, panels.figure),
    "regulation": FigureSpec(regulation.TITLE, regulation.CAPTION, regulation.figure),
    "square": FigureSpec(square.TITLE, square.CAPTION, square.figure),
    "interaction": FigureSpec(interaction.TITLE, interaction.CAPTION, interaction.figure),
    "motivating": FigureSpec(motivating.TITLE, motivating.CAPTION, motivating.figure),
    "lugre": FigureSpec(lugre.TITLE, lugre.CAPTION, lugre.figure),
    "convergence": FigureSpec(convergence.TITLE, convergence.CAPTION, convergence.figure),
}
"""Every figure by name: the paper's first, then those of the certificate."""


def draw(name: str, subject: Subject, folder: Path) -> list[Path]:
    """Draw one figure into folder/<name>.pdf and .png; returns the files. A reader never sees half a file.

    Args:
        name: of FIGURES.
        subject: what is under test.
        folder: made if need be.
    """
    with matplotlib_style.context(["default", RC]):  # whatever the user's own settings are
        return save_figure(FIGURES[name].function(subject), folder / name, ("pdf", "png"), RC["savefig.dpi"])
