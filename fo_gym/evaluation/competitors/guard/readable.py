"""Which files a competitor's process may read."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fo_gym.specs import spec_of

_SYSTEM = (
    *("/usr", "/lib", "/lib32", "/lib64", "/bin", "/nix/store", "/sys/devices/system"),
    *("/proc/self", "/proc/cpuinfo", "/proc/meminfo", "/proc/stat"),
    *("/dev/zero", "/dev/random", "/dev/urandom"),
    *("/etc/ld.so.cache", "/etc/localtime", "/etc/nsswitch.conf", "/etc/passwd"),
)
"""What Python and its libraries read besides their own folders. /proc/self is that of the process that opens it."""

__all__ = ["readable"]


def readable(spec: str, gains: Mapping[str, Any]) -> list[str]:
    """Files and folders: the system's, Python's, where it imports from, the competitor's own, files among its gains.

    Args:
        spec: as `make_compensator` takes it.
        gains: keyword arguments of the compensator.
    """
    file = spec_of(spec)
    own = [str(Path(file.where).parent)] if file.kind == "file" else []
    named = [value for value in gains.values() if isinstance(value, str) and os.path.isfile(value)]
    pythons = {sys.prefix, sys.base_prefix, sys.exec_prefix, sys.base_exec_prefix}
    libraries = [path for path in os.environ.get("LD_LIBRARY_PATH", "").split(":") if path]
    return [*_SYSTEM, *sorted(pythons), *map(os.path.abspath, sys.path), *libraries, *own, *named]
