"""Reading TOML, the format of protocols, entries and robots."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

__all__ = ["read_toml"]


def read_toml(what: str, path: Path) -> dict[str, Any]:
    """The content of a TOML file. Raises ValueError where it cannot be read, naming it as `what`."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError, OSError) as error:
        raise ValueError(f"{what} {path}: {error}; give a text file in TOML") from error
