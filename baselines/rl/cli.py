"""`fo-gym train`: train a compensator, with Stable-Baselines3, or to tell what is not friction."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from baselines.rl.course import course_of
from baselines.rl.design import Design
from baselines.rl.plan import Algo, Plan
from fo_gym.console import Stop, check_folder, progress_bar, tell_written
from fo_gym.extras import install_command

__all__ = ["train"]


def train(
    out: Annotated[Path, typer.Option(file_okay=False, help="Folder of this training; a killed one goes on there.")],
    env: Annotated[str, typer.Option(help="Environment to train on.")] = "FJRStiction-v0",
    algo: Annotated[Algo, typer.Option(help="Algorithm of Stable-Baselines3.")] = "ppo",
    seed: Annotated[int, typer.Option(help="Seed of weights, episodes and exploration.")] = 0,
    direct: Annotated[
        bool, typer.Option("--direct", help="A policy alone, not added to the PID-type observer.")
    ] = False,
    adaptive: Annotated[
        bool, typer.Option("--adaptive", help="The compensator with a memory, which has robots and tasks of its own.")
    ] = False,
    segments: Annotated[int | None, typer.Option(help="Segments to train for; by default the algorithm's own.")] = None,
    tensorboard: Annotated[Path | None, typer.Option(help="Folder of TensorBoard's logs; none by default.")] = None,
) -> None:
    """Train a compensator for one joint, shared by all joints: a policy, or one that learns what is not friction.

    Validation and a checkpoint follow every segment; the best weights (with --adaptive the last) are kept as
    policy.safetensors, with a model card, the learning curve, and a compensator.py to score them with. Run the same
    command again to go on after a kill. The shipped weights come from the first three commands below.

    Examples:
        fo-gym train --out build/rl-residual

        fo-gym train --direct --segments 12 --out build/rl-direct

        fo-gym train --adaptive --out build/rl-adaptive

        fo-gym train --env FJRRegulation-v0 --algo sac --seed 3 --out build/arm

        fo-gym evaluate build/rl-residual/compensator.py:Trained --env FJRSquare-v0
    """
    check_folder("--out", out)
    try:
        if not adaptive:
            file = _policy(out, env, algo, seed, direct, segments, tensorboard)
        elif direct or tensorboard is not None or (env, algo) != ("FJRStiction-v0", "ppo"):
            raise Stop(
                "--adaptive has robots, tasks and a way to learn of its own; leave --env, --algo, --direct and "
                "--tensorboard out"
            )
        else:
            file = _adaptive(out, seed, segments)
    except ModuleNotFoundError as error:
        raise Stop(f"{error}; install what `fo-gym train` needs with: {install_command('rl')}") from error
    except (ValueError, ImportError) as error:
        raise Stop(str(error)) from error
    tell_written([file, *(file.with_name(name) for name in ("card.md", "curve.csv", "curve.png", "compensator.py"))])


def _policy(
    out: Path, env: str, algo: str, seed: int, direct: bool, segments: int | None, tensorboard: Path | None
) -> Path:
    """Train a policy; torch is heavy, and nothing else needs it."""
    from baselines.rl.algorithms import ALGORITHMS  # noqa: PLC0415
    from baselines.rl.training import train as run  # noqa: PLC0415

    algorithm = ALGORITHMS[algo]
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
        return run(plan, out, on_steps=advance, tensorboard=tensorboard)


def _adaptive(out: Path, seed: int, segments: int | None) -> Path:
    """Train the adaptive compensator."""
    from baselines.rl.adaptive.training import SEGMENTS, AdaptivePlan, train_adaptive  # noqa: PLC0415

    plan = AdaptivePlan(seed=seed, segments=SEGMENTS if segments is None else segments)
    with progress_bar(2 * plan.segments * plan.batches * plan.steps) as advance:
        return train_adaptive(plan, out, on_steps=advance)
