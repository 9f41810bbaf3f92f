"""Figures of the leaderboard: the ranking with its intervals, and the nominal episodes to look at."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from fo_gym.compensators import BUILT_IN
from fo_gym.evaluation.leaderboard import SET, leaderboard
from fo_gym.evaluation.run import Results
from fo_gym.evaluation.trace import Trace
from fo_gym.files import draft_of

_MILLI = 1e3
_JOINT = 1
_STYLE: dict[str, dict[str, Any]] = {
    "ideal": {"color": "0.6", "linestyle": "--"},
    "none": {"color": "0.3", "linestyle": ":"},
}

__all__ = ["figures", "ranking_figure", "trace_figure"]


def ranking_figure(table: pd.DataFrame) -> Figure:
    """FRR of every competitor with its interval, a panel per environment and variant.

    Args:
        table: rows as `leaderboard` gives them.
    """
    table = table[~table["compensator"].isin(BUILT_IN)]
    envs, variants = table["env"].unique(), table["variant"].unique()
    figure = Figure(figsize=(3.4 * len(envs), 2.4 * len(variants)), layout="constrained")
    axes = figure.subplots(len(variants), len(envs), squeeze=False)
    for key, group in table.groupby(SET, sort=False):
        row, column = list(variants).index(key[1]), list(envs).index(key[0])
        axis: Axes = axes[row, column]
        worst_first = group.sort_values("frr", na_position="first", kind="stable")
        frr, place = worst_first["frr"], np.arange(len(worst_first))
        spread = np.abs([frr - worst_first["frr_ci_low"], worst_first["frr_ci_high"] - frr])
        axis.errorbar(frr, place, xerr=spread, fmt="o", color="tab:blue", capsize=3)
        axis.set_yticks(place, worst_first["compensator"])
        axis.set_title(f"{key[0]}, {key[1]}", fontsize="medium")
        axis.xaxis.set_major_locator(MaxNLocator(4))
        axis.grid(axis="x", alpha=0.3)
        axis.set_xlabel("friction rejection ratio")
    return figure


def trace_figure(traces: list[Trace]) -> Figure:
    """The nominal episodes of one environment: the tool's path, or a joint's motion."""
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    if traces[0].tool is None:
        _draw_joint(left, right, traces)
    else:
        _draw_paths(left, right, traces)
    left.set_title(f"{traces[0].env}, nominal", fontsize="medium")
    for axis in (left, right):
        axis.grid(alpha=0.3)
    figure.legend(*left.get_legend_handles_labels(), loc="outside right center", fontsize="small")
    return figure


def _draw_joint(left: Axes, right: Axes, traces: list[Trace]) -> None:
    """Left: a joint's distance from its target; right: from where it would be without friction, magnified."""
    joint = min(_JOINT, traces[0].error.shape[1] - 1)
    ideal = next(trace for trace in traces if trace.compensator == "ideal")
    reach = 0.0
    for trace in traces:
        style = _STYLE.get(trace.compensator, {})
        left.plot(trace.time, _MILLI * trace.error[:, joint], label=trace.compensator, linewidth=1.1, **style)
        if trace.compensator not in BUILT_IN:
            lost = _MILLI * (trace.error - ideal.error)[:, joint]
            right.plot(trace.time, lost, linewidth=1.1, color=left.lines[-1].get_color())
            reach = max(reach, 1.3 * float(np.abs(lost[len(lost) // 2 :]).max()))
    if reach > 0.0:
        right.set_ylim(-reach, reach)
    for axis, origin in ((left, "theta_d"), (right, "theta_ideal")):
        axis.set_xlabel("time [s]")
        axis.set_ylabel(f"theta - {origin}, joint {joint + 1} [m{traces[0].joint_unit}]")


def _draw_paths(left: Axes, right: Axes, traces: list[Trace]) -> None:
    """Left: the tool's path in the y-z plane; right: its distance from the reference over time."""
    for trace in traces:
        assert trace.tool is not None
        assert trace.tool_d is not None
        style = _STYLE.get(trace.compensator, {})
        left.plot(*(_MILLI * trace.tool[:, 1:].T), label=trace.compensator, linewidth=1.1, **style)
        distance = np.linalg.norm(trace.tool - trace.tool_d, axis=1)
        right.plot(trace.time, _MILLI * distance, linewidth=1.1, **style)
    left.plot(*(_MILLI * traces[0].tool_d[:, 1:].T), color="k", linewidth=0.6, label="reference")  # type: ignore[index]
    left.set_aspect("equal")
    left.set_xlabel("y [mm]")
    left.set_ylabel("z [mm]")
    right.set_xlabel("time [s]")
    right.set_ylabel("distance of the tool from its reference [mm]")


def figures(results: Results, folder: Path, table: pd.DataFrame | None = None) -> list[Path]:
    """Draw everything that the results hold into `folder`.

    Args:
        results: what was run.
        folder: where the files go.
        table: `leaderboard` of the results' episodes, where it is at hand already.

    Returns:
        The files.
    """
    drawn = {"ranking": ranking_figure(leaderboard(results.episodes) if table is None else table)}
    for env in dict.fromkeys(trace.env for trace in results.traces):
        drawn[env] = trace_figure([trace for trace in results.traces if trace.env == env])
    paths = []
    with mpl.rc_context({"savefig.dpi": 110}):
        for name, figure in drawn.items():
            path = folder / f"{name}.png"
            with draft_of(path) as draft:
                figure.savefig(draft, metadata={"Software": None})
            paths.append(path)
    return paths
