"""The report of one competitor in plain words: what it wins, what it loses, and its episodes, worst first."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.runs.episodes import label_of
from fo_gym.evaluation.runs.provenance import is_reference
from fo_gym.page.board import shown_columns
from fo_gym.page.motion import look_at
from fo_gym.text import NAME_LIMIT, one_line

TRACED = 5
"""Episodes of a report that everybody is traced in, at most: the worst ones."""

__all__ = ["TRACED", "EpisodeLine", "Summary", "summarized", "worst_seeds"]


@dataclass(frozen=True)
class EpisodeLine:
    """An episode in words; `span` are the seconds to look at, "" where there is no trace."""

    name: str
    seed: str
    text: str
    span: str


@dataclass(frozen=True)
class Summary:
    """A report in plain words.

    Attributes:
        title, headline: what it is about, and what came out.
        wins, losses: a sentence for each.
        episodes: worst first.
        ranking: key of the ranking.
        shown: whose traces are shown: the best of the others beside it.
    """

    title: str
    headline: str
    wins: tuple[str, ...]
    losses: tuple[str, ...]
    episodes: tuple[EpisodeLine, ...]
    ranking: str
    shown: tuple[str, ...]


def worst_seeds(rows: pd.DataFrame) -> list[int]:
    """The seeds of a competitor's worst episodes by FRR, the worst first; those without a score last."""
    return [int(seed) for seed in rows.sort_values("frr", kind="stable", na_position="last")["seed"]]


def summarized(name: str, episodes: pd.DataFrame, table: pd.DataFrame, traces: Sequence[Trace], key: str) -> Summary:
    """The report of a competitor on one set of episodes.

    Args:
        name: who it is about.
        episodes: rows of everybody, as `evaluate` gives them, of one set.
        table: `leaderboard` of them.
        traces: its own.
        key: of the ranking.
    """
    row = table[table["compensator"] == name].iloc[0]
    rivals = table[~is_reference(table) & (table["compensator"] != name)]
    beaten, tied, ahead = _standing(row, rivals)
    wins = [f"Better than {_listed(beaten)}." for _ in beaten[:1]]
    losses = [f"Behind {_listed(ahead)}." for _ in ahead[:1]]
    if tied:
        wins.append(f"Not to be told from {_listed(tied)}.")
    for won, sentence in _second_headlines(row, rivals):
        (wins if won else losses).append(sentence)
    others = list(rivals.sort_values("rank", kind="stable", na_position="last")["compensator"])
    return Summary(
        title=one_line(f"{name} on {label_of(row['env'], row['robot'], row['variant'])}", 2 * NAME_LIMIT),
        headline=_headline(row, len(rivals) + 1),
        wins=tuple(wins),
        losses=tuple(losses),
        episodes=tuple(_lines(episodes[episodes["compensator"] == name], traces, str(row["joint_unit"]))),
        ranking=key,
        shown=(*map(str, others[:1]), name),
    )


def _headline(row: pd.Series[Any], count: int) -> str:
    if pd.isna(row["frr"]):
        return f"It has no score: {one_line(str(row['error']))}."
    share = f"{100.0 * row['frr']:.3g} %"
    range_ = f", 95 % interval {row['frr_ci_low']:.4g} to {row['frr_ci_high']:.4g}" if row["episodes"] > 1 else ""
    harm = "It does harm: what friction does to the motion grows" if row["frr"] < 0.0 else f"It undoes {share} of that"
    rank = "" if pd.isna(row["rank"]) else f" Rank {row['rank']:.0f} of {count}."
    return (
        f"Friction keeps joints from moving as they should. {harm} (FRR {row['frr']:.4g}{range_}; "
        f"{row['episodes']:.0f} episode{'s' if row['episodes'] > 1 else ''}).{rank}"
    )


def _standing(row: pd.Series[Any], rivals: pd.DataFrame) -> tuple[list[str], list[str], list[str]]:
    """Whom it beats, whom it is tied with, and who beats it."""
    beaten: list[str] = []
    tied: list[str] = []
    ahead: list[str] = []
    for _, other in rivals.iterrows():
        if pd.isna(row["rank"]) or pd.isna(other["rank"]):
            continue
        if _letters(row) & _letters(other):
            tied.append(str(other["compensator"]))
        else:
            (beaten if row["rank"] < other["rank"] else ahead).append(str(other["compensator"]))
    return beaten, tied, ahead


def _letters(row: pd.Series[Any]) -> set[str]:
    """Its tied groups, one by one."""
    return set(re.findall(r"[a-z]\d*", str(row["tied_group"])))


def _second_headlines(row: pd.Series[Any], rivals: pd.DataFrame) -> Iterator[tuple[bool, str]]:
    """Where it is best, and where worst, of all in a second headline; whether that is a win."""
    everybody = pd.concat([rivals, row.to_frame().T])
    for column, heading, factor in shown_columns(everybody):
        values = rivals[column].dropna().astype(float)
        if pd.isna(row[column]) or not len(values) or column not in METRICS:
            continue
        sign = 1.0 if METRICS[column].better == "lower" else -1.0
        mine, best, worst = sign * float(row[column]), (sign * values).min(), (sign * values).max()
        name, _, unit = heading.partition(" [")
        told = f"{factor * row[column]:.3g} {unit.removesuffix(']')}".strip()
        against = f"{factor * sign * (best if mine < best else worst if mine > worst else 0.0):.3g}"
        if mine < best:
            yield True, f"Best of all in {name}: {told}; the next has {against}."
        elif mine > worst:
            yield False, f"Worst of all in {name}: {told}; the next has {against}."


def _lines(rows: pd.DataFrame, traces: Sequence[Trace], unit: str) -> Iterator[EpisodeLine]:
    seen = {trace.seed: look_at(trace) for trace in traces}
    for seed in worst_seeds(rows):
        row, finding = rows[rows["seed"] == seed].iloc[0], seen.get(seed)
        words = [f"FRR {row['frr']:.3f}" if not pd.isna(row["frr"]) else "no score"]
        if row["error"]:
            words.append(one_line(f"{row['status']}: {row['error']}"))
        elif finding is not None:
            words.append(finding.text)
        else:
            words.append(_scored(row, unit))
        span = "" if finding is None else f"{finding.span[0]:g}-{finding.span[1]:g}"
        yield EpisodeLine(f"seed {seed}", str(seed), "; ".join(words), span)


def _scored(row: pd.Series[Any], unit: str) -> str:
    """What the scores say of an episode without a trace."""
    if row["hunting_ratio"] == 1.0:
        return f"still hunts at the end, {1e3 * row['limit_cycle_peak_to_peak_ju']:.2g} m{unit} from peak to peak"
    if not pd.isna(row["contour_error_mm"]):
        return f"contour error {row['contour_error_mm']:.2g} mm (RMS)"
    return f"rests {1e3 * row['steady_state_error_ju']:.2g} m{unit} off the target"


def _listed(words: list[str]) -> str:
    shown = [one_line(word, NAME_LIMIT) for word in words]
    return " and ".join(part for part in (", ".join(shown[:-1]), *shown[-1:]) if part)
