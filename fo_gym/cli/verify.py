"""`fo-gym verify`: compute published rows again."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fo_gym.cli.work import Address, Jobs, Submissions, Workers, check_workers, submissions_of, working
from fo_gym.console import Stop, say

if TYPE_CHECKING:
    from fo_gym.evaluation.verify import Comparison

__all__ = ["run_verify"]


def run_verify(
    folder: Annotated[Path, typer.Argument(metavar="[DIR]", help="Folder with an episodes.csv.")] = Path("leaderboard"),
    sample: Annotated[int, typer.Option(min=1, help="Rows that are drawn; each brings its whole run.")] = 5,
    seed: Annotated[int, typer.Option(min=0, help="Of the draw.")] = 0,
    protocol: Annotated[
        str | None, typer.Option(help="Protocol of the rows, where it is no shipped one and names entries by path.")
    ] = None,
    submissions: Submissions = None,
    jobs: Jobs = -1,
    backend: Workers = "joblib",
    address: Address = None,
) -> None:
    """Compute a random sample of the published rows again with what is installed here, and compare every cell.

    A row is run again together with the other seeds of its competitor, environment and variant, and all are compared.
    Cells must be the same text. Where the versions of the packages, or the competitor's code, weights or gains are not
    those that the row names, it may differ, which is told; otherwise a difference ends with exit code 2.

    Examples:
        fo-gym verify

        fo-gym verify build/mine --sample 20 --seed 7
    """
    from fo_gym.evaluation.verify import contests_of, published, sampled, verify

    check_workers(jobs, backend, address)
    try:
        rows = sampled(published(folder), sample, seed)
        contests = contests_of(rows, submissions_of(submissions), protocol)
    except ValueError as error:
        raise Stop(str(error)) from error
    runs = sum(1 + len(contest.competitors) for contest in contests)
    with working(backend, jobs, address, runs) as (workers, told):
        found = verify(rows, contests, backend=workers, on_run=told)
    _tell(found)


def _tell(found: list[Comparison]) -> None:
    """What came out, row by row where it differs; stops with exit code 2 at a mismatch."""
    from fo_gym.evaluation.verify import MISMATCH, OTHER, SAME

    counts = Counter(comparison.verdict for comparison in found)
    for comparison in found:
        if comparison.verdict == SAME:
            continue
        say(f"{comparison.verdict}: {' '.join(comparison.row)}")
        for text in (*comparison.differences, *comparison.versions):
            say(f"    {text}")
    runs = len({comparison.row[:3] for comparison in found})
    say(f"{len(found)} rows of {runs} runs: " + ", ".join(f"{counts[each]} {each}" for each in (SAME, OTHER, MISMATCH)))
    if counts[MISMATCH]:
        raise Stop(
            f"{counts[MISMATCH]} rows cannot be reproduced, although versions and competitors are those published"
        )
