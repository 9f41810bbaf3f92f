"""The check that every action passes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import real
from fo_gym.compiling import jit

__all__ = ["checked_action"]


def checked_action(
    action: Any, shape: tuple[int, ...], ignored: NDArray[np.bool_] | None = None
) -> NDArray[np.float64]:
    """The action as a contiguous array of float64; zero in the rows that are `ignored`.

    Raises:
        ValueError: the action does not hold real numbers, has another shape than `shape`, or a value is NaN or
            infinite.
    """
    array = real("action", action)
    if array.shape != shape:
        raise ValueError(f"action has shape {array.shape}; this environment takes {shape}")
    if ignored is not None and ignored.any():
        array = np.where(ignored[:, None], 0.0, array)
    if not (array.flags.c_contiguous and array.flags.writeable):
        array = array.copy()  # the compiled functions are compiled for such
    if not _all_finite(array):
        place = np.argwhere(~np.isfinite(array))[0]
        raise ValueError(f"action{place.tolist()} is {array[tuple(place)]}; every value must be finite")
    return array


@jit
def _all_finite(values):
    finite = True
    for value in values.flat:
        finite = finite and math.isfinite(value)
    return finite
