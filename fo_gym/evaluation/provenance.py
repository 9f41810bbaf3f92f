"""What every published row says about how it came about."""

from __future__ import annotations

import platform
from functools import lru_cache
from importlib.metadata import version

PACKAGES = ("fo-gym", "gymnasium", "mujoco", "numba", "numpy", "scipy")

__all__ = ["PACKAGES", "provenance", "versions"]


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Columns `version_*`: the package, what computes, and Python."""
    packages = {f"version_{name.replace('-', '_')}": version(name) for name in PACKAGES}
    return packages | {"version_python": platform.python_version()}


def provenance(protocol: str) -> dict[str, str]:
    """Columns `protocol` (name and hash of what was run, or "" outside a protocol) and `version_*`."""
    return {"protocol": protocol, **versions()}
