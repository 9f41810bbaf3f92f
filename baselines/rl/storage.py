"""A policy as files: NAME.safetensors, and beside it the model card NAME.json that vouches for it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from baselines.rl.design import Design
from baselines.rl.loop import FEATURES
from baselines.rl.network import Network
from fo_gym.files import atomic

POLICY = "policy.safetensors"
"""Name of the weights in the folder of a training; the card is policy.json."""

_KEY = "fo-gym policy"

__all__ = ["POLICY", "load_policy", "save_policy"]


def save_policy(path: Path, design: Design, network: Network, card: Mapping[str, Any]) -> None:
    """Write the policy to `path` (*.safetensors) and its card, `card` and the hash of the weights, beside it.

    The card goes last: a run that is killed in between leaves weights that the loader refuses, not wrong ones.
    """
    description = {"design": asdict(design), "squash": network.squash, "features": FEATURES}
    content = save(network.tensors(), metadata={_KEY: json.dumps(description)})
    atomic(path, content)
    signed = {"sha256": hashlib.sha256(content).hexdigest(), **card}
    atomic(path.with_suffix(".json"), json.dumps(signed, indent=2) + "\n")


def load_policy(path: Path) -> tuple[Design, Network]:
    """Read a policy. Nothing is unpickled.

    Raises:
        ValueError: a file is missing, the hash is not that of the card, or what the file holds is no such policy.
    """
    card = path.with_suffix(".json")
    for file, what in ((path, "weights"), (card, "the model card of these weights")):
        if not file.is_file():
            raise ValueError(f"there is no {file}: {what}; train a policy with `fo-gym train --out DIR`")
    try:
        expected = json.loads(card.read_text(encoding="utf-8"))["sha256"]
    except (json.JSONDecodeError, UnicodeDecodeError, KeyError, TypeError) as error:
        raise ValueError(f"{card} is no model card: {type(error).__name__}: {error}") from error
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    if found != expected:
        raise ValueError(f"{path} has the hash {found}, its card says {expected}: one of them was changed or cut short")
    try:
        with safe_open(path, framework="numpy") as file:
            description = json.loads((file.metadata() or {})[_KEY])
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (no mapping)
        if tuple(description["features"]) != FEATURES:
            raise ValueError(f"its inputs are {description['features']}; this version computes {list(FEATURES)}")
        return Design(**description["design"]), Network.from_tensors(tensors, description["squash"], len(FEATURES))
    except (SafetensorError, KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{path} holds no policy that can be used: {type(error).__name__}: {error}") from error
