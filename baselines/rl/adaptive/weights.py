"""What was learned: how much a row says, how much all rows are trusted, and what was to be expected."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baselines.rl.adaptive.rows import COLUMNS, INPUTS

Array = NDArray[np.float64]

SUMMARY = ("left", "total", "weight", "both sides", "one-sidedness", "zero's unit")
"""What the trust in all rows may depend on, see `Memory.trust`."""
HIDDEN, TRUST_HIDDEN = 16, 8
LOG_WEIGHT = (-8.0, 4.0)
"""Bounds of the logarithm of a row's weight."""

__all__ = ["HIDDEN", "LOG_WEIGHT", "SHAPES", "SUMMARY", "TRUST_HIDDEN", "Weights"]

SHAPES = {
    "row_in": (len(INPUTS), HIDDEN),
    "row_bias": (HIDDEN,),
    "row_out": (HIDDEN,),
    "row_level": (1,),
    "trust_in": (len(SUMMARY), TRUST_HIDDEN),
    "trust_bias": (TRUST_HIDDEN,),
    "trust_out": (TRUST_HIDDEN,),
    "trust_level": (1,),
    "mean": (COLUMNS - 2,),
    "precision": (COLUMNS + 2,),
    "odds": (2,),
}
"""Of the tensors, by name."""


@dataclass(frozen=True, eq=False)
class Weights:
    """Two small networks with one hidden layer (tanh) each, and what was to be expected.

    Attributes:
        row_in, row_bias, row_out, row_level: of the network that gives the logarithm of a row's weight.
        trust_in, trust_bias, trust_out, trust_level: of the one that gives the logarithm of the trust in all rows.
        mean: of friction's coefficients before anything was seen: columns of a row but zero's and inertia's, which
            are as likely above as below 0.
        precision: logarithms of one over the variances of all coefficients: columns of a row, then sine and cosine of
            the ripple.
        odds: that there is anything but friction: their logarithm before anything was seen, and the logarithm of the
            factor on the evidence that is added to it, see `Memory`.
    """

    row_in: Array
    row_bias: Array
    row_out: Array
    row_level: Array
    trust_in: Array
    trust_bias: Array
    trust_out: Array
    trust_level: Array
    mean: Array
    precision: Array
    odds: Array

    def __post_init__(self) -> None:
        for name, shape in SHAPES.items():
            value = getattr(self, name)
            if value.shape != shape:
                raise ValueError(f"{name} has shape {value.shape}; expected {shape}")
            if not np.isfinite(value).all():
                raise ValueError(f"{name} has weights that are not finite")

    def weight(self, inputs: Array) -> Array:
        """Of rows with these inputs (..., len(INPUTS)), above 0."""
        hidden = np.tanh(inputs @ self.row_in + self.row_bias)
        return np.asarray(np.exp(np.clip(hidden @ self.row_out + self.row_level, *LOG_WEIGHT)))

    def trust(self, summary: Array) -> Array:
        """In all rows of joints with this summary (..., len(SUMMARY)), above 0."""
        hidden = np.tanh(summary @ self.trust_in + self.trust_bias)
        return np.asarray(np.exp(np.clip(hidden @ self.trust_out + self.trust_level, -20.0, 20.0)))

    def share(self, evidence: Array) -> Array:
        """Of a correction that is made, by the evidence that there is anything but friction, 0 to 1."""
        level, factor = self.odds
        return np.asarray(1.0 / (1.0 + np.exp(-np.clip(level + np.exp(factor) * evidence, -30.0, 30.0))))

    def tensors(self) -> dict[str, NDArray[np.float32]]:
        """The weights by name, as they were trained."""
        return {each.name: getattr(self, each.name).astype(np.float32, order="C") for each in fields(self)}

    @classmethod
    def from_tensors(cls, tensors: Mapping[str, NDArray[Any]]) -> Weights:
        """What `tensors` gave.

        Raises:
            ValueError: names, types or shapes are others, or a weight is not finite.
        """
        if set(tensors) != set(SHAPES):
            raise ValueError(f"tensors are {sorted(tensors)}; expected {sorted(SHAPES)}")
        for name, value in tensors.items():
            if value.dtype != np.float32:
                raise ValueError(f"{name} is {value.dtype}; expected float32")
        return cls(**{name: value.astype(np.float64) for name, value in tensors.items()})
