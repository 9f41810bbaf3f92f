"""Interaction on the arm: what the hand feels, and where the tool goes."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.figures.style import BLACK, KINDS, LINES, MILLI, NAMES, figure_of, gains_label, kind_of, thin
from fo_gym.reproduction.runs import GAINS, interaction
from fo_gym.reproduction.team import Run
from fo_gym.tasks.hand import Hand

Array = NDArray[np.float64]

TITLE = "Interaction: a hand guides the tool"
CAPTION = (
    "A hand, a spring and a damper, grips the tool of the 7-joint arm at 1 s, guides it sideways, back and there again "
    "by 15 cm at 0.1 m/s, and lets it go at 7.5 s; the arm holds its tool at home under a soft task-space impedance. "
    "The PD-type has no L_i, Le Tien's observer only L. Above: the force of the hand along its strokes, over the way "
    "of the tool: the slope is the stiffness of the controller, the width of the loop is twice the force that turns "
    "with the direction of motion, which without friction is the controller's damping alone. Below: the way of the "
    "tool over time, and that of the hand's own point: without compensation the tool lags behind, and sticks short of "
    "its target when it is let go."
)

__all__ = ["CAPTION", "TITLE", "figure"]


def figure(subject: Subject) -> Figure:
    """Low gains to the left, high gains to the right; loops above, ways below."""
    results = interaction(subject)
    drawn = figure_of(5.6)
    axes = drawn.subplots(2, len(GAINS), sharey="row", height_ratios=[1.5, 1.0])
    for column, level in enumerate(GAINS):
        loop, way = axes[:, column]
        loop.set_title(f"{level} gains: {gains_label(level)}")
        shown = {name: results[name] for name in ("ideal", "none", *(f"{kind}-{level}" for kind in KINDS))}
        for name, run in shown.items():
            _draw(loop, way, run, kind_of(name))
        hand, time = _hand(results["ideal"]), results["ideal"].time
        held = (time >= hand.grip) & (time <= hand.let_go)
        way.plot(time[held], MILLI * hand.at(time[held])[0], label="hand", color=BLACK, linewidth=0.5)
        loop.set_xlabel("way of the tool [mm]")
        way.set_xlabel("time [s]")
        way.set_xlim(time[0], time[-1])
    axes[0, 0].set_ylabel("force of the hand [N]")
    axes[1, 0].set_ylabel("way [mm]")
    drawn.align_ylabels(axes[:, 0])
    drawn.legend(*axes[1, 0].get_legend_handles_labels(), loc="outside lower center", ncols=6, handlelength=3.0)
    return drawn


def _hand(run: Run) -> Hand:
    hand = run.recording.scenarios[run.row].hand
    assert hand is not None
    return hand


def _draw(loop: Axes, way: Axes, run: Run, kind: str) -> None:
    """Force over way while the hand holds on, and way over time."""
    hand, style = _hand(run), LINES[kind]
    along = np.array(hand.direction)
    place = (run.tool() - run.tool("reference")) @ along
    force = run.recording.periods["f_hand"][:, run.row] @ along
    held = slice(round(hand.grip / run.recording.dt), round(hand.let_go / run.recording.dt))
    loop.plot(MILLI * place[held][::10], force[held][::10], label=NAMES[kind], **style)
    way.plot(*thin(run.time, MILLI * place), label=NAMES[kind], **style)
