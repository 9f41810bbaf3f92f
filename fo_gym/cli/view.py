"""Tables on the terminal: as wide as it is. What does not fit is left out or put below; the files have everything."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from fo_gym.console import console, say, text_table

if TYPE_CHECKING:
    from fo_gym.evaluation.results.tables import Ranking
    from fo_gym.evaluation.runs.contest import Results

_KEPT = ("rank", "compensator", "FRR", "95 % interval", "verdict")
"""Columns of a ranking that are there at any width; of the others, the last ones go first."""
_LONGEST = 24
"""Cells are folded from here on where there is no room."""

__all__ = ["print_rankings", "print_tables"]


def print_rankings(results: Results) -> None:
    """The rankings of a run."""
    from fo_gym.evaluation.results.leaderboard import leaderboard
    from fo_gym.evaluation.results.tables import explained, rankings, summary

    tables = list(rankings(results.episodes))
    if len(tables) > 1:
        tables.append(summary(leaderboard(results.episodes)))
    print_tables(tables)
    if marks := explained(results.episodes):
        say(marks)


def print_tables(tables: Iterable[Ranking]) -> None:
    """Print rankings, each as one table or, where it is too wide, several."""
    for ranking in tables:
        fitting = _without_extras(ranking, console.width)
        for part in _parts(fitting, console.width):
            console.print(text_table(*part))
        left_out = [heading for heading in ranking.headings if heading not in fitting.headings]
        if left_out:
            say(f"left out, for want of width: {', '.join(left_out)}")


def _widths(ranking: Ranking, *, whole: bool = False) -> list[int]:
    """What the columns need: headings break between words, unless they are to stay whole, long cells anywhere."""
    columns = zip(ranking.headings, *ranking.cells, strict=True)
    return [
        max(
            *(len(word) for word in ([heading] if whole else heading.split())),
            *(min(len(cell), _LONGEST) for cell in cells),
            0,
        )
        for heading, *cells in columns
    ]


def _fits(ranking: Ranking, width: int, *, whole: bool = False) -> bool:
    return sum(_widths(ranking, whole=whole)) + 3 * len(ranking.headings) + 1 <= width


def _columns(ranking: Ranking, places: list[int]) -> Ranking:
    return ranking._replace(
        headings=[ranking.headings[place] for place in places],
        cells=[[row[place] for place in places] for row in ranking.cells],
    )


def _without_extras(ranking: Ranking, width: int) -> Ranking:
    """A ranking without as many of its less important columns as have to go."""
    if "rank" not in ranking.headings:
        return ranking
    while not _fits(ranking, width, whole=True):  # where headings break, names would as well
        extras = [place for place, heading in enumerate(ranking.headings) if heading not in _KEPT]
        if not extras:
            break
        ranking = _columns(ranking, [place for place in range(len(ranking.headings)) if place != extras[-1]])
    return ranking


def _parts(ranking: Ranking, width: int) -> Iterator[Ranking]:
    """A ranking cut between columns, each part beginning with the first one, who it is about."""
    if "rank" in ranking.headings or _fits(ranking, width):
        yield ranking
        return
    places = [0]
    for place in range(1, len(ranking.headings)):
        if len(places) > 1 and not _fits(_columns(ranking, [*places, place]), width):
            yield _columns(ranking, places)
            places = [0]
        places.append(place)
    yield _columns(ranking, places)
