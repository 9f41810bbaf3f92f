"""The policy's network in NumPy: scoring needs no torch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SQUASHES = ("clip", "tanh")
"""How the last layer's output becomes an action in [-1, 1]."""

__all__ = ["SQUASHES", "Network"]


@dataclass(frozen=True, eq=False)
class Network:
    """Layers of weights without biases, tanh between them: an odd function, since friction knows no direction.

    Attributes:
        weights: one (inputs, outputs) matrix per layer; the last has one output.
        squash: one of SQUASHES.
    """

    weights: tuple[Array, ...]
    squash: str

    def __post_init__(self) -> None:
        if self.squash not in SQUASHES:
            raise ValueError(f"squash is {self.squash!r}; allowed are {', '.join(map(repr, SQUASHES))}")
        if not self.weights:
            raise ValueError("a network needs at least one layer")
        shapes = [weight.shape for weight in self.weights]
        chained = all(len(shape) == 2 for shape in shapes) and shapes[-1][1] == 1
        if not chained or any(a[1] != b[0] for a, b in pairwise(shapes)):
            raise ValueError(f"layers have shapes {shapes}; each takes what the one before gives, the last gives 1")
        for name, weight in self.tensors().items():
            if not np.isfinite(weight).all():
                raise ValueError(f"{name} has weights that are not finite")

    def __call__(self, inputs: Array) -> Array:
        """Actions in [-1, 1], (...), for inputs (..., n)."""
        hidden = inputs
        for weight in self.weights[:-1]:
            hidden = np.tanh(hidden @ weight)
        output = (hidden @ self.weights[-1])[..., 0]
        return np.tanh(output) if self.squash == "tanh" else np.clip(output, -1.0, 1.0)

    def tensors(self) -> dict[str, NDArray[np.float32]]:
        """The weights by name, as they were trained."""
        # In C order: a file of tensors takes the memory as it lies.
        return {f"layer{i}": weight.astype(np.float32, order="C") for i, weight in enumerate(self.weights)}

    @classmethod
    def from_tensors(cls, tensors: Mapping[str, NDArray[Any]], squash: str, inputs: int) -> Network:
        """The network that `tensors` gave.

        Raises:
            ValueError: names, types or shapes are not those of a network with so many inputs, or a weight is not
                finite.
        """
        names = [f"layer{i}" for i in range(len(tensors))]
        if set(names) != set(tensors):
            raise ValueError(f"tensors are {sorted(tensors)}; expected layer0, layer1, ...")
        for name in names:
            if tensors[name].dtype != np.float32:
                raise ValueError(f"{name} is {tensors[name].dtype}; expected float32")
        weights = tuple(tensors[name].astype(np.float64) for name in names)
        if weights and weights[0].shape[:1] != (inputs,):
            raise ValueError(f"layer0 has shape {weights[0].shape}; this policy has {inputs} inputs")
        return cls(weights, squash)
