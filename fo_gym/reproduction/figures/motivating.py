"""The motivating example: what an observer adds while the joint is stuck, and when the joint breaks free."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fo_gym.certificate.cases import FRICTION, JOINT
from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.figures.style import (
    BLACK,
    LINES,
    MILLI,
    NAMES,
    ORANGE,
    PURPLE,
    figure_of,
    gains_label,
    thin,
)
from fo_gym.reproduction.runs import panels
from fo_gym.reproduction.team import Run

Array = NDArray[np.float64]

TITLE = "Motivating example: the estimate grows until friction gives way"
CAPTION = (
    "The single link under the PID-type observer: the first break-away, from rest 10 mm off the target, at low and at"
    " high gains, and a later one at low gains, after a long time in stiction. Above: where the motor is stuck, tau_f"
    " = tau_f_hat + tau_j - tau_c (the gap between the two curves is what accelerates it: something while it creeps "
    "before the first break-away, nothing in a long stop). Since the nominal motor moves on, or the integral grows, "
    "the observer pushes harder and harder, until friction gives way (dot: the largest friction before the motor "
    "passes 2 v_s, dotted line). Where the force rises within hundredths of a second that is well below f_s, which is"
    " reached only where it rises slowly: LuGre breaks away the earlier the faster the force rises. Below: speed of "
    "the motor and of the nominal motor."
)
_SLIPS = 2.0 * float(FRICTION.v_s)
"""Speed from which on the motor has broken free [m/s]."""

_COLOR = LINES["pid"]["color"]


class View(NamedTuple):
    """A break-away to look at.

    Attributes:
        name: of the compensator.
        start: where the view starts, with the motor stuck [s].
        after: how long it goes on after the break-away [s].
        text: what it is.
    """

    name: str
    start: float
    after: float
    text: str


VIEWS = (
    View("pid-low", 0.0, 0.02, "first break-away"),
    View("pid-high", 0.0, 0.02, "first break-away"),
    View("pid-low", 5.0, 0.15, "after a long stop"),
)
"""The columns of the figure."""

__all__ = ["CAPTION", "TITLE", "VIEWS", "View", "break_away", "figure"]


def break_away(run: Run, start: float) -> tuple[int, float]:
    """First tick after `start` [s] at which the motor slips, and the largest |tau_f| since then [N]."""
    first = round(start / run.recording.dt)
    tick = first + int(np.argmax(np.abs(run.tick("theta_dot")[first:]) > _SLIPS))
    return tick, float(np.abs(run.period("tau_f")[first:tick]).max(initial=0.0))


def figure(subject: Subject) -> Figure:
    """A column per break-away: forces above, speeds below."""
    results = panels(subject)
    drawn = figure_of(4.6)
    axes = drawn.subplots(2, len(VIEWS), sharex="col", sharey="row", height_ratios=[2.0, 1.0])
    for (forces, speeds), view in zip(axes.T, VIEWS, strict=True):
        run = results[view.name]
        kind, level = view.name.split("-")
        forces.set_title(f"{NAMES[kind]}, {view.text}\n{gains_label(level, kind)}")
        tick, largest = break_away(run, view.start)
        span = slice(round(view.start / run.recording.dt), tick + round(view.after / run.recording.dt))
        _draw_forces(forces, run, span, largest)
        _draw_speeds(speeds, run, span)
        for axis in (forces, speeds):
            axis.axvline(run.time[tick], color="k", linestyle=":", linewidth=0.9)
        speeds.set_xlim(run.time[span.start], run.time[span.stop])
        speeds.set_xlabel("time [s]")
    axes[0, 0].set_ylabel("force [N]")
    axes[1, 0].set_ylabel("speed [mm/s]")
    axes[0, 0].set_ylim(-0.1, 1.75)
    axes[1, 0].set_ylim(-2.0, 20.0)
    drawn.align_ylabels(axes[:, 0])
    entries = [entry for axis in axes[:, 0] for entry in zip(*axis.get_legend_handles_labels(), strict=True)]
    handles, labels = zip(*entries, strict=True)
    drawn.legend(handles, labels, loc="outside lower center", ncols=len(labels), handlelength=3.0)
    return drawn


def _draw_forces(axis: Axes, run: Run, span: slice, largest: float) -> None:
    """Controller, observer, their sum and friction; f_s and f_c; where friction is largest."""
    time, friction, estimate = run.time[span], -run.period("tau_f")[span], -run.period("tau_f_hat")[span]
    tau_j = float(JOINT.stiffness) * (run.tick("theta") - run.tick("q"))[span]
    control = run.period("tau_m")[span] - estimate - tau_j
    lines = {
        r"$-\tau_f$": (friction, {"color": _COLOR, "linewidth": 2.6, "alpha": 0.6}),
        r"$(\tau_c-\tau_j)-\hat\tau_f$": (control + estimate, {"color": BLACK, "linestyle": "--"}),
        r"$-\hat\tau_f$": (estimate, {"color": PURPLE, "linestyle": "-"}),
        r"$\tau_c-\tau_j$": (control, {"color": ORANGE, "linestyle": "-."}),
    }
    for label, (force, style) in lines.items():
        axis.plot(*thin(time, force), label=label, **style)
    for level, name in ((FRICTION.f_s, "f_s"), (FRICTION.f_c, "f_c")):
        axis.axhline(float(level), color="0.5", linewidth=0.8)
        axis.annotate(
            f"${name}$", (0.02, float(level)), (0, 2), xycoords=("axes fraction", "data"), textcoords="offset points"
        )
    peak = int(np.argmax(friction >= largest))
    axis.plot(time[peak], largest, "o", color=_COLOR, markersize=5)
    axis.annotate(f"{largest:.2f} N", (time[peak], largest), (-8, 14), ha="right", textcoords="offset points")


def _draw_speeds(axis: Axes, run: Run, span: slice) -> None:
    """Speed of the motor and of the nominal motor."""
    axis.plot(*thin(run.time[span], MILLI * run.tick("theta_dot")[span]), color=_COLOR, label=r"$\dot\theta$")
    speed = MILLI * run.tick("theta_n_dot")[span]
    axis.plot(*thin(run.time[span], speed), color=BLACK, linestyle=(0, (3, 1.5)), label=r"$\dot\theta_n$")
