"""What the commands that run episodes share: their options, who does the work, and how it ends early."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from fo_gym.console import Stop, check_jobs, errors, progress_bar, say

if TYPE_CHECKING:
    from fo_gym.evaluation.competitors.competitor import Competitor
    from fo_gym.evaluation.runs.backends import Backend, Name
    from fo_gym.evaluation.runs.contest import Contest, Results
    from fo_gym.evaluation.runs.store import Store

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""

SUBMISSIONS = Path("leaderboard/submissions")
"""Where entries of others are looked for, whatever the folder of the results."""

Jobs = Annotated[int, typer.Option(help="Worker processes; -1 = one per core.")]
Workers = Annotated[
    Literal["joblib", "ray"],
    typer.Option("--backend", help="joblib: this machine; ray: a Ray cluster, started for it."),
]
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
LawOption = Annotated[
    str | None,
    typer.Option(
        "--law",
        help="Friction law, like the robot's own friction: LuGre, ElastoPlastic, MaxwellSlip, Dahl, file.py:Class.",
    ),
]
RobotOption = Annotated[
    str | None,
    typer.Option(
        "--robot",
        metavar="ROBOT",
        help="Another robot for the environments of arms: robot.toml, MJCF (.xml), URDF (.urdf), or a shipped name.",
    ),
]
STORE = Path("build/store")
Fresh = Annotated[bool, typer.Option("--fresh", help="Compute everything, whatever the store holds.")]

__all__ = [
    "INTERRUPTED",
    "STORE",
    "Address",
    "Fresh",
    "Jobs",
    "LawOption",
    "RobotOption",
    "StoreFolder",
    "Submissions",
    "Traced",
    "Workers",
    "check_workers",
    "fail_if_failed",
    "laws_of",
    "note",
    "robots_of",
    "run_behind_bar",
    "store_in",
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
    from fo_gym.evaluation.runs.backends import BackendError, backend_of

    try:
        with backend_of(backend, jobs, address) as workers, progress_bar(runs) as advance:
            yield workers, lambda label: advance(label, 1)
    except BackendError as error:
        raise Stop(f"{error}{kept}") from error
    except KeyboardInterrupt:
        note(f"interrupted{kept}")
        raise typer.Exit(INTERRUPTED) from None


def robots_of(robot: str | None) -> dict[str, str]:
    """The robots of a protocol that run on the one that --robot names, by its name.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: there is no such shipped robot, or the file makes none.
    """
    if robot is None:
        return {}
    from fo_gym.robots import robot_of  # which takes a while to import

    return {robot_of(robot).name: robot}


def laws_of(law: str | None) -> tuple[str, ...]:
    """The laws of a protocol that runs under the one that --law names."""
    return () if law is None else (law,)


def store_in(folder: Path, *, fresh: bool) -> Store:
    """The store of the options --store and --fresh."""
    from fo_gym.evaluation.runs.store import Store

    return Store(folder, fresh=fresh, notice=note)


def run_behind_bar(
    contests: Sequence[Contest],
    stamp: str,
    store: Store,
    jobs: int,
    *,
    backend: Name = "joblib",
    address: str | None = None,
) -> Results:
    """Run contests behind a progress bar, with a store: what was taken from there is told."""
    from fo_gym.evaluation.runs.run import run_contests

    runs = sum(contest.runs for contest in contests)
    kept = f"; finished runs are kept in {store.folder}, the same command goes on with them"
    with working(backend, jobs, address, runs, kept) as (workers, told):
        results = run_contests(contests, stamp, backend=workers, store=store, on_run=told)
    note(f"{results.stored} of {results.runs} runs were taken from {store.folder}")
    return results


def fail_if_failed(results: Results, compensators: Iterable[str]) -> None:
    """A compensator that the user asked for and that failed makes the command fail, after its row was shown."""
    from fo_gym.evaluation.runs.episodes import FAILED

    episodes = results.episodes
    failed = episodes[(episodes["status"] == FAILED) & episodes["compensator"].isin(list(compensators))]
    if len(failed):
        raise Stop(str(failed["error"].iloc[0]))


def submissions_of(folder: Path | None) -> tuple[Competitor, ...]:
    """The submissions in a folder; by default in `SUBMISSIONS`, where there is one."""
    from fo_gym.evaluation.competitors.entry import submissions_in

    if folder is None and not SUBMISSIONS.is_dir():
        return ()
    try:
        return submissions_in(folder or SUBMISSIONS)
    except ValueError as error:
        raise Stop(str(error)) from error
