"""The check that every action passes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["checked_action"]


def checked_action(
    action: Any, shape: tuple[int, ...], ignored: NDArray[np.bool_] | None = None
) -> NDArray[np.float64]:
    """The action as float64; zero in the rows that are `ignored`.

    Raises:
        ValueError: the action has another shape than `shape`, or a value is NaN or infinite.
    """
    array = np.asarray(action, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"action has shape {array.shape}; this environment takes {shape}")
    if ignored is not None and ignored.any():
        array = np.where(ignored[:, None], 0.0, array)
    if not np.isfinite(array).all():
        raise ValueError(f"action is {array}; every value must be finite")
    return array
