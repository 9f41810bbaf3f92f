"""`fo-gym bench`: how fast the environments are beside MuJoCo alone and beside what else steps many of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

from fo_gym.console import Stop, check_folder, console, progress_bar, tell_written

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["run_bench"]


def run_bench(
    env: Annotated[list[str] | None, typer.Option(help="Environment id, repeatable; all by default.")] = None,
    num_envs: Annotated[
        int | None, typer.Option(min=1, help="Environments of the batch; 256, or 16 with --quick.")
    ] = None,
    repeats: Annotated[
        int | None,
        typer.Option(
            min=1, max=10_000, help="Rounds, in each of which everybody is timed once; 15, or 3 with --quick."
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Tiny: shows that everything runs, not how fast.")] = False,
    out: Annotated[
        Path | None, typer.Option(file_okay=False, help="Folder for bench.csv and bench.md; nothing is written else.")
    ] = None,
) -> None:
    """Measure the speed of the environments beside named peers, as ratios of the same run.

    The peers: the same plant wholly in MuJoCo, Gymnasium's sync and async vector environments, and
    Stable-Baselines3's SubprocVecEnv (needs the extra "rl"). A missed bar is shown and is no error: speed depends on
    the machine. Close other programs first.

    Examples:
        fo-gym bench

        fo-gym bench --env FJRStiction-v0 --env FJRRegulation-v0 --out build/bench

        fo-gym bench --quick
    """
    from fo_gym import ENVIRONMENTS
    from fo_gym.bench.report import EXPLANATION, counts, write_bench
    from fo_gym.bench.run import FULL, QUICK, bench, check_envs, count
    from fo_gym.plant.plant import MAX_ENVS

    if num_envs is not None and num_envs > MAX_ENVS:
        raise Stop(f"--num-envs is {num_envs}; give at most {MAX_ENVS}")
    size = QUICK if quick else FULL
    size = replace(size, num_envs=num_envs or size.num_envs, repeats=repeats or size.repeats)
    env_ids = env or list(ENVIRONMENTS)
    if out is not None:
        check_folder("--out", out)
    try:
        check_envs(env_ids)
    except ValueError as error:
        raise Stop(str(error)) from error
    with progress_bar(count(env_ids, size)) as advance:
        table = bench(env_ids, size, on_group=lambda label: advance(label, 1))
    console.print(_view(table))
    console.print(EXPLANATION, highlight=False, markup=False)
    console.print(counts(table), highlight=False)
    if out is not None:
        tell_written(write_bench(table, out))


def _view(table: pd.DataFrame) -> Table:
    from fo_gym.bench.bars import MISSES
    from fo_gym.bench.report import view

    ranking = view(table)
    words = {"env", "measured", "beside", "verdict"}
    shown = Table(title=ranking.title)
    for heading in ranking.headings:
        shown.add_column(escape(heading), justify="left" if heading in words else "right", overflow="fold")
    for cells in ranking.cells:
        shown.add_row(*map(escape, cells), style="bold" if MISSES in cells else None)
    return shown
