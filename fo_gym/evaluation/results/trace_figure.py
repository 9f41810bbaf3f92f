"""Episodes to look at: the references, the best, and your own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fo_gym.evaluation.competitors.competitor import REFERENCE, YOURS
from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.metrics.hunting import settled
from fo_gym.evaluation.results.style import BLUE, GREEN, ORANGE, PAGE, PURPLE, SKY, VERMILLION, figure_of, label
from fo_gym.evaluation.results.tables import marked
from fo_gym.evaluation.runs.episodes import label_of
from fo_gym.specs import BUILT_IN

_MILLI = 1e3
SHOWN_JOINT = 1
"""The joint whose motion is drawn, or the last of an arm with fewer."""
_HEIGHT = 3.5
_SMALL, _TINY = 7.5, 6.8
"""Sizes of letters in print [pt]."""
_REFERENCES: Mapping[str, dict[str, Any]] = {
    "ideal": {"color": "0.6", "linestyle": "--", "linewidth": 1.4},
    "none": {"color": "0.3", "linestyle": ":", "linewidth": 1.2},
}
_LINES: tuple[dict[str, Any], ...] = (
    {"color": VERMILLION, "linestyle": "-"},
    {"color": BLUE, "linestyle": (0, (5, 1.2))},
    {"color": GREEN, "linestyle": (0, (5, 1.2, 1, 1.2))},
    {"color": PURPLE, "linestyle": "-"},
    {"color": ORANGE, "linestyle": (0, (3, 1))},
    {"color": SKY, "linestyle": (0, (1, 0.8))},
)
"""Of competitors; as many as there are curves beside the references."""
_OWN, _OTHER = {"linewidth": 1.8, "zorder": 3.0}, {"linewidth": 1.0}

__all__ = ["SHOWN_JOINT", "draw_traces", "trace_figure"]

_Curve = tuple[Trace, str, dict[str, Any]]


def trace_figure(traces: Sequence[Trace], origins: Mapping[str, str]) -> Figure:
    """Episodes of one environment: the tool's path, or a joint's motion; see `draw_traces`."""
    figure = figure_of(PAGE, _HEIGHT)
    left, right = figure.subplots(1, 2)
    names = draw_traces(left, right, traces, origins)
    figure.legend(left.lines, names, loc="outside lower center", ncols=4, fontsize=_TINY)
    return figure


def draw_traces(left: Axes, right: Axes, traces: Sequence[Trace], origins: Mapping[str, str]) -> list[str]:
    """Draw one episode of each competitor on axes that are there; returns the names of the lines on the left.

    At most eight curves: the references, what is yours, and the best of the others.

    Args:
        left: gets the tool's path, or a joint's distance from its target.
        right: gets the distance from where tool or joint would be without friction; of a joint, once that rests.
        traces: of the same episode.
        origins: where each competitor comes from, as far as it counts.
    """
    competitors = _competitors(traces, origins)
    curves = _chosen(traces, origins)
    draw = _draw_paths if "tool" in traces[0].signals else _draw_joint
    draw(left, right, curves)
    shown = sum(trace.compensator not in BUILT_IN for trace, _, _ in curves)
    which = f": {shown} of {len(competitors)}, by FRR" if shown < len(competitors) else ""
    first = traces[0]
    left.set_title(f"{label_of(first.env, first.robot, first.variant)}{which}", fontsize=_SMALL + 0.5)
    for axis in (left, right):
        axis.grid(alpha=0.3)
        axis.tick_params(labelsize=_TINY)
        axis.xaxis.label.set_fontsize(_SMALL)
        axis.yaxis.label.set_fontsize(_SMALL)
    return [*(name for _, name, _ in curves), *(["reference"] if "tool" in first.signals else [])]


def _competitors(traces: Sequence[Trace], origins: Mapping[str, str]) -> list[Trace]:
    """Those that are of no reference."""
    return [
        trace
        for trace in traces
        if trace.compensator not in BUILT_IN and origins.get(trace.compensator, "") != REFERENCE
    ]


def _chosen(traces: Sequence[Trace], origins: Mapping[str, str]) -> list[_Curve]:
    """What is drawn, with its name in the legend and its line."""
    competitors = _competitors(traces, origins)
    competitors.sort(key=lambda trace: (origins.get(trace.compensator) != YOURS, -trace.frr))
    curves = [
        (trace, trace.compensator, _REFERENCES[trace.compensator])
        for trace in traces
        if trace.compensator in _REFERENCES
    ]
    for trace, line in zip(competitors, _LINES, strict=False):
        origin = origins.get(trace.compensator, "")
        name = f"{label(marked(trace.compensator, origin))}  {trace.frr:.3f}"
        curves.append((trace, name, line | (_OWN if origin == YOURS else _OTHER)))
    return curves


def _draw_joint(left: Axes, right: Axes, curves: Sequence[_Curve]) -> None:
    """Left: a joint's distance from its target; right: at rest, from where it would be without friction, magnified."""
    joint = min(SHOWN_JOINT, curves[0][0].signals["theta"].shape[1] - 1)
    end, rest = _rest(curves[0][0])
    right.set_xlim(rest, end)  # before the joints rest, errors of the motion would fill the panel from top to bottom
    reach = 0.0
    for trace, _, line in curves:
        time = trace.signals["time"]
        theta, ideal, target = (trace.signals[name][:, joint] for name in ("theta", "theta_ideal", "theta_d"))
        left.plot(time, _MILLI * (theta - target), **line)
        if trace.compensator not in BUILT_IN:
            lost = _MILLI * (theta - ideal)
            right.plot(time, lost, **line)
            reach = max(reach, 1.3 * float(np.abs(lost[time >= 0.5 * (rest + end)]).max()))
    if reach > 0.0:
        right.set_ylim(-reach, reach)
    for axis, origin in ((left, "theta_d"), (right, "theta_ideal")):
        axis.set_xlabel("time [s]")
        axis.set_ylabel(f"theta - {origin}, joint {joint + 1} [m{curves[0][0].joint_unit}]")


def _rest(trace: Trace) -> tuple[float, float]:
    """When an episode ends, and from when on its joints would rest without friction, its last quarter at least."""
    time = trace.signals["time"]
    return float(time[-1]), min(float(time[settled(trace.signals["theta_ideal"])]), 0.75 * float(time[-1]))


def _draw_paths(left: Axes, right: Axes, curves: Sequence[_Curve]) -> None:
    """Left: the tool's path in its plane; right: how far it is from where it would be without friction."""
    reference = curves[0][0].signals["tool_d"]
    plane = np.sort(np.argsort(np.ptp(reference, axis=0), kind="stable")[1:])  # the two directions in which it moves
    for trace, _, line in curves:
        tool, ideal = trace.signals["tool"], trace.signals["tool_ideal"]
        left.plot(*(_MILLI * tool[:, plane].T), **line)
        if trace.compensator != "ideal":
            right.semilogy(trace.signals["time"], _MILLI * np.linalg.norm(tool - ideal, axis=1), **line)
    left.plot(*(_MILLI * reference[:, plane].T), color="k", linewidth=0.6)
    left.set_aspect("equal")
    left.set_xlabel(f"{'xyz'[plane[0]]} [mm]")
    left.set_ylabel(f"{'xyz'[plane[1]]} [mm]")
    right.set_ylim(bottom=1e-3)  # at the start everybody is where the ideal is
    right.set_xlabel("time [s]")
    right.set_ylabel("distance from the friction-free tool [mm]")
