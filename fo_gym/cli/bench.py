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
    from fo_gym.evaluation.results.tables import Ranking

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
        Path | None,
        typer.Option(file_okay=False, help="Folder for the tables, bench.md and growth.png; nothing is written else."),
    ] = None,
) -> None:
    """Measure the speed of the environments beside named peers, as ratios of the same run.

    The peers: the same plant wholly in MuJoCo, at its usual step and at one that errs as little; SciPy's LSODA;
    Gymnasium's sync and async vector environments and its Pusher-v5; Stable-Baselines3's SubprocVecEnv. Some need the
    extra "bench"; what is not installed is not measured, and says so. Beside them: how times grow, memory, and the
    parts of a whole leaderboard. A missed bar is shown and is no error: speed depends on the machine. Close other
    programs first: it takes some ten minutes.

    Examples:
        fo-gym bench

        fo-gym bench --env FJRStiction-v0 --env FJRRegulation-v0 --out build/bench

        fo-gym bench --quick
    """
    from fo_gym import ENVIRONMENTS
    from fo_gym.bench.measurement import RATIOS
    from fo_gym.bench.report import EXPLANATION, counts, views, write_bench
    from fo_gym.bench.run import bench, check_envs, measurements
    from fo_gym.bench.size import FULL, QUICK
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
    chosen = measurements(env_ids, size)
    with progress_bar(len(chosen)) as advance:
        results = bench(chosen, told=lambda label: advance(label, 1))
    console.print(EXPLANATION, highlight=False, markup=False)
    for ranking, text in views(results):
        console.print(_table(ranking))
        console.print(text, highlight=False, markup=False)
    console.print(counts(results[RATIOS]), highlight=False)
    if out is not None:
        tell_written(write_bench(results, out))


def _table(ranking: Ranking) -> Table:
    from fo_gym.bench.bars import MISSES

    words = {"env", "measured", "beside", "verdict", "note", "part"}
    shown = Table(title=ranking.title)
    for heading in ranking.headings:
        shown.add_column(escape(heading), justify="left" if heading in words else "right", overflow="fold")
    for cells in ranking.cells:
        shown.add_row(*map(escape, cells), style="bold" if MISSES in cells else None)
    return shown
