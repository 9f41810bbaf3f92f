"""Where the project's documentation is read, as the installed package says."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, metadata

__all__ = ["documentation"]


def documentation() -> str:
    """Its address, without a slash at its end; "" where the package names none, as one installed from a clone does."""
    try:
        named = metadata("fo-gym").get_all("Project-URL") or []
    except PackageNotFoundError:  # run from the sources, never installed
        named = []
    addresses = dict(line.split(", ", 1) for line in named)
    return addresses.get("Documentation", "").rstrip("/")
