"""Hyperparameters in RL-Zoo's format, and the Stable-Baselines3 model that they make."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.vec_env import VecEnv, VecMonitor

from fo_gym.checks import shown
from fo_gym.sb3 import make_vec_env
from fo_gym.wrappers.vector import AgentView

SOURCES = {
    "ppo": "stable_baselines3:PPO",
    "sac": "stable_baselines3:SAC",
    "td3": "stable_baselines3:TD3",
    "tqc": "sb3_contrib:TQC",
    "crossq": "sb3_contrib:CrossQ",
    "ppo_lstm": "sb3_contrib:RecurrentPPO",
}
"""Algorithms by RL-Zoo's names of them, each "module:Class"."""

_VIEW = "fo_gym.wrappers.AgentView"

__all__ = ["SOURCES", "Recipe"]


@dataclass(frozen=True)
class Recipe:
    """One algorithm and how it is run.

    Attributes:
        algo: one of SOURCES.
        n_envs: environments in the batch.
        n_timesteps: steps of all of them together in a training.
        view: arguments of AgentView.
        settings: arguments of the environment, see `fo_gym.Settings`.
        arguments: of the algorithm's class.
    """

    algo: str
    n_envs: int
    n_timesteps: int
    view: Mapping[str, Any]
    settings: Mapping[str, Any]
    arguments: Mapping[str, Any]

    @classmethod
    def load(cls, folder: Path, algo: str) -> Recipe:
        """Of the file ALGO.yml, its entry "default".

        Raises:
            ValueError: there is no such file, or its agents see the environment otherwise than through AgentView.
        """
        file = folder / f"{algo}.yml"
        if not file.is_file():
            raise ValueError(f"there is no {file}; give the folder of the hyperparameters, examples/rl_zoo, as --zoo")
        given = dict(yaml.safe_load(file.read_text(encoding="utf-8"))["default"])
        wrapper = given.pop("env_wrapper", None)
        wrappers = [wrapper] if isinstance(wrapper, str) else wrapper or []
        named = [each if isinstance(each, dict) else {each: {}} for each in wrappers]
        if [list(each) for each in named] != [[_VIEW]]:
            raise ValueError(f"{file}: env_wrapper is {shown(wrapper)}; the study takes {_VIEW} alone")
        parts = {name: given.pop(name) for name in ("n_envs", "n_timesteps")}
        return cls(algo, **parts, view=named[0][_VIEW], settings=given.pop("env_kwargs", {}), arguments=given)

    def with_steps(self, steps: int, checkpoints: int) -> Recipe:
        """The same for so many steps; a rollout goes no further than a checkpoint, and is one batch where it is cut."""
        short = dict(self.arguments)
        if "n_steps" in short:
            short["n_steps"] = max(2, min(short["n_steps"], steps // checkpoints // self.n_envs))
            rollout = short["n_steps"] * self.n_envs
            short["batch_size"] = short["batch_size"] if rollout % short["batch_size"] == 0 else rollout
        return replace(self, n_timesteps=steps, arguments=short)

    def make_env(self, env_id: str, action_mode: str, seed: int) -> VecEnv:
        """The batch that is trained on, seeded; it tells the returns of its episodes."""
        view = partial(AgentView, **self.view)
        settings = {**self.settings, "action_mode": action_mode}
        return VecMonitor(make_vec_env(env_id, self.n_envs, seed=seed, wrapper=view, **settings))

    def make_model(self, venv: VecEnv, seed: int, tensorboard: Path | None) -> BaseAlgorithm:
        """The untrained model; its seed is that of the environments, too.

        Raises:
            TypeError: the class does not take an argument of the file.
        """
        module, _, name = SOURCES[self.algo].partition(":")
        arguments = dict(self.arguments)
        kind, std = arguments.pop("noise_type", None), arguments.pop("noise_std", 0.0)
        if kind is not None:
            high = venv.action_space.high  # type: ignore[attr-defined]
            arguments["action_noise"] = NormalActionNoise(np.zeros_like(high), std * high)
        log = None if tensorboard is None else str(tensorboard)
        made = getattr(importlib.import_module(module), name)
        model: BaseAlgorithm = made(env=venv, seed=seed, device="cpu", tensorboard_log=log, **arguments)
        return model
