"""How results become files: whole or not at all, with the same bytes for the same content."""

from __future__ import annotations

import os
from pathlib import Path

import pandas as pd

__all__ = ["atomic", "csv"]


def atomic(path: Path, text: str) -> None:
    """Write whole or not at all: a reader, or a run that is killed, never leaves half a file."""
    draft = path.with_name(path.name + ".part")
    draft.write_text(text, encoding="utf-8", newline="\n")
    os.replace(draft, path)


def csv(table: pd.DataFrame) -> str:
    """The table as CSV, six digits, without its index."""
    return str(table.to_csv(index=False, float_format="%.6g", lineterminator="\n"))
