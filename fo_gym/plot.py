"""Figures of results, for notebooks and papers: `fo_gym.plot.episode` and `fo_gym.plot.ranking`.

    low, high = (fo_gym.trace(name, "FJRStiction-v0") for name in ("pid-low", "pid-high"))
    fo_gym.plot.episode(low, high)

    rows = [fo_gym.evaluate(name, "FJRStiction-v0", variant="randomized") for name in ("pid-low", "pid-high")]
    fo_gym.plot.ranking(pd.concat(rows))

Each gives a Matplotlib figure of a page's width, which a notebook shows and `savefig` writes.
"""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fo_gym.checks import shown
from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.results.figures import draw_ranking, ranking_figure
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.results.trace_figure import draw_traces, trace_figure
from fo_gym.evaluation.runs.episodes import SET
from fo_gym.evaluation.runs.provenance import is_reference

__all__ = ["episode", "ranking"]


def episode(*traces: Trace, axes: tuple[Axes, Axes] | None = None) -> Figure:
    """Draw an episode: where the joint or the tool is, and how far from where it would be without friction.

    Args:
        traces: of the same episode, as `fo_gym.trace` gives them; of more than six competitors the best.
        axes: what to draw on, two of a figure of yours; a new figure without.

    Returns:
        The figure.

    Raises:
        ValueError: there is no trace, or one is of another episode.
    """
    kinds = {(each.env, each.robot, each.variant, each.seed) for each in traces}
    if len(kinds) != 1:
        raise ValueError(f"traces are of {shown(sorted(kinds))}; give one or more, all of the same episode")
    if axes is None:
        return trace_figure(traces, {})
    left, right = axes
    names = draw_traces(left, right, traces, {})
    left.legend(left.lines[-len(names) :], names, fontsize="small")
    return _figure_of(left)


def ranking(rows: pd.DataFrame, *, ax: Axes | None = None) -> Figure:
    """Draw 1 - FRR of competitors with intervals, a panel per environment and variant, best on top.

    Args:
        rows: one per episode, as `fo_gym.evaluate` gives them, of one or more competitors (`pd.concat`); or one per
            competitor, as in leaderboard.csv.
        ax: what to draw on, of a figure of yours, where there is one environment and variant; a new figure without.

    Returns:
        The figure.

    Raises:
        ValueError: nobody is ranked, or there are several panels for `ax`.
    """
    table = rows if "frr_ci_low" in rows else leaderboard(rows)
    table = table[~is_reference(table)]
    if table.empty:
        raise ValueError("there is nobody to rank: the rows are of references; add those of a compensator")
    if ax is None:
        return ranking_figure(table)
    panels = len(table[SET].drop_duplicates())
    if panels > 1:
        raise ValueError(f"the rows are of {panels} environments and variants; leave ax out, or give those of one")
    draw_ranking(ax, table)
    return _figure_of(ax)


def _figure_of(axis: Axes) -> Figure:
    figure = axis.get_figure(root=True)
    assert figure is not None
    return figure
