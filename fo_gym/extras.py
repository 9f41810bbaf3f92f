"""Extras: what only some commands need, and how to get it."""

from __future__ import annotations

import json
from importlib.metadata import PackageNotFoundError, distribution

__all__ = ["install_command"]


def install_command(extra: str) -> str:
    """The command that installs an extra of fo-gym: in a clone as the Makefile does it, else from the package's name.

    Args:
        extra: such as "tune", as in pyproject.toml.
    """
    if _is_clone():
        return f".venv/bin/pip install -c constraints.txt -e '.[{extra}]' (in the folder of the clone)"
    return f"pip install 'fo-gym[{extra}]'"


def _is_clone() -> bool:
    """Whether fo-gym was installed in place, from its sources: what pip notes in direct_url.json."""
    try:
        origin = distribution("fo-gym").read_text("direct_url.json")
    except PackageNotFoundError:  # run from the sources, never installed
        return True
    return bool(origin and json.loads(origin).get("dir_info", {}).get("editable"))
