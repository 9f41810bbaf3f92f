"""Stable-Baselines3's algorithms as they are used here, and how their actors become a `Network`."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from torch import nn

from baselines.rl.network import Network
from fo_gym.sb3 import VecEnvAdapter

__all__ = ["ALGORITHMS", "Algorithm", "export", "make_model"]

LEARNING_RATE = 5e-4
_HIDDEN = [32, 32]
_CRITIC = [64, 64]
_OFF_POLICY = {
    "buffer_size": 300_000,
    "batch_size": 512,
    "learning_starts": 5_000,
    "train_freq": 8,
    "gradient_steps": 4,
    "gamma": 0.98,
    "ent_coef": 0.005,
    "policy_kwargs": {"net_arch": {"pi": _HIDDEN, "qf": _CRITIC}, "activation_fn": nn.Tanh},
}


@dataclass(frozen=True)
class Algorithm:
    """One algorithm and how it is run.

    Attributes:
        source: "module:Class".
        agents: joints that are trained together, in as many robots as that takes.
        steps: actions of every agent in a segment, after which comes a validation and a checkpoint.
        segments: segments in a whole training.
        arguments: of the class.
    """

    source: str
    agents: int
    steps: int
    segments: int
    arguments: Mapping[str, Any]


ALGORITHMS = {
    "ppo": Algorithm(
        source="stable_baselines3:PPO",
        agents=128,
        steps=8192,
        segments=6,
        arguments={
            "n_steps": 512,
            "batch_size": 8192,
            "n_epochs": 8,
            "gamma": 0.995,
            "policy_kwargs": {
                "net_arch": {"pi": _HIDDEN, "vf": _CRITIC},
                "activation_fn": nn.Tanh,
                "log_std_init": -1.0,
            },
        },
    ),
    "sac": Algorithm("stable_baselines3:SAC", agents=32, steps=4096, segments=6, arguments=_OFF_POLICY),
    "tqc": Algorithm("sb3_contrib:TQC", agents=32, steps=4096, segments=6, arguments=_OFF_POLICY),
}


def make_model(algo: str, venv: VecEnvAdapter, steps: int, seed: int, tensorboard: Path | None = None) -> BaseAlgorithm:
    """An untrained model whose actor is an odd function of its inputs.

    Args:
        algo: one of ALGORITHMS.
        venv: training environment.
        steps: actions of every agent in a segment; a rollout is no longer.
        seed: of the initial weights.
        tensorboard: folder of TensorBoard's logs; None writes none.
    """
    algorithm = ALGORITHMS[algo]
    module, _, name = algorithm.source.partition(":")
    arguments = dict(algorithm.arguments)
    if "n_steps" in arguments:
        arguments["n_steps"] = min(arguments["n_steps"], steps)
        arguments["batch_size"] = min(arguments["batch_size"], arguments["n_steps"] * venv.num_envs)
    model = getattr(importlib.import_module(module), name)(
        "MlpPolicy",
        venv,
        seed=seed,
        learning_rate=LEARNING_RATE,
        device="cpu",
        tensorboard_log=None if tensorboard is None else str(tensorboard),
        **arguments,
    )
    with torch.no_grad():
        for layer in _actor(model):
            layer.bias.zero_()
            layer.bias.requires_grad_(False)
    return model


def _actor(model: BaseAlgorithm) -> list[nn.Linear]:
    """The layers from the inputs to the mean action."""
    policy: Any = model.policy
    if hasattr(policy, "action_net"):
        body, head = policy.mlp_extractor.policy_net, policy.action_net
    else:
        body, head = policy.actor.latent_pi, policy.actor.mu
    return [layer for layer in (*body, head) if isinstance(layer, nn.Linear)]


def export(model: BaseAlgorithm) -> Network:
    """The actor's mean action as a NumPy network."""
    weights = tuple(layer.weight.detach().numpy().T.astype("float64") for layer in _actor(model))
    # PPO's actions are clipped by the algorithm; SAC's and TQC's go through tanh in the actor.
    return Network(weights, "clip" if hasattr(model.policy, "action_net") else "tanh")
