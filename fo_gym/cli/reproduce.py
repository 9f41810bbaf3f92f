"""`fo-gym reproduce`: the paper's figures and claims, and the certificate of the physics."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from rich.markup import escape
from rich.table import Table

from fo_gym.cli.work import Jobs
from fo_gym.console import Stop, check_folder, check_jobs, console, errors, progress_bar, say, tell_written
from fo_gym.extras import install_command

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["run_reproduce"]


def run_reproduce(
    only: Annotated[
        Literal["claims", "figures", "fidelity"] | None, typer.Option(help="One part alone; all by default.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer random cases; same statements and tolerances.")] = False,
    out: Annotated[
        Path | None,
        typer.Option(file_okay=False, help="Folder for the results; build/reproduce, or build/reproduce-quick."),
    ] = None,
    jobs: Jobs = -1,
) -> None:
    """Reproduce what arXiv:1907.00553 shows and says, and certify the physics.

    Writes paper/claims.csv, paper/figures/ and fidelity.csv, with a page beside each table. Ends with exit code 2 if
    a verdict is not the known one.

    Examples:
        fo-gym reproduce

        fo-gym reproduce --only figures --out build/paper

        fo-gym reproduce --quick
    """
    check_jobs(jobs)
    try:
        from fo_gym.certificate.subject import Subject
        from fo_gym.reproduction.report import counts, write_reproduction
        from fo_gym.reproduction.run import PARTS, reproduce, size, surprises
    except ModuleNotFoundError as error:  # Pinocchio is heavy, and nothing else needs it
        raise Stop(f"{error}; install what `fo-gym reproduce` needs with: {install_command('reproduce')}") from error
    parts = PARTS if only is None else (only,)
    folder = out or Path("build/reproduce-quick" if quick else "build/reproduce")
    check_folder("--out", folder)
    with progress_bar(size(parts)) as advance:
        found = reproduce(parts, Subject(quick=quick), folder / "paper" / "figures", jobs=jobs, on_unit=advance)
    for name, table in found.tables.items():
        console.print(_view(f"{name}: {counts(table)}", table))
    tell_written(write_reproduction(found, folder))
    for name, reason in found.errors.items():
        say(f"figure {name}: {reason}", errors)
    unexpected = surprises(found)
    if unexpected:
        raise Stop(f"not as it is known to be: {', '.join(unexpected)}; see the column 'measured'")


def _view(title: str, table: pd.DataFrame) -> Table:
    from fo_gym.reproduction.wording import number, tolerance

    view = Table(title=title)
    for heading in ("id", "number", "tolerance", "verdict"):
        view.add_column(heading, justify="right" if heading == "number" else "left", overflow="fold")
    for row in table.to_dict("records"):
        verdict = row["verdict"] if row["verdict"] == "holds" else f"[bold]{row['verdict']}[/]"
        cells = (row["id"], number(row["number"], row["unit"]), tolerance(row["low"], row["high"]))
        view.add_row(*(escape(str(cell)) for cell in cells), verdict)
    return view
