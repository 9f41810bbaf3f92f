"""`fo-gym tune`: the same search for every compensator."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

import fo_gym
from fo_gym.console import Stop, check_folder, check_jobs, console, progress_bar, tell_written

__all__ = ["run_tune"]

VARIANTS = ("randomized", "hardware")


def run_tune(
    compensator: Annotated[str, typer.Argument(help="Registered name, module:Class or file.py:Class.")],
    env: Annotated[list[str] | None, typer.Option(help="Environment, repeatable; all by default.")] = None,
    variant: Annotated[list[str] | None, typer.Option(help="Variant, repeatable; randomized and hardware.")] = None,
    trials: Annotated[int, typer.Option(help="Sets of gains to try on each environment and variant.")] = 24,
    episodes: Annotated[int, typer.Option(help="Episodes of every trial.")] = 6,
    final_episodes: Annotated[int, typer.Option(help="Validation episodes of each finalist.")] = 20,
    seed: Annotated[int, typer.Option(help="Seed of the search.")] = 0,
    name: Annotated[str | None, typer.Option(help="What to call the result; by default COMPENSATOR-tuned.")] = None,
    out: Annotated[Path, typer.Option(file_okay=False, help="Folder; a killed search goes on there.")] = Path(
        "build/tuning"
    ),
    jobs: Annotated[int, typer.Option(help="Worker processes; -1 = one per core.")] = -1,
) -> None:
    """Tune a compensator's gains: as many trials and simulated seconds for everybody, on tuning seeds.

    The class declares what may be tuned: search_space = {"gain": (low, high), ...}. Gains are chosen on validation
    seeds among the best few and the compensator's own. Writes NAME.toml, an entry for `fo-gym evaluate` and for
    protocols, and a table of all trials per environment and variant.

    Examples:
        fo-gym tune pid-high --name pid-tuned

        fo-gym tune mine.py:Mine --env FJRStiction-v0 --variant hardware --trials 50

        fo-gym evaluate build/tuning/pid-tuned.toml --env FJRStiction-v0 --variant hardware
    """
    check_jobs(jobs)
    check_folder("--out", out)
    try:
        from fo_gym.tuning.run import tune  # noqa: PLC0415 (Optuna is an extra)
        from fo_gym.tuning.study import Case  # noqa: PLC0415
    except ModuleNotFoundError as error:
        raise Stop(f"{error}; install what `fo-gym tune` needs with: pip install 'fo-gym[tune]'") from error
    name = name or re.sub(r"\W+", "-", compensator.removesuffix("-high").removesuffix("-low")).strip("-") + "-tuned"
    try:
        cases = [
            Case(compensator, env_id, each, trials, episodes, seed, final_episodes)
            for env_id in env or fo_gym.ENVIRONMENTS
            for each in variant or VARIANTS
        ]
        with progress_bar(len(cases)) as advance:
            outcomes, written = tune(cases, name, out, jobs=jobs, on_case=lambda label: advance(label, 1))
    except (ValueError, TypeError, fo_gym.CompensatorError) as error:
        raise Stop(str(error)) from error
    table = Table("environment", "variant", "own gains", "tuned", "gains", title=f"{name}: mean FRR, validation seeds")
    for outcome in outcomes:
        finals = outcome.trials["frr_validation"]
        gains = ", ".join(f"{gain} {value:.4g}" for gain, value in outcome.gains.items())
        table.add_row(outcome.case.env_id, outcome.case.variant, f"{finals[0]:.4f}", f"{finals.max():.4f}", gains)
    console.print(table)
    tell_written(written)
