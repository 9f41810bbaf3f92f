"""One run of the study: train, and score at every checkpoint."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pandas as pd
import torch
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.base_class import BaseAlgorithm

from baselines.rl.study.plan import Run, Study
from fo_gym import evaluate
from fo_gym.files import atomic, csv
from fo_gym.wrappers import AgentCompensator
from fo_gym.wrappers.vector import AgentView

__all__ = ["compensator_of", "mean_return", "perform", "score"]


def compensator_of(model: BaseAlgorithm, run: Run) -> AgentCompensator:
    """The model as it would stand on the leaderboard."""
    settings = run.recipe.settings
    period = settings.get("decimation", 1) * settings.get("control_dt", 1e-3)
    feedback = settings.get("feedback", "measured")
    return AgentCompensator(model, period, feedback=feedback, action_mode=run.action_mode, **run.recipe.view)


def mean_return(model: BaseAlgorithm, run: Run, seeds: Sequence[int]) -> float:
    """Mean return of the episodes of these seeds, as the agent lives them; the sum of rewards up to their end."""
    settings: dict[str, Any] = {**run.recipe.settings, "action_mode": run.action_mode}
    envs = gym.make_vec(run.env_id, num_envs=len(seeds), autoreset_mode=AutoresetMode.NEXT_STEP, **settings)
    view = AgentView(envs, **run.recipe.view)
    obs, _ = view.reset(seed=[int(seed) for seed in seeds])
    total, running, state = np.zeros(len(seeds)), np.ones(len(seeds), dtype=bool), None
    start = running.copy()
    while running.any():
        action, state = model.predict(obs, state, start, deterministic=True)
        obs, reward, terminated, truncated, _ = view.step(action)
        total += np.where(running, reward, 0.0)
        start = terminated | truncated
        running &= ~start
    view.close()
    return float(total.mean())


def score(model: BaseAlgorithm, run: Run, episodes: int) -> dict[str, float]:
    """Mean return and friction rejection ratio on validation episodes, those that cannot be scored left out."""
    # At the control rate, whatever the agent's own: as on the leaderboard.
    settings = {name: value for name, value in run.recipe.settings.items() if name not in ("decimation", "feedback")}
    rows = evaluate(compensator_of(model, run), run.env_id, seeds=episodes, **settings)
    return {"return": mean_return(model, run, rows["seed"].tolist()), "frr": float(rows["frr"].mean())}


def perform(run: Run, study: Study, out: Path, tensorboard: Path | None) -> None:
    """Train, and leave a file with one row per checkpoint; what is killed before leaves none, and begins again."""
    torch.set_num_threads(1)
    recipe = run.recipe
    venv = recipe.make_env(run.env_id, run.action_mode, run.episode_seed)
    model = recipe.make_model(venv, run.episode_seed, tensorboard)
    rows: list[dict[str, Any]] = []
    for checkpoint in range(1, study.checkpoints + 1):
        goal = recipe.n_timesteps * checkpoint // study.checkpoints
        model.learn(goal - model.num_timesteps, reset_num_timesteps=checkpoint == 1, tb_log_name=run.file(out).stem)
        who = {"env": run.env_id, "agent": run.label, "run": run.seed}
        rows.append({**who, "steps": model.num_timesteps, **score(model, run, study.episodes)})
    venv.close()
    atomic(run.file(out), csv(pd.DataFrame(rows)))
