"""What all commands share: where they print, how they stop, and a progress bar."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from fo_gym.text import one_line, printable

console = Console(width=None if sys.stdout.isatty() or "COLUMNS" in os.environ else 140)
errors = Console(stderr=True)

MAX_JOBS = 1024
"""Worker processes at most."""

__all__ = [
    "Stop",
    "check_folder",
    "check_jobs",
    "console",
    "errors",
    "progress_bar",
    "say",
    "tell_written",
    "text_table",
]


class Stop(typer.Exit):
    """End with a message and exit code 2."""

    def __init__(self, message: str) -> None:
        errors.print(Text.assemble(("error:", "bold red"), " ", printable(message)), soft_wrap=True)
        super().__init__(code=2)


def check_jobs(jobs: int) -> None:
    """Stop where --jobs is neither a number of processes nor -1."""
    if jobs != -1 and not 1 <= jobs <= MAX_JOBS:
        raise Stop(
            f"--jobs is {jobs}; give the number of worker processes, from 1 to {MAX_JOBS}, or -1 for one per core"
        )


def check_folder(option: str, folder: Path) -> None:
    """Stop where a folder can be neither made nor written into: what is computed would be lost at the end."""
    nearest = next(path for path in (folder.absolute(), *folder.absolute().parents) if os.path.lexists(path))
    try:
        with suppress(FileNotFoundError):
            folder.stat()  # tells loops of links, and names that are too long
        with TemporaryFile(dir=nearest):  # permissions alone do not tell
            pass
    except OSError as error:
        raise Stop(
            f"{option} is {folder}, but nothing can be written into {nearest}: {error.strerror}; choose another"
        ) from error


@contextmanager
def progress_bar(total: int) -> Iterator[Callable[[str, int], None]]:
    """A progress bar on the error stream; call what it yields with a label and how much has been done."""
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=errors) as progress:
        task = progress.add_task("compiling kernels, starting", total=total)

        def advance(label: str, done: int) -> None:
            label = one_line(label)
            news = label != progress.tasks[task].description
            progress.update(task, advance=done, description=label)
            if news and not errors.is_terminal:
                say(label, errors)

        yield advance
        progress.update(task, description="done")


def say(text: str, where: Console = console) -> None:
    """Print a text as it is: no markup, no emoji codes, nothing that steers the terminal; lines are left to it."""
    where.print(Text(printable(text)), soft_wrap=True)


def text_table(title: str, headings: Sequence[str], rows: Sequence[Sequence[str]], bold: Collection[int] = ()) -> Table:
    """A table of texts as they are, each cell in one line as long as it fits.

    Args:
        title: above it.
        headings: one per column; "compensator" and "verdict" are words, and stand left, what else there is, right.
        rows: cells.
        bold: which rows stand out.
    """
    table = Table(title=Text(one_line(title)))
    for heading in headings:
        words = heading in ("compensator", "verdict")
        table.add_column(Text(heading), justify="left" if words else "right", overflow="fold")
    for place, row in enumerate(rows):
        table.add_row(*(Text(one_line(cell)) for cell in row), style="bold" if place in bold else None)
    return table


def tell_written(paths: list[Path]) -> None:
    """Name the files that a command wrote."""
    for path in paths:
        say(f"wrote {path}")
