"""`fo-gym train`: train a compensator with Stable-Baselines3."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from fo_gym.console import Stop, check_folder, progress_bar, tell_written
from fo_gym.extras import install_command

__all__ = ["train"]


def train(
    out: Annotated[Path, typer.Option(file_okay=False, help="Folder of this training; a killed one goes on there.")],
    env: Annotated[str, typer.Option(help="Environment to train on.")] = "FJRStiction-v0",
    algo: Annotated[Literal["ppo", "sac", "tqc"], typer.Option(help="Algorithm of Stable-Baselines3.")] = "ppo",
    seed: Annotated[int, typer.Option(help="Seed of weights, episodes and exploration.")] = 0,
    direct: Annotated[
        bool, typer.Option("--direct", help="A policy alone, not added to the PID-type observer.")
    ] = False,
    segments: Annotated[int | None, typer.Option(help="Segments to train for; by default the algorithm's own.")] = None,
    tensorboard: Annotated[Path | None, typer.Option(help="Folder of TensorBoard's logs; none by default.")] = None,
) -> None:
    """Train a policy that compensates friction, for one joint, shared by all joints.

    Validation and a checkpoint follow every segment; the best weights are kept as policy.safetensors, with a model
    card, the learning curve, and a compensator.py to score them with. Run the same command again to go on after a
    kill. The shipped weights come from the first two commands below.

    Examples:
        fo-gym train --out build/rl-residual

        fo-gym train --direct --segments 12 --out build/rl-direct

        fo-gym train --env FJRRegulation-v0 --algo sac --seed 3 --out build/arm

        fo-gym evaluate build/rl-residual/compensator.py:Trained --env FJRSquare-v0
    """
    try:
        from baselines.rl.algorithms import ALGORITHMS  # noqa: PLC0415 (torch is heavy, and nothing else needs it)
        from baselines.rl.training import train as run  # noqa: PLC0415
    except ModuleNotFoundError as error:
        raise Stop(f"{error}; install what `fo-gym train` needs with: {install_command('rl')}") from error
    from baselines.rl.course import course_of  # noqa: PLC0415
    from baselines.rl.design import Design  # noqa: PLC0415
    from baselines.rl.plan import Plan  # noqa: PLC0415

    check_folder("--out", out)
    algorithm = ALGORITHMS[algo]
    try:
        plan = Plan(
            env_id=env,
            algo=algo,
            seed=seed,
            design=Design(residual=not direct),
            robots=max(1, algorithm.agents // course_of(env).joints),
            steps=algorithm.steps,
            segments=algorithm.segments if segments is None else segments,
        )
        with progress_bar(plan.segments * plan.actions) as advance:
            best = run(plan, out, on_steps=advance, tensorboard=tensorboard)
    except (ValueError, ImportError) as error:
        raise Stop(str(error)) from error
    tell_written([best, *(best.with_name(name) for name in ("card.md", "curve.csv", "curve.png", "compensator.py"))])
