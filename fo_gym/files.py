"""How results become files: whole or not at all, with the same bytes for the same content."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pandas as pd

from fo_gym.text import csv_cell, from_csv_cell

__all__ = ["atomic", "csv", "draft_of", "read_csv"]


@contextmanager
def draft_of(path: Path) -> Iterator[Path]:
    """A file beside `path` to write into, which takes its place at the end.

    A reader, or a run that is killed, never meets half a file. The ending stays: it tells writers of figures what to
    write.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        yield draft
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)


def atomic(path: Path, content: str | bytes) -> None:
    """Write text (with plain line ends) or bytes, whole or not at all."""
    with draft_of(path) as draft:
        draft.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)


def csv(table: pd.DataFrame) -> str:
    """The table as CSV, numbers with six digits, texts as `csv_cell` makes them, without its index."""
    texts = table.select_dtypes(exclude="number").astype(object)
    safe = {str(name): values for name, values in texts.map(_if_text(csv_cell)).items()}
    return str(table.assign(**safe).to_csv(index=False, float_format="%.6g", lineterminator="\n"))


def read_csv(text: str, *, numbers: bool = True) -> pd.DataFrame:
    """The table from which `csv` made this text.

    Args:
        text: content of a file.
        numbers: columns of numbers become numbers, and empty cells NaN; otherwise every cell is its text.
    """
    how: dict[str, Any] = {"na_values": [""]} if numbers else {"dtype": str}
    table: pd.DataFrame = pd.read_csv(io.StringIO(text), keep_default_na=False, **how)
    return table.map(_if_text(from_csv_cell))


def _if_text(change: Callable[[str], str]) -> Callable[[Any], Any]:
    return lambda value: change(value) if isinstance(value, str) else value
