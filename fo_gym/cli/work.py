"""What the commands that run episodes share: who does the work, and how it ends early."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from fo_gym.console import Stop, check_jobs, errors, progress_bar, say
from fo_gym.evaluation.backends import Backend, BackendError, Name, backend_of
from fo_gym.evaluation.competitor import Competitor
from fo_gym.evaluation.entry import submissions_in

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""

SUBMISSIONS = Path("leaderboard/submissions")
"""Where entries of others are looked for, whatever the folder of the results."""

Jobs = Annotated[int, typer.Option(help="Worker processes; -1 = one per core.")]
Workers = Annotated[Name, typer.Option("--backend", help="joblib: this machine; ray: a Ray cluster, started for it.")]
Address = Annotated[
    str | None, typer.Option(help="A running Ray cluster to use instead; it has its own number of workers.")
]
Submissions = Annotated[
    Path | None,
    typer.Option(help=f"Folder of entries *.toml that take part; {SUBMISSIONS} where there is one."),
]
Traced = Annotated[
    bool,
    typer.Option("--traces", help="Write the worst, median and best episodes tick by tick, thinned, to OUT/traces."),
]
StoreFolder = Annotated[
    Path, typer.Option(file_okay=False, help="Folder in which finished runs are kept, and looked for.")
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Compute everything, whatever the store holds.")]

__all__ = [
    "INTERRUPTED",
    "Address",
    "Fresh",
    "Jobs",
    "StoreFolder",
    "Submissions",
    "Traced",
    "Workers",
    "check_workers",
    "note",
    "submissions_of",
    "working",
]


def note(text: str) -> None:
    """A line on the error stream, as it is."""
    say(text, errors)


def check_workers(jobs: int, backend: Name, address: str | None) -> None:
    """Stop where the options for who does the work do not fit together."""
    check_jobs(jobs)
    if address is not None and backend != "ray":
        raise Stop("--address is that of a Ray cluster; add --backend ray, or leave it out")


@contextmanager
def working(
    backend: Name, jobs: int, address: str | None, runs: int, kept: str = ""
) -> Iterator[tuple[Backend, Callable[[str], None]]]:
    """Workers, and a progress bar to tell about every run; Ctrl-C and lost workers end the command with a word on it.

    Args:
        backend: who does the work.
        jobs: how many of them.
        address: of a running Ray cluster.
        runs: how often the bar will be told.
        kept: what to say of the runs that are finished when it ends early.
    """
    try:
        with backend_of(backend, jobs, address) as workers, progress_bar(runs) as advance:
            yield workers, lambda label: advance(label, 1)
    except BackendError as error:
        raise Stop(f"{error}{kept}") from error
    except KeyboardInterrupt:
        note(f"interrupted{kept}")
        raise typer.Exit(INTERRUPTED) from None


def submissions_of(folder: Path | None) -> tuple[Competitor, ...]:
    """The submissions in a folder; by default in `SUBMISSIONS`, where there is one."""
    if folder is None and not SUBMISSIONS.is_dir():
        return ()
    try:
        return submissions_in(folder or SUBMISSIONS)
    except ValueError as error:
        raise Stop(str(error)) from error
