"""Ours and theirs: the rows that the protocol names, and apart from them those of the submissions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import pandas as pd

from fo_gym.evaluation.competitor import SUBMISSION, Competitor
from fo_gym.evaluation.tables import Ranking, rankings

__all__ = ["apart", "authors", "is_submission", "ours"]


def is_submission(rows: pd.DataFrame) -> pd.Series[bool]:
    """Which rows are of submissions."""
    return rows["origin"] == SUBMISSION


def ours(rows: pd.DataFrame) -> pd.DataFrame:
    """The rows without those of submissions: what is said of them does not depend on who else takes part."""
    return rows[~is_submission(rows)]


def apart(episodes: pd.DataFrame, table: pd.DataFrame) -> Iterator[Ranking]:
    """The rankings of everybody, with the rows of the submissions alone; none where there are no submissions.

    Args:
        episodes: rows as `evaluate` gives them.
        table: `leaderboard` of these episodes.
    """
    names = set(episodes.loc[is_submission(episodes), "compensator"])
    for ranking in rankings(episodes, table) if names else ():
        place = ranking.headings.index("compensator")
        yield ranking._replace(cells=[row for row in ranking.cells if row[place] in names])


def authors(competitors: Sequence[Competitor]) -> Ranking:
    """Who made the submissions."""
    headings = ["compensator", "authors", "link"]
    made = [each for each in competitors if each.origin == SUBMISSION]
    return Ranking("Submissions", headings, [[each.name, ", ".join(each.authors), each.link] for each in made])
