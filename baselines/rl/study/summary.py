"""What the study's files say: interquartile means over runs with bootstrap intervals, as a table and as curves."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from baselines.rl.study.plan import ENVIRONMENTS
from fo_gym.evaluation.results.statistics import (
    bootstrap_interval,
    interquartile_mean,
    stratified_interval,
    stratified_mean,
)
from fo_gym.evaluation.results.style import COLOURS, plain_ticks
from fo_gym.files import atomic, csv, draft_of, read_csv

SCORES = {"return": "return", "frr": "FRR"}
ALL = "all"
"""Name of all environments together."""
_UNKNOWN = float("nan"), float("nan")
"""The interval of a single run."""

__all__ = ["ALL", "collect", "curves", "figure", "page", "table", "write_summary"]


def collect(out: Path) -> pd.DataFrame:
    """The rows of all runs that are done.

    Raises:
        ValueError: there are none.
    """
    files = sorted((out / "runs").glob("*.csv"))
    if not files:
        raise ValueError(f"there is no finished run in {out / 'runs'}; run the study first")
    return pd.concat([read_csv(file.read_text(encoding="utf-8")) for file in files], ignore_index=True)


def _row(name: str, values: pd.Series) -> dict[str, float]:
    low, high = bootstrap_interval(values.to_numpy(), np.random.default_rng(0)) if len(values) > 1 else _UNKNOWN
    return {name: interquartile_mean(values.to_numpy()), f"{name}_low": low, f"{name}_high": high}


def curves(rows: pd.DataFrame) -> pd.DataFrame:
    """One row per environment, agent and checkpoint: interquartile mean over runs, 95 % interval, number of runs."""
    lines: list[dict[str, Any]] = []
    for (env, agent, steps), group in rows.groupby(["env", "agent", "steps"]):
        line: dict[str, Any] = {"env": env, "agent": agent, "steps": steps, "runs": len(group)}
        for name in SCORES:
            line |= _row(name, group[name])
        lines.append(line)
    return pd.DataFrame(lines)


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """One row per environment and agent at the end of training, and one per agent for all environments together.

    Returns of different environments do not compare: over all of them there is the FRR alone.
    """
    final = rows[rows["steps"] == rows.groupby(["env", "agent", "run"])["steps"].transform("max")]
    lines = curves(final)
    together: list[dict[str, Any]] = []
    for agent, group in final.groupby("agent"):
        strata = [each["frr"].to_numpy() for _, each in group.groupby("env")]
        several = min(map(len, strata)) > 1
        low, high = stratified_interval(strata, np.random.default_rng(0)) if several else _UNKNOWN
        shared = {"env": ALL, "agent": agent, "steps": group["steps"].max(), "runs": len(group)}
        together.append({**shared, "frr": stratified_mean(strata), "frr_low": low, "frr_high": high})
    return pd.concat([lines, pd.DataFrame(together)], ignore_index=True)


def _cell(line: pd.Series, name: str, digits: int) -> str:
    if np.isnan(line[name]):
        return ""
    if np.isnan(line[f"{name}_low"]):
        return f"{line[name]:.{digits}f}"
    return f"{line[name]:.{digits}f} ({line[f'{name}_low']:.{digits}f} ... {line[f'{name}_high']:.{digits}f})"


def page(lines: pd.DataFrame) -> str:
    """The table as Markdown."""
    text = ["| environment | agent | steps | runs | return | FRR |", "| --- | --- | --- | --- | --- | --- |"]
    for _, line in lines.iterrows():
        cells = [line["env"], line["agent"], f"{line['steps']:.0f}", f"{line['runs']:.0f}"]
        text.append(f"| {' | '.join([*cells, _cell(line, 'return', 1), _cell(line, 'frr', 3)])} |")
    return "\n".join(text) + "\n"


def figure(points: pd.DataFrame) -> Figure:
    """Learning curves: a row for each score, a column for each environment, a line and its interval for each agent."""
    env_ids = [env_id for env_id in ENVIRONMENTS if env_id in set(points["env"])]
    drawing = Figure(figsize=(1.0 + 3.6 * len(env_ids), 5.6), layout="constrained")
    axes = drawing.subplots(len(SCORES), len(env_ids), squeeze=False)
    agents = sorted(set(points["agent"]))
    for row, (name, title) in enumerate(SCORES.items()):
        for axis, env_id in zip(axes[row], env_ids, strict=True):
            for place, agent in enumerate(agents):
                line = points[(points["env"] == env_id) & (points["agent"] == agent)]
                color = COLOURS[place % len(COLOURS)]
                steps = 1e-3 * line["steps"]
                axis.plot(steps, line[name], "o-", color=color, markersize=3, label=agent)
                axis.fill_between(steps, line[f"{name}_low"], line[f"{name}_high"], color=color, alpha=0.2)
            axis.set_ylabel(title)
            axis.set_xlabel("thousands of steps")
            axis.set_xscale("log")  # budgets of on-policy and off-policy algorithms are ten times apart
            plain_ticks(axis.xaxis, 1.0, 2.0, 5.0)
            axis.grid(alpha=0.3)
            if name == "frr":  # what is far below 0 would flatten all that is above
                axis.set_ylim(-1.0, 1.0)
            else:
                axis.set_title(env_id)
    handles, labels = axes[0][0].get_legend_handles_labels()
    drawing.legend(handles, labels, loc="outside lower center", ncols=len(agents), fontsize="small")
    return drawing


def write_summary(out: Path) -> list[Path]:
    """Write curves.csv, table.csv, table.md and curves.png of the runs that are done; returns the files."""
    rows = collect(out)
    points, lines = curves(rows), read_csv(csv(table(rows)))  # whoever reads the file rounds as the page does
    for name, text in (("curves.csv", csv(points)), ("table.csv", csv(lines)), ("table.md", page(lines))):
        atomic(out / name, text)
    with draft_of(out / "curves.png") as draft:
        figure(points).savefig(draft, dpi=110, metadata={"Software": None})
    return [out / name for name in ("curves.csv", "table.csv", "table.md", "curves.png")]
