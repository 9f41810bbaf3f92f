"""From results to a page: of a folder that was published, or of a run that has just ended."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.results.published import contests_of, published
from fo_gym.evaluation.runs.backends import Backend
from fo_gym.evaluation.runs.contest import Contest, Results
from fo_gym.evaluation.runs.store import Store
from fo_gym.files import csv, read_csv
from fo_gym.page.board import key_of
from fo_gym.page.maps import FOLDER, TABLE, maps_in
from fo_gym.page.recording import SetKey, everybodys, single_episodes, telling_seeds
from fo_gym.page.site import Content, write_site
from fo_gym.page.statements import statements_in
from fo_gym.page.summary import TRACED, summarized, worst_seeds
from fo_gym.page.who import everybody

_TABLES = ("leaderboard.csv", "episodes.csv", "timing.csv", "paper/claims.csv", "fidelity.csv")

__all__ = ["Plan", "page_of", "plan_of", "report_of", "report_plan"]


@dataclass(frozen=True)
class Plan:
    """A page that is about to be built.

    Attributes:
        contests: whole sets of episodes with everybody in them.
        traced: the episodes that have to be recorded, one each.
    """

    contests: Sequence[Contest]
    traced: Sequence[Contest]

    @property
    def runs(self) -> int:
        """How many runs there are to record."""
        return sum(contest.runs for contest in self.traced)


def plan_of(folder: Path, submissions: Sequence[Competitor] = (), protocol: str | Path | None = None) -> Plan:
    """What a page of published results needs.

    Args:
        folder: with leaderboard.csv and episodes.csv, and what else there is.
        submissions: competitors that are not known by their name.
        protocol: that of the rows; by default the shipped one of their name.

    Raises:
        ValueError: there are no such results, or who made them is not known here.
    """
    rows = published(folder)
    if not (folder / "leaderboard.csv").is_file():
        raise ValueError(
            f"there is no {folder / 'leaderboard.csv'}; write one with `fo-gym leaderboard --out {folder}`"
        )
    contests = contests_of(rows, submissions, protocol)
    seeds = telling_seeds(read_csv((folder / "episodes.csv").read_text(encoding="utf-8")))
    return Plan(contests, single_episodes(contests, seeds))


def page_of(
    plan: Plan,
    folder: Path,
    out: Path,
    *,
    backend: Backend,
    store: Store,
    documentation: str = "",
    on_run: Callable[[str], None] | None = None,
) -> Path:
    """Record what is missing and write the page.

    Args:
        plan: of the page.
        folder: of the published results.
        out: the folder of the page.
        backend: who records.
        store: where recorded runs are kept and looked for.
        documentation: address of the project's documentation, for links into it; "" leaves them out.
        on_run: who is told of every run.

    Returns:
        The page.

    Raises:
        MissingPackageError: a chart library is not at hand.
        ValueError: a map cannot be read, or the folder holds what no page left there.
    """
    maps = maps_in(folder / FOLDER)
    tables = [*_TABLES, *(f"{FOLDER}/{each.name}/{TABLE}" for each in maps)]
    content = Content(
        table=read_csv((folder / "leaderboard.csv").read_text(encoding="utf-8")),
        who=everybody(_once(plan.contests)),
        gains=_gains(plan.contests),
        traces=everybodys(plan.traced, backend, store, on_run),
        statements=list(statements_in(folder)),
        maps=maps,
        files={name: (folder / name).read_bytes() for name in tables if (folder / name).is_file()},
        documentation=documentation,
    )
    return write_site(content, out)


def report_plan(results: Results, contest: Contest) -> Plan:
    """What a report needs: the worst episodes of the first one of a contest that has been run, with everybody in them.

    Args:
        results: what came of the contest.
        contest: one set of episodes, and who met it.
    """
    own = results.episodes[results.episodes["compensator"] == contest.competitors[0].name]
    seeds = {_where(contest): worst_seeds(own)[:TRACED]}
    return Plan([contest], single_episodes([contest], seeds))


def report_of(
    plan: Plan,
    results: Results,
    out: Path,
    *,
    backend: Backend,
    store: Store,
    documentation: str = "",
    on_run: Callable[[str], None] | None = None,
) -> Path:
    """Write the page of one competitor beside others.

    Args:
        plan: of the report.
        results: what came of its contest.
        out, backend, store, documentation, on_run: as for `page_of`, with its errors.

    Returns:
        The page.
    """
    (contest,) = plan.contests
    name = contest.competitors[0].name
    files = {"leaderboard.csv": csv(leaderboard(results.episodes)), "episodes.csv": csv(results.episodes)}
    table = read_csv(files["leaderboard.csv"])
    traces = everybodys(plan.traced, backend, store, on_run)
    own = [trace for trace in traces if trace.compensator == name]
    content = Content(
        table=table,
        who=everybody(contest.competitors),
        gains=_gains([contest]),
        traces=traces,
        summary=summarized(name, results.episodes, table, own, key_of(*_where(contest))),
        files={file: text.encode() for file, text in files.items()},
        documentation=documentation,
    )
    return write_site(content, out)


def _where(contest: Contest) -> SetKey:
    episodes = contest.episodes
    return episodes.env_id, episodes.robot.name, episodes.variant


def _once(contests: Iterable[Contest]) -> list[Competitor]:
    """Everybody, once."""
    return list({each.name: each for contest in contests for each in contest.competitors}.values())


def _gains(contests: Iterable[Contest]) -> dict[tuple[str, str, str, str], str]:
    """The gains of everybody everywhere, as a reader writes them."""
    found = {}
    for contest in contests:
        episodes = contest.episodes
        for each in contest.competitors:
            gains = each.gains_on(episodes.env_id, episodes.variant)
            told = ", ".join(
                f"{key}={value:.4g}" if isinstance(value, float) else f"{key}={value}" for key, value in gains.items()
            )
            found[*_where(contest), each.name] = told
    return found
