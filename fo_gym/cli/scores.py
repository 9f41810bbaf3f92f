"""`fo-gym list | evaluate | leaderboard`: what there is, and who is how good."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

import fo_gym
from fo_gym.compensators import BUILT_IN
from fo_gym.console import Stop, check_jobs, console, progress_bar, tell_written
from fo_gym.evaluation.evaluate import FAILED
from fo_gym.evaluation.leaderboard import leaderboard
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.protocol import Protocol, load_protocol, shipped_protocols
from fo_gym.evaluation.report import write_results
from fo_gym.evaluation.run import Results, run_protocol
from fo_gym.evaluation.tables import rankings, summary

__all__ = ["evaluate", "list_everything", "run_leaderboard"]


def _run(protocol: Protocol, jobs: int) -> Results:
    """Run a protocol behind a progress bar."""
    check_jobs(jobs)
    names = [name for name in protocol.compensators if name not in BUILT_IN]
    with progress_bar(len(protocol.environments) * len(protocol.variants) * (1 + len(names))) as advance:
        return run_protocol(protocol, jobs=jobs, on_run=lambda label: advance(label, 1))


def _print_rankings(results: Results) -> None:
    tables = list(rankings(results.episodes))
    if len(tables) > 1:
        tables.append(summary(leaderboard(results.episodes)))
    for ranking in tables:
        view = Table(title=ranking.title)
        for heading in ranking.headings:
            words = heading in ("compensator", "verdict")
            view.add_column(escape(heading), justify="left" if words else "right", overflow="fold")
        for row in ranking.cells:
            view.add_row(*map(escape, row))
        console.print(view)


def list_everything() -> None:
    """Show the environments, compensators, metrics and protocols there are.

    Example: fo-gym list
    """
    for env_id in fo_gym.ENVIRONMENTS:
        console.print(f"environment  {env_id}", highlight=False)
    for name in fo_gym.list_compensators():
        console.print(f"compensator  {name}", highlight=False)
    for name, metric in METRICS.items():
        text = f"metric       {name} ({metric.better} is better): {metric.description}"
        console.print(text, highlight=False, markup=False, soft_wrap=True)
    for name, path in shipped_protocols().items():
        console.print(f"protocol     {name}: {path}", highlight=False, soft_wrap=True)


def evaluate(
    compensators: Annotated[
        list[str], typer.Argument(metavar="COMPENSATOR...", help="Registered name, module:Class or file.py:Class.")
    ],
    env: Annotated[str, typer.Option(help="Environment id; see `fo-gym list`.")] = "FJRStiction-v0",
    variant: Annotated[str, typer.Option(help="nominal (one episode) or randomized.")] = "nominal",
    seeds: Annotated[int, typer.Option(min=1, help="Episodes, from the validation seeds.")] = 20,
    out: Annotated[
        Path | None, typer.Option(file_okay=False, help="Folder for the CSV files, page and figures.")
    ] = None,
    jobs: Annotated[int, typer.Option(help="Worker processes; -1 = one per core.")] = -1,
) -> None:
    """Score compensators beside none, ideal and the paper's observers, on validation seeds.

    Examples:
        fo-gym evaluate my.py:Mine --env FJRStiction-v0

        fo-gym evaluate pid-high --env FJRSquare-v0 --variant randomized --seeds 5 --out build/mine
    """
    try:
        for name in compensators:
            fo_gym.make_compensator(name)
        others = [name for name in load_protocol("full").compensators if name not in compensators]
        protocol = Protocol("evaluate", "validation", seeds, (env,), (variant,), (*compensators, *others))
    except (ValueError, TypeError, fo_gym.CompensatorError) as error:
        raise Stop(str(error)) from error
    results = _run(protocol, jobs)
    _print_rankings(results)
    if out is not None:
        tell_written(write_results(protocol, results, out))
    _fail_if_failed(results, compensators)


def _fail_if_failed(results: Results, compensators: list[str]) -> None:
    """A compensator that the user asked for and that failed makes the command fail, after its row was shown."""
    episodes = results.episodes
    failed = episodes[(episodes["status"] == FAILED) & episodes["compensator"].isin(compensators)]
    if len(failed):
        raise Stop(str(failed["error"].iloc[0]))


def run_leaderboard(
    protocol: Annotated[str | None, typer.Option(help="TOML file, or the name of a shipped protocol.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="The small protocol: two seeds.")] = False,
    out: Annotated[
        Path | None,
        typer.Option(file_okay=False, help="Folder for the results; leaderboard, or build/quick with --quick."),
    ] = None,
    jobs: Annotated[int, typer.Option(help="Worker processes; -1 = one per core.")] = -1,
) -> None:
    """Score every competitor on the same episodes and write leaderboard.csv, episodes.csv, a page and figures.

    Examples:
        fo-gym leaderboard

        fo-gym leaderboard --quick

        fo-gym leaderboard --protocol my_protocol.toml --out build/mine --jobs 2
    """
    if quick and protocol is not None:
        raise Stop("--quick and --protocol exclude each other; give one of them")
    try:
        chosen = load_protocol(protocol or ("quick" if quick else "full"))
    except ValueError as error:
        raise Stop(str(error)) from error
    results = _run(chosen, jobs)
    _print_rankings(results)
    tell_written(write_results(chosen, results, out or Path("build/quick" if quick else "leaderboard")))
    _fail_if_failed(results, list(chosen.compensators))
