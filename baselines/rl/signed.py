"""Tensors as files that a card vouches for: NAME.safetensors, and beside it NAME.json with their hash."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from fo_gym.files import atomic

__all__ = ["load_signed", "save_signed"]


def save_signed(
    path: Path, tensors: Mapping[str, NDArray[Any]], descriptions: Mapping[str, Any], card: Mapping[str, Any]
) -> None:
    """Write tensors with descriptions (JSON) to `path` (*.safetensors), and `card` with their hash beside them.

    The card goes last: a run that is killed in between leaves weights that the loader refuses, not wrong ones.
    """
    content = save(dict(tensors), metadata={key: json.dumps(value) for key, value in descriptions.items()})
    atomic(path, content)
    signed = {"sha256": hashlib.sha256(content).hexdigest(), **card}
    atomic(path.with_suffix(".json"), json.dumps(signed, indent=2) + "\n")


@contextmanager
def load_signed(path: Path, key: str, what: str) -> Iterator[tuple[dict[str, NDArray[Any]], Any]]:
    """Tensors by name and the description `key`. Nothing is unpickled.

    Args:
        path: the file.
        key: of its description.
        what: what it should hold, for messages.

    Raises:
        ValueError: a file is missing, the hash is not that of the card, or what the file holds is not what it should
            be: what fails within the block counts as that.
    """
    card = path.with_suffix(".json")
    for file, name in ((path, "weights"), (card, "the model card of these weights")):
        if not file.is_file():
            raise ValueError(f"there is no {file}: {name}; train a policy with `fo-gym train --out DIR`")
    try:
        expected = json.loads(card.read_text(encoding="utf-8"))["sha256"]
    except (json.JSONDecodeError, UnicodeDecodeError, KeyError, TypeError) as error:
        raise ValueError(f"{card} is no model card: {type(error).__name__}: {error}") from error
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    if found != expected:
        raise ValueError(f"{path} has the hash {found}, its card says {expected}: one of them was changed or cut short")
    try:
        with safe_open(path, framework="numpy") as file:
            description = json.loads((file.metadata() or {})[key])
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (no mapping)
        yield tensors, description
    except (SafetensorError, KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{path} holds no {what} that can be used: {type(error).__name__}: {error}") from error
