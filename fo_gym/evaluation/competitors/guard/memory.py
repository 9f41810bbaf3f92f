"""The memory that both processes see: the observations of a tick, then its estimates.

The suite's side reads and writes it as a file, without mapping it: whatever the other side does to it, also shrinking
it, ends in a short read; and what is read is a copy, which is checked and used as it is.
"""

from __future__ import annotations

import mmap
import os
import tempfile

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["create", "take", "views"]


def create() -> int:
    """A file descriptor of memory without a name; where the system has none, of a file without a name."""
    if hasattr(os, "memfd_create"):
        return os.memfd_create("fo-gym")
    file, name = tempfile.mkstemp()
    os.unlink(name)
    return file


def take(file: int, shape: tuple[int, ...], offset: int) -> Array | None:
    """A copy of the array of that shape at `offset` [bytes]; None where there is less."""
    values = np.empty(shape)
    count = os.preadv(file, [values.data], offset)
    return values if count == values.nbytes else None


def views(file: int, observations: tuple[int, int], estimates: tuple[int, int]) -> tuple[Array, Array]:
    """Both arrays, mapped into this process."""
    first, count = int(np.prod(observations)), int(np.prod(observations) + np.prod(estimates))
    values = np.frombuffer(mmap.mmap(file, 8 * count), np.float64)
    return values[:first].reshape(observations), values[first:].reshape(estimates)
