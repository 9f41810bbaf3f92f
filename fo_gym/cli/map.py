"""`fo-gym map`: a metric over two parameters, cell by cell."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fo_gym.cli.gains import axis_of, gains_of
from fo_gym.cli.work import STORE, Fresh, Jobs, RobotOption, StoreFolder, note, store_in, working
from fo_gym.console import Stop, check_folder, check_jobs, say, tell_written

if TYPE_CHECKING:
    import pandas as pd

    from fo_gym.evaluation.results.map import Map

OUT = Path("build/map")
_VALUES = "NAME=VALUES, NAME a gain or f_s/f_c, f_c, f_s, v_s, sigma_0, ... of the friction; VALUES as for a sweep."

__all__ = ["OUT", "run_map"]


def run_map(
    compensator: Annotated[
        str, typer.Argument(help="Registered name, module:Class, file.py:Class, or entry (*.toml).")
    ],
    x: Annotated[str, typer.Option("--x", metavar="NAME=VALUES", help=f"To the right: {_VALUES}")],
    y: Annotated[str, typer.Option("--y", metavar="NAME=VALUES", help="Upwards; likewise.")],
    metric: Annotated[
        str, typer.Option(help="What is drawn: hunting, rest, frr, or a metric's column (see `fo-gym list`).")
    ] = "hunting",
    env: Annotated[str, typer.Option(help="Environment id; its nominal episode is run.")] = "FJRStiction-v0",
    robot: RobotOption = None,
    gains: Annotated[
        list[str] | None, typer.Option(metavar="NAME=VALUE", help="A gain that is the same everywhere, repeatable.")
    ] = None,
    duration: Annotated[float | None, typer.Option(help="Length of an episode, s; by default the task's own.")] = None,
    out: Annotated[Path, typer.Option(file_okay=False, help="Folder for map.csv, .json, .png and .pdf.")] = OUT,
    jobs: Jobs = -1,
    store: StoreFolder = STORE,
    fresh: Fresh = False,
) -> None:
    """Draw where a compensator hunts, stops short or works, over two of its gains or of the friction's parameters.

    VALUES is LOW:HIGH:COUNT (geometric where both ends are above 0), LOW:HIGH:COUNT:linear, or values with commas
    between. Cells run together, side by side in few batches; those that the compensator refuses are hatched, not run.
    pid and pd are the observers of arXiv:1907.00553 with what is not given in the proportions of its gains; these, and
    the line L_p^2 = 2 L_i, are marked. map.csv has every metric of every cell, map.json what is drawn of it: from both
    `fo-gym page` makes a map to look at. Finished batches are kept in the store: the same command goes on with them,
    and draws another metric at once.

    Examples:
        fo-gym map pid --x L=10:300:40 --y Li=1:400:40 --metric hunting

        fo-gym map pd --x L=10:300:40 --y Lp=2:60:40 --metric rest --duration 10

        fo-gym map pid-low --x f_s/f_c=1:2.5:30:linear --y v_s=1e-4:1e-1:30 --out build/friction

        fo-gym map mine.py:Mine --x level=0.5:1.5:9:linear --y f_c=0.5:2:9
    """
    check_jobs(jobs)
    check_folder("--out", out)
    check_folder("--store", store)
    axes = axis_of("--x", x), axis_of("--y", y)
    given = gains_of(gains or ())
    from fo_gym.compensators import CompensatorError
    from fo_gym.evaluation.results.map import Map, column_of, map_table

    kwargs: dict[str, Any] = {"robot": robot, "duration": duration}
    try:
        column = column_of(metric)
        chosen = {name: value for name, value in kwargs.items() if value is not None}
        plan = Map(compensator, *axes, env_id=env, gains=given, env_kwargs=chosen)
        cells = len(plan.cells) - len(plan.refused)
    except (ValueError, TypeError, OSError, CompensatorError) as error:
        raise Stop(str(error)) from error
    kept = f"; finished batches are kept in {store}, the same command goes on with them"
    with working("joblib", jobs, None, cells, kept) as (workers, told):
        table = map_table(plan, workers, store_in(store, fresh=fresh), told)
    _tell(table, column)
    tell_written(_write(table, plan, column, out))


def _tell(table: pd.DataFrame, column: str) -> None:
    """How many cells there are, and between what the metric lies."""
    from fo_gym.evaluation.runs.episodes import FAILED

    failed = table[table["status"] == FAILED]
    scores = table[column].dropna()
    between = f"; {column} from {scores.min():.4g} to {scores.max():.4g}" if len(scores) else f"; no {column}"
    say(f"{len(table)} cells, {len(failed)} refused or failed{between}")
    if len(failed):
        note(f"the first that was refused or failed: {failed['error'].iloc[0]}")


def _write(table: pd.DataFrame, plan: Map, column: str, out: Path) -> list[Path]:
    from fo_gym.evaluation.results.map_drawing import Drawing
    from fo_gym.evaluation.results.map_figure import map_figure
    from fo_gym.evaluation.results.style import save_figure
    from fo_gym.files import atomic, csv
    from fo_gym.reproduction.marks import paper_marks

    drawing = Drawing(plan.x[0], plan.y[0], column, paper_marks(plan))
    written = [out / "map.csv", out / "map.json"]
    for path, text in zip(written, (csv(table), drawing.text()), strict=True):
        atomic(path, text)
    return [*written, *save_figure(map_figure(table, drawing), out / "map", ("png", "pdf"))]
