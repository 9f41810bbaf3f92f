"""Write the results: CSV files, a Markdown page and figures."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd

from fo_gym.evaluation.episode.trace import write_traces
from fo_gym.evaluation.metrics.hunting import HUNTING
from fo_gym.evaluation.results.figures import figures
from fo_gym.evaluation.results.laws import laws_page
from fo_gym.evaluation.results.laws_figure import laws_figure
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.results.tables import authors, explained, markdown, rankings, summary
from fo_gym.evaluation.results.ties import RELEVANT
from fo_gym.evaluation.runs.cloud import CLOUD
from fo_gym.evaluation.runs.contest import Results
from fo_gym.evaluation.runs.processor import processor, processor_features
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.files import atomic, csv
from fo_gym.text import markdown_text

__all__ = ["markdown_page", "write_results"]


def _explanations(episodes: int) -> list[str]:
    """What the numbers of the page mean, in paragraphs."""
    return [
        "FRR, the friction rejection ratio, is 1 where a compensator makes the joints move as if there were no "
        "friction, 0 where it is useless, below 0 where it does harm; 1 - FRR is what is left of friction's effect. "
        "`none` (no compensation) and `ideal` (nothing disturbs) make its scale. They, `bound` (the true disturbance, "
        "late) and whoever else sees the truth are references, which have no rank. Numbers are "
        f"interquartile means over {episodes} episodes, with 95 % bootstrap intervals; those of the nominal variant "
        f"are one episode and its cloud, the same from starts {1e6 * CLOUD:g} um or urad beside it, so that no chance "
        "of its last digits ranks.\n",
        "Verdict: paired comparison with the best, seed by seed. A row is tied where the interval of the difference "
        f"holds zero, or lies within {RELEVANT:g}, the smallest difference that a robot could show, or where the "
        "difference is not significant once corrected for the number of pairs (Holm). Group: rows that share a letter "
        "are tied by the same rule. Ranks: the interval of the rank.\n",
        "Steady-state error: distance from the target over the last second, worst joint. Hunting: share of the "
        f"episodes in which a joint still moves by more than {1e3 * HUNTING:g} mm or mrad, peak to peak, where it would"
        " have come to rest without friction; limit cycle and period are of these episodes, worst joint. Roughness: "
        "RMS change of the motor torque from one period to the next, of its limit. Not passive: share of the episodes "
        "in which the push got more energy out of the arm than was stored in it. `fo-gym list` explains every metric "
        "of leaderboard.csv; what does not apply is empty.\n",
    ]


def markdown_page(protocol: Protocol, results: Results, table: pd.DataFrame, pictures: list[Path]) -> str:
    """The leaderboard as a page: one table per environment and variant, who submitted, and the figures.

    Args:
        protocol: what was run.
        results: what came out.
        table: `leaderboard` of it.
        pictures: the figures.
    """
    episodes = results.episodes
    stamps = [name for name in map(str, episodes) if name.startswith("version_")]
    versions = ", ".join(f"{name.removeprefix('version_')} {episodes[name].iloc[0]}" for name in stamps)
    parts = [
        "# Leaderboard\n",
        *_explanations(len(protocol.seeds_of("randomized"))),
        "The first table is sorted by the mean of its columns.\n",
        f"Protocol {markdown_text(protocol.stamp)} (name and hash); {versions}.\n",
    ]
    if marks := explained(table):
        parts.append(f"Marks: {markdown_text(marks)}.\n")
    for ranking in (summary(table), *rankings(episodes, table)):
        parts += [f"## {ranking.title}\n", markdown(ranking)]
    if made := authors(results.competitors):
        parts += ["## Submissions\n", "\n".join(made) + "\n"]
    parts += [f"![{markdown_text(path.stem)}](figures/{path.name})\n" for path in pictures]
    return "\n".join(parts)


def write_results(protocol: Protocol, results: Results, out: Path, *, traced: bool = False) -> list[Path]:
    """Write episodes.csv, leaderboard.csv, timing.csv, leaderboard.md, processor.json and the figures into `out`.

    A protocol with friction laws gets laws.md and a figure beside them.

    Args:
        protocol: what was run.
        results: what came out.
        out: the folder.
        traced: whether to write the traces as well, with their index, into the folder "traces".

    Returns:
        What was written; of the traces, the index alone.
    """
    out.mkdir(parents=True, exist_ok=True)
    table = leaderboard(results.episodes)
    pictures = figures(results, out / "figures", table)
    texts = {
        "episodes.csv": csv(results.episodes),
        "leaderboard.csv": csv(table),
        "timing.csv": csv(results.timing),
        "leaderboard.md": markdown_page(protocol, results, table, pictures),
        "processor.json": json.dumps({processor(): dict(processor_features())}, indent=2) + "\n",
    }
    if protocol.laws:
        texts["laws.md"] = laws_page(protocol, table)
        pictures = [*pictures, laws_figure(protocol, table, out / "figures")]
    for name, text in texts.items():
        atomic(out / name, text)
    index = [write_traces(results.traces, results.episodes, out / "traces")] if traced else []
    return [*(out / name for name in texts), *pictures, *index]
