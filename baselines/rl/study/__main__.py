"""`python -m baselines.rl.study`: six algorithms on three environments, five runs each."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from joblib import Parallel, delayed

from baselines.rl.plan import claim
from baselines.rl.study.plan import ENVIRONMENTS, Study, runs_of
from baselines.rl.study.recipe import SOURCES, Recipe
from baselines.rl.study.run import perform
from baselines.rl.study.summary import write_summary
from fo_gym.console import Stop, check_folder, check_jobs, progress_bar, tell_written

__all__ = ["app", "study"]

app = typer.Typer(add_completion=False)


@app.command()
def study(
    out: Annotated[Path, typer.Option(file_okay=False, help="Folder; a study that was killed goes on there.")],
    zoo: Annotated[Path, typer.Option(help="Folder of the hyperparameters.")] = Path("examples/rl_zoo"),
    algo: Annotated[list[str] | None, typer.Option(help="Algorithm; repeatable. By default all six.")] = None,
    env: Annotated[list[str] | None, typer.Option(help="Environment; repeatable. By default the three.")] = None,
    seeds: Annotated[int, typer.Option(min=1, max=999, help="Runs of each.")] = 5,
    steps: Annotated[int | None, typer.Option(min=1, help="Steps of a run, in place of the files'.")] = None,
    checkpoints: Annotated[int, typer.Option(min=1, help="Scores in a run.")] = 4,
    episodes: Annotated[int, typer.Option(min=1, help="Validation episodes of a score.")] = 5,
    jobs: Annotated[int, typer.Option(help="Worker processes, one thread each.")] = 2,
    tensorboard: Annotated[Path | None, typer.Option(help="Folder of TensorBoard's logs; none by default.")] = None,
) -> None:
    """Train PPO (also with torques), SAC, TD3, TQC, CrossQ and RecurrentPPO, and compare return and FRR.

    Every run leaves one file in OUT/runs; after a kill the runs that are missing are begun again. Table, curves and
    figure are of all runs that are done. Episodes are of training seeds, scores of validation seeds.

    Examples:
        python -m baselines.rl.study --out build/study

        python -m baselines.rl.study --out build/try --algo ppo --env FJRStiction-v0 --seeds 1 --steps 50000
    """
    check_folder("--out", out)
    check_jobs(jobs)
    _check_names("--algo", algo, SOURCES)
    _check_names("--env", env, ENVIRONMENTS)
    try:
        recipes = [Recipe.load(zoo, name) for name in algo or SOURCES]
        recipes = recipes if steps is None else [recipe.with_steps(steps, checkpoints) for recipe in recipes]
        plan = Study(tuple(recipes), checkpoints, episodes)
        claim(out, asdict(plan))
        runs = runs_of(recipes, env or ENVIRONMENTS, seeds)
        missing = [run for run in runs if not run.file(out).is_file()]
        with progress_bar(len(runs)) as advance:
            advance(f"{len(runs) - len(missing)} of {len(runs)} runs are done", len(runs) - len(missing))
            work = (delayed(perform)(run, plan, out, tensorboard) for run in missing)
            for _ in Parallel(n_jobs=jobs, return_as="generator_unordered")(work):
                advance("training", 1)
        written = write_summary(out)
    except (ValueError, TypeError, ImportError) as error:
        raise Stop(str(error)) from error
    tell_written(written)


def _check_names(option: str, given: Iterable[str] | None, allowed: Collection[str]) -> None:
    """Raise Stop where a name that is given is not allowed."""
    for name in given or ():
        if name not in allowed:
            raise Stop(f"{option} is {name}; allowed are {', '.join(allowed)}")


if __name__ == "__main__":
    app()
