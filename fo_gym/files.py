"""How results become files: whole or not at all, with the same bytes for the same content."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pandas as pd

__all__ = ["atomic", "csv", "draft_of"]


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
    """The table as CSV, six digits, without its index."""
    return str(table.to_csv(index=False, float_format="%.6g", lineterminator="\n"))
