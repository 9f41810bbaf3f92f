"""The ranking as a person reads it: headings and cells, for the terminal and for Markdown alike."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import pandas as pd

from fo_gym.evaluation.competitors.competitor import REFERENCE, SUBMISSION, YOURS, Competitor
from fo_gym.evaluation.results.leaderboard import leaderboard, overall
from fo_gym.evaluation.results.ties import RELEVANT
from fo_gym.evaluation.runs.episodes import OK, SET, label_of, place_of
from fo_gym.evaluation.runs.provenance import is_reference
from fo_gym.specs import BUILT_IN
from fo_gym.text import MESSAGE_LIMIT, NAME_LIMIT, markdown_code, markdown_table, markdown_text, one_line

MARKS = {SUBMISSION: "†", YOURS: "*"}
"""What stands after the names of competitors that are not ours, by their origin."""

# Beside frr: column, heading, and the factor from the column's unit to the heading's.
_SHOWN = (
    ("steady_state_error_ju", "steady-state error [m{unit}]", 1e3),
    ("hunting_ratio", "hunting [%]", 1e2),
    ("limit_cycle_peak_to_peak_ju", "limit cycle [m{unit}]", 1e3),
    ("limit_cycle_period_s", "period [s]", 1.0),
    ("torque_roughness_ratio", "roughness [%]", 1e2),
    ("passivity_violation_ratio", "not passive [%]", 1e2),
    ("tool_rms_error_mm", "tool RMS [mm]", 1.0),
    ("contour_error_mm", "contour RMS [mm]", 1.0),
    ("estimate_lag_ms", "lag [ms]", 1.0),
)

_SCALE = ("none", "ideal")
"""References that make the scale of FRR: 0 and 1."""

__all__ = [
    "MARKS",
    "Ranking",
    "authors",
    "explained",
    "finding",
    "frr_everywhere",
    "markdown",
    "marked",
    "rankings",
    "second_headlines",
    "summary",
]


class Ranking(NamedTuple):
    """A table of plain text, such as one environment and variant, best competitor first, the references last.

    Attributes:
        title: of the table.
        headings: one per column.
        cells: a list per row.
        own: which rows are of competitors that are yours.
    """

    title: str
    headings: list[str]
    cells: list[list[str]]
    own: frozenset[int] = frozenset()


def marked(name: str, origin: str) -> str:
    """The name as tables and figures show it, with the mark of its origin."""
    return " ".join(part for part in (one_line(name, NAME_LIMIT), MARKS.get(origin)) if part)


def explained(rows: pd.DataFrame) -> str:
    """What the marks in tables of these rows mean; "" where there are none."""
    present = rows["origin"].unique()
    return ", ".join(f"{mark} {origin}" for origin, mark in MARKS.items() if origin in present)


def _own(origins: Sequence[str]) -> frozenset[int]:
    return frozenset(place for place, origin in enumerate(origins) if origin == YOURS)


def authors(competitors: Sequence[Competitor]) -> list[str]:
    """Who made the submissions, and where they are described: lines of Markdown."""
    made = [each for each in competitors if each.origin == SUBMISSION]
    return [
        f"* {markdown_text(marked(each.name, each.origin))}: {markdown_text(', '.join(each.authors))}"
        + (f", <{each.link}>" if each.link else "")
        for each in made
    ]


def _number(value: Any, form: str, factor: float = 1.0) -> str:
    return "" if pd.isna(value) else format(value * factor, form)


def _verdict(row: pd.Series[Any]) -> str:
    words = "reference" if row["compensator"] in BUILT_IN or row["origin"] == REFERENCE else row["verdict"]
    note = "" if row["status"] == OK else one_line(f"{row['status']}: {row['error']}", MESSAGE_LIMIT)
    return "; ".join(str(part) for part in (words, note) if part and not pd.isna(part))


def _range(low: Any, high: Any, form: str) -> str:
    return "" if pd.isna(low) else f"{low:{form}} ... {high:{form}}"


def _cells(row: pd.Series[Any], shown: list[tuple[str, str, float]]) -> list[str]:
    scores = [_number(row[column], ".3g", factor) for column, _, factor in shown]
    return [
        _number(row["rank"], ".0f"),
        marked(row["compensator"], row["origin"]),
        _number(row["frr"], ".4f"),
        _number(1.0 - row["frr"], ".3g"),
        _range(1.0 - row["frr_ci_high"], 1.0 - row["frr_ci_low"], ".2g"),
        _range(row["rank_ci_low"], row["rank_ci_high"], ".0f"),
        "" if pd.isna(row["tied_group"]) else row["tied_group"],
        *scores,
        _verdict(row),
    ]


def rankings(episodes: pd.DataFrame, table: pd.DataFrame | None = None) -> Iterator[Ranking]:
    """One ranking per variant over all environments, where there are several, then one per environment and variant.

    Args:
        episodes: rows as `evaluate` gives them.
        table: `leaderboard` of these episodes, where it is at hand already.
    """
    for variant, group in overall(episodes).groupby("variant", sort=False):
        yield _ranking(f"All environments, {variant}", group, [])
    table = leaderboard(episodes) if table is None else table
    for key, group in table.groupby(SET, sort=False):
        yield _ranking(label_of(*key), group, second_headlines(group))


def second_headlines(rows: pd.DataFrame) -> list[tuple[str, str, float]]:
    """What stands beside FRR in a table of one set: column, heading with its unit, and the factor to that unit.

    Args:
        rows: of one set, as `leaderboard` gives them.
    """
    shown = [entry for entry in _SHOWN if rows[entry[0]].notna().any()]
    if any(column.endswith("_mm") for column, _, _ in shown):
        # Where the tool's path is the task, joints may rest anywhere that puts the tool right.
        shown = [entry for entry in shown if not entry[0].endswith("_ju")]
    unit = next((unit for unit in rows["joint_unit"] if unit), "")
    return [(column, heading.format(unit=unit), factor) for column, heading, factor in shown]


def _ranking(title: str, rows: pd.DataFrame, shown: list[tuple[str, str, float]]) -> Ranking:
    """The rows as a ranking, with the columns `shown` (column, heading, factor) beside frr and 1 - frr."""
    ordered = rows.sort_values("rank", kind="stable", na_position="last")
    before = ["rank", "compensator", "FRR", "1-FRR", "95 % interval", "ranks", "group"]
    cells = [_cells(row, shown) for _, row in ordered.iterrows()]
    headings = [*before, *(heading for _, heading, _ in shown), "verdict"]
    return Ranking(title, headings, cells, _own(list(ordered["origin"])))


def finding(table: pd.DataFrame, variant: str) -> str:
    """Who is best in a variant and tied with the best, and who is beaten, in two sentences of Markdown.

    Args:
        table: rows as `leaderboard` gives them, or as read from leaderboard.csv.
        variant: which of its variants.

    Raises:
        ValueError: the table has no such variant.
    """
    rows = table[(table["variant"] == variant) & ~is_reference(table)]
    if not len(rows):
        known = ", ".join(map(str, table["variant"].unique()))
        raise ValueError(f"the table has no variant {variant!r}; it has {known}")
    rows = rows.assign(place=[place_of(env, robot) for env, robot in rows[["env", "robot"]].itertuples(index=False)])
    places = rows["place"].unique()
    leaders = [_leaders(str(place), rows[rows["place"] == place]) for place in places]
    beaten: dict[str, list[str]] = {"everywhere": []}
    for _, group in rows[rows["verdict"] == "behind"].groupby("compensator", sort=False):
        lost = [str(place) for place in group["place"]]
        where = "everywhere" if len(lost) == len(places) > 1 else "on " + _listed(lost)
        beaten.setdefault(where, []).extend(_codes(group.head(1)))
    losers = "; ".join(f"{where}: {', '.join(names)}" for where, names in beaten.items() if names) or "nobody"
    unscored = _codes(rows[rows["frr"].isna()].drop_duplicates("compensator"))
    losers += f"; without a score somewhere: {', '.join(unscored)}" if unscored else ""
    return f"In `{variant}`, {'; '.join(leaders)}. Behind the best, by more than chance and {RELEVANT:g}: {losers}."


def _leaders(place: str, rows: pd.DataFrame) -> str:
    """Who is best somewhere, and with whom."""
    best, tied = (_codes(rows[rows["verdict"] == verdict]) for verdict in ("best", "tied"))
    if not best:
        return f"nobody has a score on {place}"
    return f"{best[0]} is best on {place}, tied with {_listed(tied) if tied else 'nobody'}"


def _codes(rows: pd.DataFrame) -> list[str]:
    """The names of these rows as code in Markdown, with the marks of their origins."""
    return [
        markdown_code(one_line(name, NAME_LIMIT)) + MARKS.get(origin, "")
        for name, origin in zip(rows["compensator"], rows["origin"], strict=True)
    ]


def _listed(words: list[str]) -> str:
    """The words as a person lists them: a, b and c."""
    return " and ".join(part for part in (", ".join(words[:-1]), *words[-1:]) if part)


def frr_everywhere(table: pd.DataFrame) -> pd.DataFrame:
    """FRR of everybody in every set: best on average first, failed ones last, then references.

    Those by whose definition FRR is 0 or 1 are left out.

    Args:
        table: rows as `leaderboard` gives them.

    Returns:
        A row per competitor, by its name, and a column per (env, robot, variant).
    """
    scored = table[~table["compensator"].isin(_SCALE)].assign(reference=is_reference)
    sets = list(table[SET].drop_duplicates().itertuples(index=False, name=None))
    frr = scored.pivot(index="compensator", columns=SET, values="frr")[sets]
    order = scored.drop_duplicates("compensator").set_index("compensator")[["reference"]]
    order["mean"] = frr.mean(axis=1, skipna=False)
    order = order.sort_values(["reference", "mean"], ascending=[True, False], kind="stable", na_position="last")
    return frr.loc[order.index]


def summary(table: pd.DataFrame) -> Ranking:
    """`frr_everywhere` as a table.

    Args:
        table: rows as `leaderboard` gives them.
    """
    frr = frr_everywhere(table)
    who = table.drop_duplicates("compensator").assign(reference=is_reference).set_index("compensator").loc[frr.index]
    headings = ["compensator", *(label_of(*each) for each in frr.columns.to_list())]
    names = [
        marked(str(name), origin) + (" (reference)" if reference else "")
        for name, origin, reference in who[["origin", "reference"]].itertuples(name=None)
    ]
    values = frr.to_numpy()
    cells = [[name, *(_number(value, ".3f") for value in row)] for name, row in zip(names, values, strict=True)]
    return Ranking("Friction rejection ratio", headings, cells, _own(list(who["origin"])))


def markdown(ranking: Ranking) -> str:
    """The ranking as a Markdown table; rows that are yours are bold."""
    rows = [[markdown_text(cell) for cell in row] for row in ranking.cells]
    for place in ranking.own:
        rows[place] = [f"**{cell.strip()}**" if cell.strip() else "" for cell in rows[place]]
    return markdown_table([markdown_text(heading) for heading in ranking.headings], rows)
