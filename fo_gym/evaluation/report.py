"""Write the results: CSV files, a Markdown page and figures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pandas as pd

from fo_gym.evaluation.competitor import SUBMISSION
from fo_gym.evaluation.figures import figures
from fo_gym.evaluation.leaderboard import leaderboard
from fo_gym.evaluation.protocol import Protocol
from fo_gym.evaluation.run import Results
from fo_gym.evaluation.sections import apart, authors, is_submission, ours
from fo_gym.evaluation.tables import markdown, rankings, summary
from fo_gym.files import atomic, csv

__all__ = ["markdown_page", "write_results"]


def markdown_page(protocol: Protocol, results: Results, table: pd.DataFrame, pictures: list[Path]) -> str:
    """The leaderboard as a page: one table per environment and variant, then the submissions and the figures.

    Args:
        protocol: what was run.
        results: what came out.
        table: `leaderboard` of it.
        pictures: the figures.
    """
    episodes = results.episodes
    stamps = [name for name in map(str, episodes) if name.startswith("version_")]
    versions = ", ".join(f"{name.removeprefix('version_')} {episodes[name].iloc[0]}" for name in stamps)
    count = len(protocol.seeds_of("randomized"))
    parts = [
        "# Leaderboard\n",
        "FRR, the friction rejection ratio, is 1 where a compensator makes the joints move as if there were no "
        "friction, 0 where it is useless, below 0 where it does harm. Numbers are interquartile means over the "
        f"episodes ({count} seeds; the nominal variant is one episode, its interval its value), with 95 % bootstrap "
        "intervals. `none` (no compensation) and `ideal` (no friction) are the two references. Verdict: paired "
        'comparison with the best, seed by seed; "tied" where its interval holds zero. '
        "Ranks: the interval of the rank. Group: what shares a letter is not told apart by these episodes.\n",
        "Rest error: over the last second, worst joint. Limit cycle: peak to peak in the task's window with slow creep "
        "removed, worst joint; on the arm the joints are under-damped and still ring in that window, friction or not, "
        "so there it is no proof of hunting. `fo-gym list` explains every metric of leaderboard.csv.\n",
        "The first table is sorted by the mean of its columns.\n",
        f"Protocol `{protocol.stamp}` (name and hash); {versions}.\n",
    ]
    mine = table if not is_submission(table).any() else leaderboard(ours(episodes))
    for ranking in (summary(mine), *rankings(ours(episodes), mine)):
        parts += [f"## {ranking.title}\n", markdown(ranking)]
    parts += _submissions(results, table)
    parts += [f"![{path.stem}](figures/{path.name})\n" for path in pictures]
    return "\n".join(parts)


def _submissions(results: Results, table: pd.DataFrame) -> list[str]:
    """The section of the submissions; nothing where there are none."""
    made = authors(results.competitors)
    if not made.cells:
        return []
    text = (
        "Competitors of others, on the same episodes. Their ranks and verdicts here are among everybody, as in "
        "leaderboard.csv; the tables above are as if they had not taken part.\n"
    )
    parts = [f"## {made.title}\n", text, markdown(made)]
    for ranking in apart(results.episodes, table):
        parts += [f"### {ranking.title}\n", markdown(ranking)]
    return parts


def write_results(protocol: Protocol, results: Results, out: Path) -> list[Path]:
    """Write episodes.csv, leaderboard.csv, timing.csv, leaderboard.md and the figures into `out`.

    The nominal episodes of submissions are not drawn: their number is open, and so would be the lines of a figure.

    Returns:
        What was written.
    """
    out.mkdir(parents=True, exist_ok=True)
    table = leaderboard(results.episodes)
    named = {competitor.name for competitor in results.competitors if competitor.origin == SUBMISSION}
    traces = [trace for trace in results.traces if trace.compensator not in named]
    pictures = figures(replace(results, traces=traces), out / "figures", table)
    texts = {
        "episodes.csv": csv(results.episodes),
        "leaderboard.csv": csv(table),
        "timing.csv": csv(results.timing),
        "leaderboard.md": markdown_page(protocol, results, table, pictures),
    }
    for name, text in texts.items():
        atomic(out / name, text)
    return [*(out / name for name in texts), *pictures]
