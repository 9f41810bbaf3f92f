"""`fo-gym tune`: the same search for every compensator."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from fo_gym.cli.work import Jobs, store_in
from fo_gym.console import Stop, check_folder, check_jobs, console, progress_bar, tell_written
from fo_gym.extras import install_command

if TYPE_CHECKING:
    from fo_gym.tuning.study import Outcome

__all__ = ["run_tune"]

VARIANTS = ("randomized", "hardware")
OUT = Path("build/tuning")


def run_tune(
    compensator: Annotated[str, typer.Argument(help="Registered name, module:Class or file.py:Class.")],
    env: Annotated[list[str] | None, typer.Option(help="Environment, repeatable; all by default.")] = None,
    variant: Annotated[list[str] | None, typer.Option(help="Variant, repeatable; randomized and hardware.")] = None,
    trials: Annotated[int, typer.Option(help="Sets of gains to try on each environment and variant.")] = 24,
    episodes: Annotated[int, typer.Option(help="Episodes of every trial.")] = 6,
    final_episodes: Annotated[int, typer.Option(help="Validation episodes of each finalist.")] = 20,
    seed: Annotated[int, typer.Option(help="Seed of the search.")] = 0,
    name: Annotated[str | None, typer.Option(help="What to call the result; by default COMPENSATOR-tuned.")] = None,
    author: Annotated[
        list[str] | None,
        typer.Option(help='Who made the compensator, repeatable; "unnamed" by default, unless the project did.'),
    ] = None,
    out: Annotated[Path, typer.Option(file_okay=False, help="Folder; a killed search goes on there.")] = OUT,
    jobs: Jobs = -1,
) -> None:
    """Tune a compensator's gains: as many trials and simulated seconds for everybody, on tuning seeds.

    The class declares what may be tuned: search_space = {"gain": (low, high), ...}. Gains are chosen on validation
    seeds among the best few and the compensator's own. Writes NAME.toml, an entry for `fo-gym evaluate` and for
    protocols, and a table of all trials per environment and variant.

    Examples:
        fo-gym tune pid-high --name pid-tuned

        fo-gym tune mine.py:Mine --env FJRStiction-v0 --variant hardware --trials 50 --author "A. Author"

        fo-gym evaluate build/tuning/pid-tuned.toml --env FJRStiction-v0 --variant hardware
    """
    check_jobs(jobs)
    check_folder("--out", out)
    try:
        from fo_gym.tuning.run import check_tuning, tune
        from fo_gym.tuning.study import Case
    except ModuleNotFoundError as error:
        raise Stop(f"{error}; install what `fo-gym tune` needs with: {install_command('tune')}") from error
    from fo_gym import ENVIRONMENTS, CompensatorError

    name = _default_name(compensator) if name is None else name
    repeated = {"--env": env, "--variant": variant, "--author": author}
    single: dict[str, object] = {
        "--trials": trials,
        "--episodes": episodes,
        "--final-episodes": final_episodes,
        "--seed": seed,
    }
    single |= {"--name": name} | ({} if out == OUT else {"--out": out})
    try:
        cases = [
            Case(compensator, env_id, each, trials, episodes, seed, final_episodes)
            for env_id in env or ENVIRONMENTS
            for each in variant or VARIANTS
        ]
        check_tuning(cases, name, author or ())
        with progress_bar(len(cases)) as advance:
            outcomes, written = tune(
                cases,
                name,
                out,
                store=store_in(out / "store", fresh=False),
                authors=author or (),
                command=_command(compensator, repeated, single),
                jobs=jobs,
                on_case=lambda label: advance(label, 1),
            )
    except (ValueError, TypeError, CompensatorError) as error:
        raise Stop(str(error)) from error
    console.print(_view(name, outcomes))
    tell_written(written)


def _default_name(compensator: str) -> str:
    """mine-Mine-tuned of path/mine.py:Mine, pid-tuned of pid-high."""
    from fo_gym.specs import spec_of

    spec = spec_of(compensator)
    short = f"{Path(spec.where).stem}-{spec.attribute}" if spec.kind == "file" else compensator
    return re.sub(r"\W+", "-", short.removesuffix("-high").removesuffix("-low")).strip("-") + "-tuned"


def _command(compensator: str, repeated: dict[str, list[str] | None], single: dict[str, object]) -> str:
    """The command that gives this result again, as a shell takes it; what has no influence on it is left out."""
    words = ["fo-gym", "tune", compensator]
    for option, values in repeated.items():
        for value in values or ():
            words += [option, value]
    for option, text in single.items():
        words += [option, str(text)]
    return shlex.join(words)


def _view(name: str, outcomes: Sequence[Outcome]) -> Table:
    table = Table("environment", "variant", "own gains", "tuned", "gains", title=f"{name}: mean FRR, validation seeds")
    for outcome in outcomes:
        finals = outcome.trials["frr_validation"]
        gains = ", ".join(f"{gain} {value:.4g}" for gain, value in outcome.gains.items())
        table.add_row(outcome.case.env_id, outcome.case.variant, f"{finals[0]:.4f}", f"{finals.max():.4f}", gains)
    return table
