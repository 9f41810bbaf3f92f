"""Figures of the leaderboard: the ranking with its intervals, and the nominal episodes to look at."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fo_gym.compensators import BUILT_IN
from fo_gym.evaluation.leaderboard import SET, leaderboard
from fo_gym.evaluation.run import Results, Trace

_MM = 1e3
_JOINT = 1
_STYLE: dict[str, dict[str, Any]] = {
    "ideal": {"color": "0.6", "linestyle": "--"},
    "none": {"color": "0.3", "linestyle": ":"},
}

__all__ = ["figures", "ranking_figure", "trace_figure"]


def ranking_figure(episodes: pd.DataFrame) -> Figure:
    """FRR of every competitor with its interval, a panel per environment and variant."""
    table = leaderboard(episodes)
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
        axis.grid(axis="x", alpha=0.3)
        axis.set_xlabel("friction rejection ratio")
    return figure


def _draw_error(axis: Axes, trace: Trace, joint: int) -> None:
    style = _STYLE.get(trace.compensator, {})
    axis.plot(trace.time, _MM * trace.error[:, joint], label=trace.compensator, linewidth=1.1, **style)


def trace_figure(traces: list[Trace]) -> Figure:
    """The nominal episodes of one environment: the tool's path, or a joint's error whole and magnified."""
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    if traces[0].tool is not None:
        _draw_paths(left, right, traces)
    else:
        joint = min(_JOINT, traces[0].error.shape[1] - 1)
        unit = "mm" if traces[0].error.shape[1] == 1 else "mrad"
        for trace in traces:
            _draw_error(left, trace, joint)
            if trace.compensator != "none":
                _draw_error(right, trace, joint)
        for axis in (left, right):
            axis.set_xlabel("time [s]")
            axis.set_ylabel(f"theta - theta_d, joint {joint + 1} [{unit}]")
        settled = [_MM * trace.error[len(trace.time) // 2 :, joint] for trace in traces if trace.compensator != "none"]
        reach = 1.2 * max(float(np.abs(part).max()) for part in settled)
        right.set_ylim(-reach, reach)
        right.set_title("magnified", fontsize="medium")
    left.set_title(f"{traces[0].env}, nominal", fontsize="medium")
    for axis in (left, right):
        axis.grid(alpha=0.3)
    figure.legend(*left.get_legend_handles_labels(), loc="outside right center", fontsize="small")
    return figure


def _draw_paths(left: Axes, right: Axes, traces: list[Trace]) -> None:
    """Left: the tool's path in the y-z plane; right: its distance from the reference over time."""
    for trace in traces:
        assert trace.tool is not None
        assert trace.tool_d is not None
        style = _STYLE.get(trace.compensator, {})
        left.plot(*(_MM * trace.tool[:, 1:].T), label=trace.compensator, linewidth=1.1, **style)
        distance = np.linalg.norm(trace.tool - trace.tool_d, axis=1)
        right.plot(trace.time, _MM * distance, linewidth=1.1, **style)
    left.plot(*(_MM * traces[0].tool_d[:, 1:].T), color="k", linewidth=0.6, label="reference")  # type: ignore[index]
    left.set_aspect("equal")
    left.set_xlabel("y [mm]")
    left.set_ylabel("z [mm]")
    right.set_xlabel("time [s]")
    right.set_ylabel("distance of the tool from its reference [mm]")


def figures(results: Results, folder: Path) -> list[Path]:
    """Draw everything that the results hold into `folder`; returns the files."""
    folder.mkdir(parents=True, exist_ok=True)
    drawn = {"ranking": ranking_figure(results.episodes)}
    for env in dict.fromkeys(trace.env for trace in results.traces):
        drawn[env] = trace_figure([trace for trace in results.traces if trace.env == env])
    paths = []
    # The date would make the same picture a different file every time.
    with mpl.rc_context({"savefig.dpi": 110}):
        for name, figure in drawn.items():
            path = folder / f"{name}.png"
            figure.savefig(path, metadata={"Software": None})
            paths.append(path)
    return paths
