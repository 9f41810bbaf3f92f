"""`fo-gym sweep`: a compensator over a grid of gains."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fo_gym.cli.gains import gain_sets
from fo_gym.cli.work import STORE, Fresh, Jobs, RobotOption, StoreFolder, note, robots_of, run_behind_bar, store_in
from fo_gym.console import Stop, check_folder, check_jobs, console, tell_written, text_table

if TYPE_CHECKING:
    import pandas as pd

_SHOWN = 10

__all__ = ["run_sweep"]


def run_sweep(
    compensator: Annotated[
        str, typer.Argument(help="Registered name, module:Class, file.py:Class, or entry (*.toml).")
    ],
    gains: Annotated[
        list[str],
        typer.Option(
            metavar="NAME=VALUES",
            help="What is swept, repeatable. LOW:HIGH:COUNT is COUNT values, geometric where both ends are above 0; "
            "LOW:HIGH:COUNT:linear; or values with commas between.",
        ),
    ],
    env: Annotated[list[str] | None, typer.Option(help="Environment id, repeatable; FJRStiction-v0.")] = None,
    robot: RobotOption = None,
    variant: Annotated[
        list[str] | None, typer.Option(help="nominal, randomized or hardware, repeatable; nominal.")
    ] = None,
    seeds: Annotated[
        int | None, typer.Option(min=1, help="Episodes, from the validation seeds; by default 20, of nominal alone 1.")
    ] = None,
    out: Annotated[Path | None, typer.Option(file_okay=False, help="Folder for sweep.csv and sweep.png.")] = None,
    jobs: Jobs = -1,
    store: StoreFolder = STORE,
    fresh: Fresh = False,
) -> None:
    """Score a compensator with every combination of some gains, on the same episodes.

    Sets of gains that the compensator refuses get rows with the status "failed" and the reason; the others go on.
    sweep.csv has a row per set and episode, with a column for each gain; sweep.png a curve over one gain, or a map
    over two. Finished sets are kept in the store.

    Examples:
        fo-gym sweep pd-high --gains L=20:400:10 --gains Lp=4:80:10

        fo-gym sweep mine.py:Mine --gains level=0.6,0.8,1.0 --variant randomized --seeds 5 --out build/sweep
    """
    from fo_gym.compensators import CompensatorError
    from fo_gym.evaluation.runs.protocol import Protocol
    from fo_gym.evaluation.runs.seeds import usual_count

    check_jobs(jobs)
    if out is not None:
        check_folder("--out", out)
    check_folder("--store", store)
    values = gain_sets(gains)
    envs, variants = tuple(env or ["FJRStiction-v0"]), tuple(variant or ["nominal"])
    try:
        count = usual_count(variants) if seeds is None else seeds
        protocol = Protocol("sweep", "validation", count, envs, variants, (compensator,), robots_of(robot))
        from fo_gym.evaluation.results.sweep import Grid, Plan
        from fo_gym.evaluation.runs.contest import episodes_in

        plan = Plan(Grid(compensator, values), episodes_in(protocol))
    except (ValueError, TypeError, OSError, CompensatorError) as error:
        raise Stop(str(error)) from error
    table = plan.table(run_behind_bar(plan.contests, "", store_in(store, fresh=fresh), jobs))
    _print(table, list(values))
    if out is not None:
        tell_written(_write(table, list(values), out))


def _print(table: pd.DataFrame, gains: Sequence[str]) -> None:
    """The best sets of every environment and variant, and how many failed."""
    from fo_gym.evaluation.results.sweep import summary_of
    from fo_gym.evaluation.runs.episodes import FAILED

    for key, rows in summary_of(table, gains).groupby(["env", "variant"], sort=False):
        best = rows.sort_values("frr", ascending=False, kind="stable", na_position="last").head(_SHOWN)
        best = best[best["status"] != FAILED]
        cells = [
            [
                *(f"{row[gain]:.6g}" for gain in gains),
                *(f"{row[name]:.4f}" for name in ("frr", "frr_worst")),
                row["status"],
            ]
            for row in best.to_dict("records")
        ]
        view = text_table(f"{key[0]}, {key[1]}", [*gains, "FRR", "worst episode", "status"], cells)
        view.caption = f"the best {len(best)} of {len(rows)} sets"
        console.print(view)
        failed = rows[rows["status"] == FAILED]
        if len(failed):
            note(f"{len(failed)} of {len(rows)} sets failed; the first: {failed['error'].iloc[0]}")


def _write(table: pd.DataFrame, gains: Sequence[str], out: Path) -> list[Path]:
    from fo_gym.evaluation.results.style import save_figure
    from fo_gym.evaluation.results.sweep_figure import sweep_figure
    from fo_gym.files import atomic, csv

    written = [out / "sweep.csv"]
    atomic(written[0], csv(table))
    if len(gains) > 2:
        note(f"no figure: it is drawn over one gain or two, not {len(gains)}")
        return written
    return [*written, *save_figure(sweep_figure(table, gains), out / "sweep")]
