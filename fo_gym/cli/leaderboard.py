"""`fo-gym leaderboard`: everybody on the same episodes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fo_gym.cli.view import print_rankings
from fo_gym.cli.work import (
    STORE,
    Address,
    Fresh,
    Jobs,
    StoreFolder,
    Submissions,
    Traced,
    Workers,
    check_workers,
    fail_if_failed,
    run_behind_bar,
    store_in,
    submissions_of,
)
from fo_gym.console import Stop, check_folder, tell_written

__all__ = ["run_leaderboard"]


def run_leaderboard(
    protocol: Annotated[str | None, typer.Option(help="TOML file, or the name of a shipped protocol.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="The small protocol: two seeds.")] = False,
    out: Annotated[
        Path | None,
        typer.Option(file_okay=False, help="Folder for the results; build/leaderboard, or build/quick."),
    ] = None,
    submissions: Submissions = None,
    traces: Traced = False,
    jobs: Jobs = -1,
    backend: Workers = "joblib",
    address: Address = None,
    store: StoreFolder = STORE,
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
    from fo_gym.evaluation.runs.protocol import load_protocol
    from fo_gym.specs import check_spec

    if quick and protocol is not None:
        raise Stop("--quick and --protocol exclude each other; give one of them")
    folder = out or Path("build/quick" if quick else "build/leaderboard")
    check_workers(jobs, backend, address)
    check_folder("--out", folder)
    check_folder("--store", store)
    try:
        chosen = load_protocol(("quick" if quick else "full") if protocol is None else protocol)
        theirs = submissions_of(submissions)
        from fo_gym.evaluation.results.report import write_results
        from fo_gym.evaluation.runs.contest import competitors_of, contests_in

        for competitor in competitors_of(chosen):  # submissions are not the user's to mend
            check_spec(competitor.spec)
        contests = contests_in(chosen, theirs, traced=traces)
    except (ValueError, FileNotFoundError) as error:
        raise Stop(str(error)) from error
    results = run_behind_bar(
        contests, chosen.stamp, store_in(store, fresh=fresh), jobs, backend=backend, address=address
    )
    print_rankings(results)
    tell_written(write_results(chosen, results, folder, traced=traces))
    fail_if_failed(results, (competitor.name for competitor in results.competitors))
