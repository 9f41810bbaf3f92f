"""The state of a training between two segments, so that a run which was killed goes on as if it had not been."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from fo_gym.files import draft_of

if TYPE_CHECKING:
    from stable_baselines3.common.base_class import BaseAlgorithm

_BUFFER = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")

__all__ = ["load_checkpoint", "reading", "save_checkpoint"]


def save_checkpoint(path: Path, model: BaseAlgorithm, segments: int) -> None:
    """Write weights, optimizers and replay buffer, whole or not at all.

    Args:
        path: the file.
        model: what is trained.
        segments: how many are done.
    """
    state: dict[str, Any] = {
        "segments": segments,
        "timesteps": model.num_timesteps,
        "updates": getattr(model, "_n_updates"),  # noqa: B009 (private, and the library offers nothing else)
        "parameters": model.get_parameters(),
    }
    buffer = getattr(model, "replay_buffer", None)
    if buffer is not None:
        state["buffer"] = {name: torch.from_numpy(getattr(buffer, name)) for name in _BUFFER}
        state["position"], state["full"] = buffer.pos, buffer.full
    with draft_of(path) as draft:
        torch.save(state, draft)


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """A block that reads a checkpoint: for whatever goes wrong in it, ValueError names the file."""
    try:
        yield
    except Exception as error:
        raise ValueError(f"{path} is no checkpoint that can be used ({error}); remove it to start again") from error


def load_checkpoint(path: Path, model: BaseAlgorithm) -> int:
    """Put the state of `path` into a model that was made alike; returns how many segments are done, 0 without a file.

    Raises:
        ValueError: the file cannot be read. Nothing is unpickled but tensors and numbers.
    """
    if not path.is_file():
        return 0
    with reading(path):
        state = torch.load(path, weights_only=True)
        model.set_parameters(state["parameters"])
    model.num_timesteps = state["timesteps"]
    setattr(model, "_n_updates", state["updates"])  # noqa: B010
    buffer = getattr(model, "replay_buffer", None)
    if buffer is not None:
        for name in _BUFFER:
            np.copyto(getattr(buffer, name), state["buffer"][name].numpy())
        buffer.pos, buffer.full = state["position"], state["full"]
    return int(state["segments"])
