"""The regulation experiment on the arm: joint 2 after a step and a push."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.figures.style import KINDS, LINES, MILLI, NAMES, figure_of, gains_label, kind_of, thin
from fo_gym.reproduction.runs import GAINS, regulation
from fo_gym.reproduction.team import Run

TITLE = "Regulation: joint 2 of the arm"
CAPTION = (
    "Error of the second motor of the 7-joint arm under joint PD: a step of -5 degrees on every joint at 3 s, a push "
    "at joint 2 at 13 s; the PD-type has no L_i, Le Tien's observer only L. Above whole, in the middle magnified, "
    "below the end before the push and all that follows (shaded), magnified further. Without compensation the step is "
    "not answered at all. At low gains the PID-type stops off the target, its integral grows until friction gives way, "
    "and it hops across: it oscillates. The PD-type rests off the target, at 2.4 mrad before the push and at 1.7 mrad "
    "on the other side after it (the paper's own arm: 3.6 and 1.9 mrad). At high gains the joint rings nearly as it "
    "does without friction; before the push PID- and PD-type have settled within 0.3 mrad of the target, and after it "
    "they still ring when the experiment ends, as the joint without friction does. Le Tien's observer has not settled "
    "before the push at either gain."
)
_JOINT = 1
_STEP, _PUSH, _END = 3.0, 13.0, 20.0
_REST = (8.0, _END)
"""The time in which the joint comes to rest, and does so again after the push [s]."""

# Range of time [s] and largest error [mrad] of each row.
_ROWS = (((0.0, _END), 250.0), ((0.0, _END), 30.0), (_REST, 7.0))

__all__ = ["CAPTION", "TITLE", "figure"]


def figure(subject: Subject) -> Figure:
    """Low gains to the left, high gains to the right; the whole error above, magnified below."""
    results = regulation(subject)
    drawn = figure_of(6.2)
    axes = drawn.subplots(len(_ROWS), len(GAINS), sharey="row")
    for column, level in enumerate(GAINS):
        axes[0, column].set_title(f"{level} gains: {gains_label(level)}")
        names = ("ideal", "none", *(f"{kind}-{level}" for kind in KINDS))
        for axis, (span, reach) in zip(axes[:, column], _ROWS, strict=True):
            _draw_error(axis, {name: results[name] for name in names})
            axis.set_xlim(span)
            axis.set_ylim(-reach, reach)
            axis.xaxis.set_major_locator(MultipleLocator(5.0 if span[0] == 0.0 else 2.0))
            axis.set_xlabel("time [s]")
        axes[1, column].axvspan(*_REST, color="0.92", zorder=0)
    for axis in axes[:, 0]:
        axis.set_ylabel(r"$\theta_2-\theta_{d,2}$ [mrad]")
    _mark_events(axes[0, 0])
    drawn.align_ylabels(axes[:, 0])
    drawn.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5, handlelength=3.5)
    return drawn


def _draw_error(axis: Axes, results: dict[str, Run]) -> None:
    """Distance of the motor from its target for everybody."""
    for name, run in results.items():
        error = run.tick("theta", _JOINT) - run.tick("theta_d", _JOINT)
        kind = kind_of(name)
        axis.plot(*thin(run.time, MILLI * error), label=NAMES[kind], **LINES[kind])


def _mark_events(axis: Axes) -> None:
    """Say when the step and the push come."""
    for time, text in ((_STEP, "step"), (_PUSH, "push")):
        arrow = {"arrowstyle": "-|>", "linewidth": 0.7, "color": "k"}
        axis.annotate(text, (time, -160.0), (time, -230.0), ha="center", arrowprops=arrow)
