"""`fo-gym verify`: compute published rows again."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fo_gym.cli.work import Address, Jobs, Submissions, Workers, check_workers, note, submissions_of, working
from fo_gym.console import Stop, say

if TYPE_CHECKING:
    from fo_gym.evaluation.runs.comparison import Comparison
    from fo_gym.evaluation.runs.contest import Contest

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
    On the kind of processor that the row names, cells must be the same text; on another one, every metric must be
    within its tolerance (docs/processors.md), and where it is not, perturbed twins of the episode are run: a row is
    "chaotic" where they differ as much. Where the versions of the packages, or the competitor's code, weights or gains
    are not those that the row names, it may differ, which is told. A mismatch ends with exit code 2.

    Examples:
        fo-gym verify

        fo-gym verify build/mine --sample 20 --seed 7
    """
    from fo_gym.evaluation.results.published import contests_of, features_of, published, sampled
    from fo_gym.evaluation.runs.verify import twin_contests, verify, with_twins

    check_workers(jobs, backend, address)
    try:
        rows = sampled(published(folder), sample, seed)
        contests = contests_of(rows, submissions_of(submissions), protocol)
        features = features_of(folder)
    except ValueError as error:
        raise Stop(str(error)) from error
    for name in rows["processor"].unique():
        _tell_processor(str(name), features.get(str(name)))
    with working(backend, jobs, address, _runs(contests)) as (workers, told):
        found = verify(rows, contests, backend=workers, on_run=told)
    twins = twin_contests(found, contests)
    if twins:
        note("some rows are beyond tolerance; perturbed twins of their episodes show whether these are chaotic")
        with working(backend, jobs, address, sum(map(_runs, twins))) as (workers, told):
            found = with_twins(found, twins, backend=workers, on_run=told)
    _tell(found)


def _runs(contests: Iterable[Contest]) -> int:
    return sum(contest.runs for contest in contests)


def _tell_processor(name: str, published: Mapping[str, str] | None) -> None:
    """On what the rows were computed, what is another here, and how they are compared for that."""
    from fo_gym.evaluation.runs.processor import processor, processor_features

    if name == processor():
        say(f"published on {name}, as here: compared to the byte")
        return
    where = name or "a processor that they do not name"
    say(f"published on {where}, here is {processor()}: compared within the tolerance of each metric")
    for key, here in processor_features().items():
        there = here if published is None else published.get(key, "")
        if there != here:
            say(f"    {key}: {_only(there, here)} published, {_only(here, there)} here")


def _only(one: str, other: str) -> str:
    """The words of one text that the other has not."""
    return " ".join(word for word in one.split() if word not in other.split()) or "-"


def _tell(found: list[Comparison]) -> None:
    """What came out, row by row where it differs too much; stops with exit code 2 at a mismatch."""
    from fo_gym.evaluation.runs.comparison import MISMATCH, SAME, VERDICTS, WITHIN

    counts = Counter(comparison.verdict for comparison in found)
    for comparison in found:
        if comparison.verdict in (SAME, WITHIN):
            continue
        say(f"{comparison.verdict}: {' '.join(comparison.row)}")
        for difference in (*comparison.beyond, *comparison.versions):
            say(f"    {difference}")
    runs = len({comparison.row[:4] for comparison in found})
    say(f"{len(found)} rows of {runs} runs: " + ", ".join(f"{counts[each]} {each}" for each in VERDICTS))
    if counts[MISMATCH]:
        raise Stop(
            f"{counts[MISMATCH]} rows cannot be reproduced, although versions and competitors are those published"
        )
