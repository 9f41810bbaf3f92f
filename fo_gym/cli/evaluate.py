"""`fo-gym evaluate`: your compensator beside others."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fo_gym.cli.gains import gains_of
from fo_gym.cli.page import building
from fo_gym.cli.view import print_rankings
from fo_gym.cli.work import (
    STORE,
    Fresh,
    Jobs,
    LawOption,
    RobotOption,
    StoreFolder,
    Traced,
    fail_if_failed,
    laws_of,
    note,
    robots_of,
    run_behind_bar,
    store_in,
    working,
)
from fo_gym.console import Stop, check_folder, check_jobs, tell_written

if TYPE_CHECKING:
    from fo_gym.evaluation.competitors.competitor import Competitor, Gains
    from fo_gym.evaluation.runs.contest import Contest, Results
    from fo_gym.evaluation.runs.protocol import Protocol
    from fo_gym.evaluation.runs.store import Store

BESIDE = "pid-low,pid-high,pd-low,pd-high,letien-low,letien-high"
"""Whom `fo-gym evaluate` runs beside what it is given: the observers of arXiv:1907.00553."""

__all__ = ["BESIDE", "run_evaluate"]


def run_evaluate(
    compensators: Annotated[
        list[str],
        typer.Argument(
            metavar="COMPENSATOR...", help="Registered name, module:Class, file.py:Class, or entry (*.toml)."
        ),
    ],
    env: Annotated[str, typer.Option(help="Environment id; see `fo-gym list`.")] = "FJRStiction-v0",
    robot: RobotOption = None,
    law: LawOption = None,
    variant: Annotated[str, typer.Option(help="nominal, randomized or hardware.")] = "nominal",
    seeds: Annotated[
        int | None, typer.Option(min=1, help="Episodes, from the validation seeds; by default 20, of nominal 1.")
    ] = None,
    gains: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Keyword argument of the class, repeatable; values as in TOML."),
    ] = None,
    name: Annotated[str | None, typer.Option(help="What the tables call it; by default what you named.")] = None,
    baselines: Annotated[
        str,
        typer.Option(
            metavar="NAME,...",
            help="Whom to run beside it. The references none and ideal run always: --baselines none leaves them alone.",
        ),
    ] = BESIDE,
    out: Annotated[
        Path | None, typer.Option(file_okay=False, help="Folder for the CSV files, page and figures.")
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(file_okay=False, help="Folder for a page about your compensator: what it wins and loses, traces."),
    ] = None,
    traces: Traced = False,
    jobs: Jobs = -1,
    store: StoreFolder = STORE,
    fresh: Fresh = False,
) -> None:
    """Score compensators beside none, ideal and the paper's observers, on validation seeds.

    What you name first runs for a moment, so that an error in it shows at once. Finished runs are kept in the store:
    the same command again only shows them.

    Examples:
        fo-gym evaluate mine.py:Mine --env FJRStiction-v0

        fo-gym evaluate mine.py:Mine --gains level=0.8 --name mine-0.8 --baselines pid-high,letien-high

        fo-gym evaluate pid-high --gains L=70 --gains Lp=14 --gains Li=49 --variant randomized --seeds 5

        fo-gym evaluate pid-high --env FJRSquare-v0 --baselines none --out build/mine

        fo-gym evaluate mine.py:Mine --variant randomized --report build/report

        fo-gym evaluate pid-high --env FJRRegulation-v0 --robot arm.urdf

        fo-gym evaluate pid-low --law MaxwellSlip

        fo-gym evaluate leaderboard/submissions/theirs.toml
    """
    from fo_gym.envs.registry import environment_of
    from fo_gym.evaluation.runs.protocol import Protocol
    from fo_gym.evaluation.runs.seeds import usual_count

    check_jobs(jobs)
    if traces and out is None:
        raise Stop("--traces are written beside the results; add --out DIR, or leave --traces out")
    for option, folder in (("--out", out), ("--report", report), ("--store", store)):
        if folder is not None:
            check_folder(option, folder)
    if report is not None:
        _check_report(compensators)
    try:
        env = environment_of(env).id  # known from here on: entries may have gains for it
        given, others = _competitors(compensators, gains_of(gains or ()), name, baselines)
        names = tuple(competitor.name for competitor in (*given, *others))
        count = usual_count([variant]) if seeds is None else seeds
        robots, laws = robots_of(robot), laws_of(law)
        protocol = Protocol("evaluate", "validation", count, (env,), (variant,), names, robots, laws)
    except (ValueError, OSError) as error:
        raise Stop(str(error)) from error
    if out is not None or report is not None:
        _check_ranking(names)
    for competitor in (*given, *others):
        with _telling(), competitor.playing(env, variant):
            pass  # what cannot be made says so before anything runs
    kept = store_in(store, fresh=fresh)
    contest = _contest((*given, *others), protocol, kept, traced=traces)
    results = run_behind_bar([contest], protocol.stamp, kept, jobs)
    print_rankings(results)
    if out is not None:
        from fo_gym.evaluation.results.report import write_results

        tell_written(write_results(protocol, results, out, traced=traces))
    if report is not None:
        _write_report(results, contest, report, store_in(store, fresh=False), jobs)
    fail_if_failed(results, (competitor.name for competitor in given))


def _competitors(
    compensators: Sequence[str], gains: Gains, name: str | None, baselines: str
) -> tuple[list[Competitor], list[Competitor]]:
    """Who is handed over, and whom they stand beside. Stops at options that do not fit together; raises ValueError."""
    from fo_gym.evaluation.competitors.entry import check_names, competitor_of, handed_over
    from fo_gym.specs import BUILT_IN

    if len(compensators) > 1 and (gains or name):
        raise Stop(f"--gains and --name are for one compensator; {len(compensators)} were given")
    beside = [part.strip() for part in baselines.split(",")]
    if not all(beside) or len(set(beside)) < len(beside):
        raise Stop(f"--baselines is {baselines!r}; give names with commas between, each once, or none")
    done = {*BUILT_IN, *(compensators if not gains and name is None else ())}
    given = [handed_over(text, gains, name) for text in compensators]
    others = [competitor_of(text) for text in beside if text not in done]
    check_names((*given, *others))
    return given, others


def _check_ranking(names: Sequence[str]) -> None:
    """Stop where files are asked for that nobody would stand in."""
    from fo_gym.specs import BUILT_IN

    if all(name in BUILT_IN for name in names):
        raise Stop(
            f"--out is for a ranking, but {', '.join(names)} are references; name a compensator, or leave it out"
        )


def _contest(everybody: Sequence[Competitor], protocol: Protocol, store: Store, *, traced: bool) -> Contest:
    """Everybody on the episodes of the protocol; who is not in the store yet meets the first moments before."""
    from fo_gym.evaluation.runs.contest import Contest, episodes_in
    from fo_gym.evaluation.runs.meeting import meet
    from fo_gym.specs import BUILT_IN

    try:
        (episodes,) = episodes_in(protocol, traced=traced)
    except (ValueError, OSError) as error:
        raise Stop(str(error)) from error
    for competitor in everybody:
        if store.load(episodes, competitor) is None:
            with _telling():
                meet(competitor, episodes)
    return Contest(episodes, tuple(competitor for competitor in everybody if competitor.name not in BUILT_IN))


def _check_report(compensators: Sequence[str]) -> None:
    """Stop where a report cannot be written, before anything runs."""
    if len(compensators) > 1:
        raise Stop(f"--report is about one compensator; {len(compensators)} were given")
    with building():
        import fo_gym.page.build  # noqa: F401
        from fo_gym.page.vendor import uplot

        uplot()


def _write_report(results: Results, contest: Contest, folder: Path, store: Store, jobs: int) -> None:
    """The page about the first competitor, whose worst episodes are recorded with everybody in them."""
    from fo_gym.page.build import report_of, report_plan
    from fo_gym.page.documentation import documentation

    with building():
        plan = report_plan(results, contest)
        with working("joblib", jobs, None, plan.runs, f"; finished runs are kept in {store.folder}") as (workers, told):
            page = report_of(
                plan, results, folder, backend=workers, store=store, documentation=documentation(), on_run=told
            )
        tell_written([page])


@contextmanager
def _telling() -> Iterator[None]:
    """Stop at what a competitor raises, with the lines of the user's code that took part."""
    from fo_gym.compensators import CompensatorError
    from fo_gym.evaluation.episode.faults import trace_of

    try:
        yield
    except (ValueError, TypeError, CompensatorError) as error:
        if told := trace_of(error):
            note(told)
        raise Stop(str(error)) from error
