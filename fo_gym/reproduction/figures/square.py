"""The square in task space on the arm: where the tool goes."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.figures.style import BLACK, KINDS, LINES, MILLI, NAMES, figure_of, gains_label, kind_of, thin
from fo_gym.reproduction.runs import GAINS, square
from fo_gym.reproduction.team import Run

Array = NDArray[np.float64]

TITLE = "Square: the tool of the arm"
CAPTION = (
    "The tool x of the 7-joint arm under task-space impedance: a square of 15 cm in 5 s, from the upper right corner, "
    "first to the left, then 3 s at rest; the PD-type has no L_i, Le Tien's observer only L. Above: its path in the "
    "vertical plane, the lower left corner magnified. Middle: its distance from the reference x_d, which the "
    "compliant controller does not follow exactly even without friction. Below: its distance from where it is at the "
    "same time without friction: what friction alone does, to the joint without compensation some 30 mm."
)

_CORNER = ((-192.0, -170.0), (259.0, 285.0))
"""The part of the path that is magnified: y and z [mm]."""

__all__ = ["CAPTION", "TITLE", "figure"]


def figure(subject: Subject) -> Figure:
    """Low gains to the left, high gains to the right; paths above, distances below."""
    results = square(subject)
    drawn = figure_of(8.2)
    axes = drawn.subplots(3, len(GAINS), sharey="row", height_ratios=[3.4, 1.3, 1.3])
    for column, level in enumerate(GAINS):
        path, error, loss = axes[:, column]
        shown = {name: results[name] for name in ("ideal", "none", *(f"{kind}-{level}" for kind in KINDS))}
        path.set_title(f"{level} gains: {gains_label(level)}")
        _draw_paths(path, shown)
        _add_inset(path, shown)
        _draw_distances(error, loss, shown)
        path.set_xlim(-195.0, -12.0)
        path.set_ylim(255.0, 440.0)
        path.set_xlabel(r"$y$ [mm]")
        for axis in (error, loss):
            axis.set_xlabel("time [s]")
    labels = (r"$z$ [mm]", r"$\|x-x_d\|$ [mm]", r"$\|x-x_{ideal}\|$ [mm]")
    for axis, label in zip(axes[:, 0], labels, strict=True):
        axis.set_ylabel(label)
    drawn.align_ylabels(axes[:, 0])
    drawn.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=6, handlelength=3.0)
    return drawn


def _plane(path: Array) -> Array:
    """Y and z of a path, (2, ticks), mm."""
    return np.asarray(MILLI * path[:, 1:].T)


def _draw_paths(axis: Axes, results: dict[str, Run]) -> None:
    """Everybody's path, and the reference."""
    for name, run in results.items():
        kind = kind_of(name)
        axis.plot(*_plane(run.tool()), label=NAMES[kind], **LINES[kind])
    axis.plot(*_plane(results["ideal"].tool("reference")), label="reference", color=BLACK, linewidth=0.5)
    axis.set_aspect("equal")


def _add_inset(axis: Axes, results: dict[str, Run]) -> None:
    """The lower left corner, magnified, in the empty middle of the square."""
    inset = axis.inset_axes((0.32, 0.26, 0.40, 0.48), xlim=_CORNER[0], ylim=_CORNER[1])
    _draw_paths(inset, results)
    inset.tick_params(labelsize=7)
    axis.indicate_inset_zoom(inset, edgecolor="0.3", linewidth=0.6)


def _draw_distances(error: Axes, loss: Axes, results: dict[str, Run]) -> None:
    """Distance of the tool from its reference, and from where it is without friction, over time."""
    ideal = results["ideal"].tool()
    for name, run in results.items():
        style = LINES[kind_of(name)]
        distance = np.linalg.norm(run.tool() - run.tool("reference"), axis=1)
        error.plot(*thin(run.time, MILLI * distance), **style)
        if name != "ideal":
            loss.plot(*thin(run.time, MILLI * np.linalg.norm(run.tool() - ideal, axis=1)), **style)
    for axis in (error, loss):
        axis.set_xlim(run.time[0], run.time[-1])
    error.set_ylim(0.0, 45.0)
    loss.set_ylim(0.0, 8.0)
