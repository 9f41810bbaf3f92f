"""What becomes of memory that a worker has done with."""

from __future__ import annotations

import ctypes
import platform

_M_TRIM_THRESHOLD, _M_MMAP_MAX = -1, -4
_NEVER, _NONE = -1, 0
"""Values of these two: never give memory back, and map no memory for single arrays."""

__all__ = ["keep_freed_memory"]


def keep_freed_memory() -> bool:
    """Let this process keep freed memory and use it again, whatever its size; for a worker, which ends after its work.

    A recording takes up to two gigabytes in a few arrays. glibc asks the kernel for such ones anew each time, which
    then clears every page once more.

    Returns:
        Whether the C library can do that: it must be glibc, see mallopt(3).
    """
    if platform.libc_ver()[0] != "glibc":
        return False
    mallopt = ctypes.CDLL(None).mallopt
    return bool(mallopt(_M_TRIM_THRESHOLD, _NEVER) and mallopt(_M_MMAP_MAX, _NONE))
