"""`fo-gym page`: the leaderboard as a page to look at."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from fo_gym.cli.work import STORE, Fresh, Jobs, StoreFolder, Submissions, store_in, submissions_of, working
from fo_gym.console import Stop, check_folder, check_jobs, tell_written
from fo_gym.extras import install_command

__all__ = ["building", "run_page"]


@contextmanager
def building() -> Iterator[None]:
    """Stop at what keeps a page from being built, with the remedy."""
    try:
        yield
    except ModuleNotFoundError as error:
        raise Stop(f"{error}; install what pages are made of with: {install_command('page')}") from error
    except (ValueError, OSError) as error:
        raise Stop(str(error)) from error


def run_page(
    from_: Annotated[
        Path, typer.Option("--from", file_okay=False, help="Folder of published results, with leaderboard.csv.")
    ] = Path("leaderboard"),
    out: Annotated[
        Path | None, typer.Option(file_okay=False, help="Folder of the page; by default FROM/site.", show_default=False)
    ] = None,
    protocol: Annotated[
        str | None, typer.Option(help="That of the results; by default the shipped one of their name.")
    ] = None,
    documentation: Annotated[
        str | None,
        typer.Option(
            help="Address of the documentation, for links, such as docs where it lies beside the page; by default the "
            "project's own, where the installed package names one.",
            show_default=False,
        ),
    ] = None,
    submissions: Submissions = None,
    jobs: Jobs = -1,
    store: StoreFolder = STORE,
    fresh: Fresh = False,
) -> None:
    """Build the page of the leaderboard: rankings, traces, trade-offs, claims, as one folder that needs no network.

    Everybody is recorded in one episode of each environment and variant, for the traces: minutes the first time, at
    once from the store after that. Maps are shown where `fo-gym map --out FROM/maps/NAME` wrote some. Open
    OUT/index.html.

    Examples:
        fo-gym page

        fo-gym page --from build/leaderboard --out build/site
    """
    check_jobs(jobs)
    folder = from_ / "site" if out is None else out
    check_folder("--out", folder)
    check_folder("--store", store)
    with building():
        from fo_gym.page.build import page_of, plan_of
        from fo_gym.page.documentation import documentation as known

        plan = plan_of(from_, submissions_of(submissions), protocol)
        with working("joblib", jobs, None, plan.runs, f"; finished runs are kept in {store}") as (workers, told):
            page = page_of(
                plan,
                from_,
                folder,
                backend=workers,
                store=store_in(store, fresh=fresh),
                documentation=known() if documentation is None else documentation.rstrip("/"),
                on_run=told,
            )
        tell_written([page])
