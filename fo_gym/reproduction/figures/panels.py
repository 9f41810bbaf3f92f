"""The paper's simulations: six observers on the single link, a step of 10 mm into stiction."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D

from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.figures.style import BLACK, KINDS, LINES, MILLI, NAMES, figure_of, gains_label, kind_of, thin
from fo_gym.reproduction.runs import GAINS, panels
from fo_gym.reproduction.team import Run

TITLE = "Simulations: the single link against stiction"
CAPTION = (
    "A step of 10 mm of the single link with LuGre friction, six observers. Each panel: the motor theta, the nominal "
    "motor theta_n and the motor without friction theta_ideal; their distance from the target theta_d, magnified (at "
    "high gains each panel has its own scale); friction tau_f and its estimate. The PID-type hunts at low gains and "
    "settles on the target at high gains; the PD-type rests off the target, at high gains by little; Le Tien's "
    "observer hunts at both. With Le Tien's observer nothing feeds theta_n back: it is an open integrator that "
    "wanders off, beyond the axes, and is not drawn in the magnified view."
)

# Millimetres around the target in which what oscillates, or where it rests, is seen.
_REACH = {
    "pid-low": 1.5,
    "pd-low": 1.5,
    "letien-low": 1.5,
    "pid-high": 0.15,
    "pd-high": 0.15,
    "letien-high": 1.5,
}
_IDEAL, _THETA, _NOMINAL, _FRICTION, _ESTIMATE = (
    r"$\theta_{ideal}$",
    r"$\theta$",
    r"$\theta_n$",
    r"$\tau_f$",
    r"$\hat\tau_f$",
)
# What is drawn without a colour has the observer's.
_STYLES: dict[str, dict[str, Any]] = {
    _IDEAL: LINES["ideal"],
    _THETA: {"linewidth": 1.2},
    _NOMINAL: {"color": BLACK, "linestyle": (0, (3, 1.5)), "linewidth": 0.9},
    _FRICTION: {"linewidth": 1.8, "alpha": 0.6},
    _ESTIMATE: {"color": BLACK, "linestyle": (0, (1, 1)), "linewidth": 0.9},
}

__all__ = ["CAPTION", "TITLE", "figure"]


def figure(subject: Subject) -> Figure:
    """Six panels of three rows: PID-type, PD-type, Le Tien; low gains above high gains."""
    results = panels(subject)
    drawn = figure_of(9.2)
    axes = drawn.subplots(6, 3, sharex=True)
    for block, level in enumerate(GAINS):
        rows = axes[3 * block : 3 * block + 3]
        for column, kind in enumerate(KINDS):
            name = f"{kind}-{level}"
            rows[0, column].set_title(f"{NAMES[kind]}, {level} gains\n{gains_label(level, kind)}")
            _draw_panel(rows[:, column], results[name], results["ideal"], name)
        for axis, label in zip(rows[:, 0], (r"$\theta$ [mm]", r"$\theta-\theta_d$ [mm]", r"$\tau_f$ [N]"), strict=True):
            axis.set_ylabel(label)
    drawn.align_ylabels(axes[:, 0])
    for axis in axes[-1]:
        axis.set_xlabel("time [s]")
        axis.set_xlim(0.0, 20.0)
    _add_legend(drawn)
    return drawn


def _draw_panel(rows: list[Axes], run: Run, ideal: Run, name: str) -> None:
    """The three rows of one observer."""
    whole, magnified, forces = rows
    kind = kind_of(name)
    color = LINES[kind]["color"]
    target = run.tick("theta_d")
    motors = {_IDEAL: ideal.tick("theta"), _THETA: run.tick("theta"), _NOMINAL: run.tick("theta_n")}
    for label, theta in motors.items():
        style = {"color": color} | _STYLES[label]
        whole.plot(*thin(run.time, MILLI * theta), label=label, **style)
        if (kind, label) != ("letien", _NOMINAL):
            magnified.plot(*thin(run.time, MILLI * (theta - target)), label=label, **style)
    for label, force in ((_FRICTION, run.period("tau_f")), (_ESTIMATE, run.period("tau_f_hat"))):
        forces.plot(*thin(run.time[:-1], force), label=label, **({"color": color} | _STYLES[label]))
    whole.set_ylim(-4.0, 17.0)
    magnified.set_ylim(-_REACH[name], _REACH[name])
    forces.set_ylim(-1.8, 1.8)
    if kind == "letien":
        whole.text(19.5, -3.0, r"$\theta_n$ wanders off: nothing feeds it back", ha="right", fontsize=8.0)


def _add_legend(drawn: Figure) -> None:
    """One legend below; what has the observer's colour is shown in all three."""
    handles: list[Any] = []  # a tuple of artists is an entry of several lines, which the type of `legend` leaves out
    for style in _STYLES.values():
        colors = [style["color"]] if "color" in style else [LINES[kind]["color"] for kind in KINDS]
        handles.append(tuple(Line2D([], [], **(style | {"color": color})) for color in colors))
    drawn.legend(
        handles,
        list(_STYLES),
        loc="outside lower center",
        ncols=len(handles),
        handlelength=4.0,
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.3)},
    )
