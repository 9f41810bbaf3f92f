"""Train a policy: segment by segment, each from seeds of its own, so that a run that was killed goes on exactly."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback

from baselines.rl.algorithms import LEARNING_RATE, export, make_model
from baselines.rl.checkpoint import load_checkpoint, save_checkpoint
from baselines.rl.compensator import LearnedCompensator
from baselines.rl.environment import TrainingEnv
from baselines.rl.plan import OnSteps, Plan, claim, silence
from baselines.rl.report import card, write_report
from baselines.rl.storage import POLICY, save_policy
from fo_gym import evaluate
from fo_gym.files import atomic, csv
from fo_gym.sb3 import VecEnvAdapter

_THREADS = 2  # the same everywhere: sums in another order are other weights

__all__ = ["train"]


@dataclass(frozen=True)
class _Folder:
    """Where a training keeps what it has so far."""

    path: Path

    @property
    def checkpoint(self) -> Path:
        return self.path / "checkpoint.pt"

    def table(self, name: str, segments: int) -> list[dict[str, Any]]:
        """The first rows of a table: those of the segments that are done."""
        file = self.path / f"{name}.csv"
        return pd.read_csv(file).head(segments).to_dict("records") if segments else []  # type: ignore[return-value]

    def keep(self, name: str, rows: list[dict[str, Any]]) -> None:
        """Write a table."""
        atomic(self.path / f"{name}.csv", csv(pd.DataFrame(rows)))


class _Progress(BaseCallback):
    """Tell how many actions have been taken."""

    def __init__(self, label: str, on_steps: OnSteps) -> None:
        super().__init__()
        self._label, self._on_steps = label, on_steps

    def _on_step(self) -> bool:
        self._on_steps(self._label, self.training_env.num_envs)
        return True


def _segment(model: BaseAlgorithm, plan: Plan, segment: int, callback: _Progress) -> None:
    """Train for one segment: fresh episodes, a learning rate that falls to a tenth over the plan."""
    rate = LEARNING_RATE * max(0.1, 1.0 - segment / plan.segments)
    model.lr_schedule = lambda _: rate
    model.set_random_seed(plan.episode_seed(segment))
    model._last_obs = None  # makes `learn` reset the environment, with the seed just given
    model.learn(plan.actions, callback=callback, reset_num_timesteps=False)


def _validate(plan: Plan, compensator: LearnedCompensator) -> dict[str, float]:
    """Scores on validation seeds: mean and worst friction rejection, and what remains at rest."""
    rows = evaluate(compensator, plan.env_id, variant="randomized", seeds=plan.validation_seeds)
    return {
        "frr_mean": rows["frr"].mean(),
        "frr_worst": rows["frr"].min(),
        "steady_state_error_ju": rows["steady_state_error_ju"].median(),
        "limit_cycle_peak_to_peak_ju": rows["limit_cycle_peak_to_peak_ju"].median(),
    }


def train(plan: Plan, out: Path, *, on_steps: OnSteps | None = None, tensorboard: Path | None = None) -> Path:
    """Train, or go on training, in the folder `out`; returns the file of the best weights.

    The best are those with the largest mean FRR on the validation seeds of the plan's own environment.

    Args:
        plan: what is asked for.
        out: folder; holds policy.safetensors with its card, curve.csv, timing.csv, curve.png, compensator.py,
            checkpoint.pt.
        on_steps: called with a label and the number of actions that were taken since the last call.
        tensorboard: folder of TensorBoard's logs; None writes none.

    Raises:
        ValueError: `out` holds another training.
    """
    claim(out, asdict(plan))
    torch.set_num_threads(_THREADS)
    env = TrainingEnv(plan.env_id, plan.robots, plan.design)
    model = make_model(plan.algo, VecEnvAdapter(env), plan.steps, plan.seed, tensorboard)
    folder, announce = _Folder(out), on_steps or silence
    done = load_checkpoint(folder.checkpoint, model)
    curve, timing = folder.table("curve", done), folder.table("timing", done)
    announce(f"{done} of {plan.segments} segments are done", done * plan.actions)
    for segment in range(done, plan.segments):
        start, env.seconds = time.perf_counter(), 0.0
        env.rewards.clear()
        _segment(model, plan, segment, _Progress(f"segment {segment + 1} of {plan.segments}", announce))
        trained = time.perf_counter()
        compensator = LearnedCompensator(plan.design, export(model))
        # As the curve keeps them: a run that goes on from it compares the same numbers.
        scores = {name: float(f"{score:.6g}") for name, score in _validate(plan, compensator).items()}
        row = {"segment": segment + 1, "actions": model.num_timesteps, "reward": float(np.mean(env.rewards)), **scores}
        best = max((earlier["frr_mean"] for earlier in curve), default=-np.inf)
        curve.append(row)
        timing.append({"segment": segment + 1, "seconds": trained - start, "environment_seconds": env.seconds})
        if scores["frr_mean"] > best:
            save_policy(out / POLICY, plan.design, compensator.network, card(plan, row))
        folder.keep("curve", curve)
        folder.keep("timing", timing)
        save_checkpoint(folder.checkpoint, model, segment + 1)
        for name in ("reward", *scores):
            model.logger.record(f"segment/{name}", row[name])
        model.logger.dump(model.num_timesteps)
        announce(f"segment {segment + 1} of {plan.segments}: validation FRR {scores['frr_mean']:.4f}", 0)
    write_report(plan, out)
    return out / POLICY
