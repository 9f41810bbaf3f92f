"""The frames of a film: pictures of each competitor, as seen and magnified, and its curve up to the moment."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from fo_gym.envs.camera import Closeup
from fo_gym.envs.rendering import SceneRenderer
from fo_gym.evaluation.results.film.takes import Take, curves_of
from fo_gym.evaluation.results.style import BLUE, GREEN, label, plain_number
from fo_gym.specs import BUILT_IN

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

_WIDTH, _DPI = 8.4, 100
"""Of a frame [in], [1/in]."""
_SHAPE, _TALLEST = 0.66, 2.1
"""Height of a picture over its width, and at most [in]."""
_CURVES = 1.15
"""Height of a row of curves [in]."""
_STILL = 1e-5
"""A picture in which nothing has moved by more than this since it was drawn is not drawn again [m | rad]."""
_LEFT, _RIGHT, _TOP, _BOTTOM, _GAP = 0.55, 0.08, 0.55, 0.42, 0.09
"""Margins, and the gap between columns [in]."""
_LOWEST = 1e-2
"""Least distance on a logarithmic axis [mm]."""

__all__ = ["frames"]


class _Column:
    """What belongs to one competitor: its renderer, two pictures, and its curves."""

    def __init__(self, axes: NDArray[np.object_], take: Take, curve: Array) -> None:
        self.take = take
        self.time, self.curve = take.time, curve
        scene, near, *rows = axes
        box = scene.get_window_extent()
        self.renderer = SceneRenderer(take.simulation, "rgb_array", round(box.height), round(box.width))
        scene.set_title(label(take.name), fontsize=10, fontweight="bold")
        blank = np.zeros((round(box.height), round(box.width), 3), np.uint8)
        self.images = [axis.imshow(blank, aspect="auto", interpolation="nearest") for axis in (scene, near)]
        for axis in (scene, near):
            axis.set(xticks=[], yticks=[])
        self.near = near
        self.drawn = np.empty(0)
        self.lines = [axis.plot([], [], color=BLUE, linewidth=1.3)[0] for axis in rows]

    def points(self) -> Array:
        """Where what is magnified is in each state, and where it should come, (n, 3) [m]."""
        found = []
        for state in self.take.states:
            self.take.simulation.set_state(state)
            found.append(self.renderer.followed(self.take.simulation))
        return np.array(found)

    def draw(self, number: int, seconds: float, closeup: Closeup) -> None:
        """The frame of this number."""
        simulation = self.take.simulation
        simulation.set_state(self.take.states[min(number, len(self.take.states) - 1)])
        self.renderer.watch(simulation)
        pose = np.concatenate([simulation.plant.q[0], simulation.plant.theta[0], simulation.control.theta_d[0]])
        if self.drawn.shape != pose.shape or np.abs(pose - self.drawn).max() > _STILL:
            self.drawn = pose
            for image, view in zip(self.images, (None, closeup), strict=True):
                image.set_data(self.renderer.frame(simulation, 0, view))
        shown = self.time <= seconds + 1e-9
        for line in self.lines:
            line.set_data(self.time[shown], self.curve[shown])


def frames(takes: Sequence[Take], ideal: Take, title: str) -> Iterator[Image]:
    """The frames of a film, (height, width, 3) each, with even sides.

    Args:
        takes: of the same episode, up to four.
        ideal: the same episode without friction.
        title: above all.
    """
    curves, what, logarithmic = curves_of(list(takes), ideal)
    limits = _limits(takes, curves, logarithmic=logarithmic)
    figure, axes = _figure(len(takes), len(limits))
    columns = [
        _Column(axes[:, place], take, curve) for place, (take, curve) in enumerate(zip(takes, curves, strict=True))
    ]
    _dress(axes, limits, what, takes[0].time[-1], logarithmic=logarithmic)
    try:
        closeup = columns[0].renderer.closeup(np.concatenate([column.points() for column in columns]))
        for column in columns:
            column.renderer.clear_trace()
            column.near.set_xlabel(f"magnified {closeup.magnification:.2g} times", fontsize=8, labelpad=2)
        clock = figure.text(0.5, 1.0 - 0.06 / figure.get_figheight(), "", ha="center", va="top", fontsize=9.5)
        canvas: Any = FigureCanvasAgg(figure)
        for number in range(max(len(take.states) for take in takes)):
            for column in columns:
                column.draw(number, number * ideal.frame_dt, closeup)
            clock.set_text(f"{title}   {number * ideal.frame_dt:5.2f} s")
            canvas.draw()
            yield np.asarray(canvas.buffer_rgba())[..., :3].copy()
    finally:
        for column in columns:
            column.renderer.close()


def _limits(takes: Sequence[Take], curves: Sequence[Array], *, logarithmic: bool) -> list[tuple[float, float]]:
    """Of each row of curves: all of it, and what the competitors do in the last half, where that is far less."""
    finite = [curve[np.isfinite(curve)] for curve in curves]
    low, high = min(float(each.min()) for each in finite), max(float(each.max()) for each in finite)
    if logarithmic:
        return [(_LOWEST, 2.0 * high)]
    room = 0.06 * (high - low)
    rows = [(low - room, high + room)]
    late = [each[len(each) // 2 :] for each, take in zip(finite, takes, strict=True) if take.name not in BUILT_IN]
    reach = 1.3 * max((float(np.abs(each).max()) for each in late), default=0.0)
    return [*rows, (-reach, reach)] if 0.0 < 4.0 * reach < high - low else rows


def _figure(columns: int, rows: int) -> tuple[Figure, NDArray[np.object_]]:
    """A figure with a column per competitor: two pictures, and rows of curves; axes by row and column."""
    wide = (_WIDTH - _LEFT - _RIGHT - (columns - 1) * _GAP) / columns
    tall = min(_SHAPE * wide, _TALLEST)
    heights = [*2 * [tall], *rows * [_CURVES]]
    gaps = [0.05, 0.32, *(rows - 1) * [0.1]]
    height = _TOP + sum(heights) + sum(gaps) + _BOTTOM
    height = 2.0 * round(height * _DPI / 2.0) / _DPI
    figure = Figure(figsize=(_WIDTH, height), dpi=_DPI)
    axes = np.empty((len(heights), columns), dtype=object)
    for column in range(columns):
        top = height - _TOP
        for row, (each, gap) in enumerate(zip(heights, [*gaps, 0.0], strict=True)):
            left = _LEFT + column * (wide + _GAP)
            axes[row, column] = figure.add_axes((left / _WIDTH, (top - each) / height, wide / _WIDTH, each / height))
            top -= each + gap
    return figure, axes


def _dress(
    axes: NDArray[np.object_], limits: Sequence[tuple[float, float]], what: str, duration: float, *, logarithmic: bool
) -> None:
    """Limits, ticks and names of the curves' axes."""
    for place, (row, (low, high)) in enumerate(zip(axes[2:], limits, strict=True)):
        for axis in row:
            if logarithmic:
                axis.set_yscale("log")
                axis.yaxis.set_major_formatter(plain_number)
            axis.set(xlim=(0.0, duration), ylim=(low, high))
            axis.grid(alpha=0.3)
            axis.tick_params(labelsize=8, length=2.5, pad=2, labelbottom=place == len(limits) - 1)
            axis.xaxis.set_major_locator(MaxNLocator(4, prune="upper"))
            if not logarithmic:
                axis.axhline(0.0, color=GREEN, linewidth=1.0)
        for axis in row[1:]:
            axis.tick_params(labelleft=False)
    for axis in axes[-1]:
        axis.set_xlabel("time [s]", fontsize=8, labelpad=1)
    middle = 0.5 * (axes[2, 0].get_position().y1 + axes[-1, 0].get_position().y0)
    axes[0, 0].figure.text(0.06 / _WIDTH, middle, what, fontsize=8, rotation=90, va="center", ha="left")
