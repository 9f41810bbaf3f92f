"""What was learned as files: NAME.safetensors, and beside it the model card NAME.json that vouches for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from baselines.rl.adaptive.design import AdaptiveDesign
from baselines.rl.adaptive.rows import COLUMNS, INPUTS
from baselines.rl.adaptive.weights import SUMMARY, Weights
from baselines.rl.signed import load_signed, save_signed

_KEY = "fo-gym adaptive"

__all__ = ["load_weights", "save_weights"]


def save_weights(path: Path, design: AdaptiveDesign, weights: Weights, card: Mapping[str, Any]) -> None:
    """Write the weights to `path` (*.safetensors), and their card, `card` and their hash, beside them."""
    description = {"design": asdict(design), "columns": COLUMNS, "inputs": INPUTS, "summary": SUMMARY}
    save_signed(path, weights.tensors(), {_KEY: description}, card)


def load_weights(path: Path) -> tuple[AdaptiveDesign, Weights]:
    """Read what was learned. Nothing is unpickled.

    Raises:
        ValueError: a file is missing, the hash is not that of the card, or what the file holds are no such weights.
    """
    with load_signed(path, _KEY, "adaptive weights") as (tensors, description):
        known = [COLUMNS, list(INPUTS), list(SUMMARY)]
        found = [description["columns"], description["inputs"], description["summary"]]
        if found != known:
            raise ValueError(f"its rows are of {found}; this version computes {known}")
        return AdaptiveDesign(**description["design"]), Weights.from_tensors(tensors)
