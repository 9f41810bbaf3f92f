"""`fo-gym list | evaluate | leaderboard`: what there is, and who is how good."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

import fo_gym
from fo_gym.cli.work import (
    Address,
    Fresh,
    Jobs,
    StoreFolder,
    Submissions,
    Traced,
    Workers,
    check_workers,
    note,
    submissions_of,
    working,
)
from fo_gym.console import Stop, check_folder, console, say, tell_written, text_table
from fo_gym.evaluation.backends import Name
from fo_gym.evaluation.competitor import Competitor
from fo_gym.evaluation.entry import competitor_of, shipped_entries
from fo_gym.evaluation.evaluate import FAILED
from fo_gym.evaluation.leaderboard import leaderboard
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.protocol import Protocol, load_protocol, shipped_protocols
from fo_gym.evaluation.report import write_results
from fo_gym.evaluation.run import Results, competitors_of, run_protocol
from fo_gym.evaluation.store import Store
from fo_gym.evaluation.tables import explained, rankings, summary
from fo_gym.tasks.task import VARIANTS

BESIDE = ("pid-low", "pid-high", "pd-low", "pd-high", "letien-low", "letien-high")
"""Whom `fo-gym evaluate` runs beside what it is given: the observers of arXiv:1907.00553."""

__all__ = ["BESIDE", "evaluate", "list_everything", "run_leaderboard"]


def _run(
    protocol: Protocol,
    jobs: int,
    *,
    submissions: Sequence[Competitor] = (),
    traced: bool = False,
    backend: Name = "joblib",
    address: str | None = None,
    store: Store | None = None,
) -> Results:
    """Run a protocol behind a progress bar."""
    check_workers(jobs, backend, address)
    try:
        names = competitors_of(protocol, submissions)
    except ValueError as error:
        raise Stop(str(error)) from error
    runs = len(protocol.environments) * len(protocol.variants) * (1 + len(names))
    kept = f"; finished runs are kept in {store.folder}, the same command goes on with them" if store else ""
    with working(backend, jobs, address, runs, kept) as (workers, told):
        results = run_protocol(
            protocol, submissions=submissions, traced=traced, backend=workers, store=store, on_run=told
        )
    if store:
        note(f"{results.stored} of {results.runs} runs were taken from {store.folder}")
    return results


def _print_rankings(results: Results) -> None:
    tables = list(rankings(results.episodes))
    if len(tables) > 1:
        tables.append(summary(leaderboard(results.episodes)))
    for ranking in tables:
        console.print(text_table(*ranking))
    if marks := explained(results.episodes):
        say(marks)


def list_everything() -> None:
    """Show the environments, compensators, metrics and protocols there are.

    Example: fo-gym list
    """
    for env_id in fo_gym.ENVIRONMENTS:
        say(f"environment  {env_id}")
    for name in fo_gym.list_compensators():
        say(f"compensator  {name}")
    for name, metric in METRICS.items():
        say(f"metric       {name} ({metric.unit_text}, {metric.better} is better): {metric.description}")
    for kind, files in (("entry", shipped_entries()), ("protocol", shipped_protocols())):
        for name, path in files.items():
            say(f"{kind:<12} {name}: {path}")


def evaluate(
    compensators: Annotated[
        list[str],
        typer.Argument(
            metavar="COMPENSATOR...", help="Registered name, module:Class, file.py:Class, or entry (*.toml)."
        ),
    ],
    env: Annotated[str, typer.Option(help="Environment id; see `fo-gym list`.")] = "FJRStiction-v0",
    variant: Annotated[str, typer.Option(help=f"{', '.join(VARIANTS)}; nominal is one episode.")] = "nominal",
    seeds: Annotated[int, typer.Option(min=1, help="Episodes, from the validation seeds.")] = 20,
    out: Annotated[
        Path | None, typer.Option(file_okay=False, help="Folder for the CSV files, page and figures.")
    ] = None,
    traces: Traced = False,
    jobs: Jobs = -1,
) -> None:
    """Score compensators beside none, ideal and the paper's observers, on validation seeds.

    Examples:
        fo-gym evaluate my.py:Mine --env FJRStiction-v0

        fo-gym evaluate pid-high --env FJRSquare-v0 --variant randomized --seeds 5 --out build/mine

        fo-gym evaluate leaderboard/submissions/theirs.toml
    """
    if traces and out is None:
        raise Stop("--traces are written beside the results; add --out DIR, or leave --traces out")
    if out is not None:
        check_folder("--out", out)
    try:
        given = [competitor_of(name) for name in compensators]
        for competitor in given:
            competitor.make(env, variant)
        names = {competitor.name for competitor in given}
        others = [name for name in BESIDE if name not in names]
        protocol = Protocol("evaluate", "validation", seeds, (env,), (variant,), (*compensators, *others))
    except (ValueError, TypeError, fo_gym.CompensatorError) as error:
        raise Stop(str(error)) from error
    results = _run(protocol, jobs, traced=traces)
    _print_rankings(results)
    if out is not None:
        tell_written(write_results(protocol, results, out, traced=traces))
    _fail_if_failed(results, names)


def _fail_if_failed(results: Results, compensators: Iterable[str]) -> None:
    """A compensator that the user asked for and that failed makes the command fail, after its row was shown."""
    episodes = results.episodes
    failed = episodes[(episodes["status"] == FAILED) & episodes["compensator"].isin(list(compensators))]
    if len(failed):
        raise Stop(str(failed["error"].iloc[0]))


def run_leaderboard(
    protocol: Annotated[str | None, typer.Option(help="TOML file, or the name of a shipped protocol.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="The small protocol: two seeds.")] = False,
    out: Annotated[
        Path | None,
        typer.Option(file_okay=False, help="Folder for the results; leaderboard, or build/quick with --quick."),
    ] = None,
    submissions: Submissions = None,
    traces: Traced = False,
    jobs: Jobs = -1,
    backend: Workers = "joblib",
    address: Address = None,
    store: StoreFolder = Path("build/store"),
    fresh: Fresh = False,
) -> None:
    """Score every competitor on the same episodes and write leaderboard.csv, episodes.csv, a page and figures.

    What was computed before and has not changed since (code, weights, gains, versions, episodes) is taken from the
    store: an interrupted run goes on, and a new competitor is computed alone. Failed runs are tried again.

    Examples:
        fo-gym leaderboard

        fo-gym leaderboard --quick

        fo-gym leaderboard --protocol my_protocol.toml --out build/mine --jobs 2

        fo-gym leaderboard --backend ray --address 10.0.0.1:6379
    """
    if quick and protocol is not None:
        raise Stop("--quick and --protocol exclude each other; give one of them")
    try:
        chosen = load_protocol(protocol or ("quick" if quick else "full"))
    except ValueError as error:
        raise Stop(str(error)) from error
    folder = out or Path("build/quick" if quick else "leaderboard")
    check_folder("--out", folder)
    check_folder("--store", store)
    results = _run(
        chosen,
        jobs,
        submissions=submissions_of(submissions),
        traced=traces,
        backend=backend,
        address=address,
        store=Store(store, fresh=fresh, notice=note),
    )
    _print_rankings(results)
    tell_written(write_results(chosen, results, folder, traced=traces))
    _fail_if_failed(results, (competitor.name for competitor in results.competitors))
