"""A policy as files: NAME.safetensors, and beside it the model card NAME.json that vouches for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from baselines.rl.design import Design
from baselines.rl.loop import FEATURES
from baselines.rl.network import Network
from baselines.rl.signed import load_signed, save_signed

POLICY = "policy.safetensors"
"""Name of the weights in the folder of a training; the card is policy.json."""

_KEY = "fo-gym policy"

__all__ = ["POLICY", "load_policy", "save_policy"]


def save_policy(path: Path, design: Design, network: Network, card: Mapping[str, Any]) -> None:
    """Write the policy to `path` (*.safetensors) and its card, `card` and the hash of the weights, beside it."""
    description = {"design": asdict(design), "squash": network.squash, "features": FEATURES}
    save_signed(path, network.tensors(), {_KEY: description}, card)


def load_policy(path: Path) -> tuple[Design, Network]:
    """Read a policy. Nothing is unpickled.

    Raises:
        ValueError: a file is missing, the hash is not that of the card, or what the file holds is no such policy.
    """
    with load_signed(path, _KEY, "policy") as (tensors, description):
        if tuple(description["features"]) != FEATURES:
            raise ValueError(f"its inputs are {description['features']}; this version computes {list(FEATURES)}")
        return Design(**description["design"]), Network.from_tensors(tensors, description["squash"], len(FEATURES))
