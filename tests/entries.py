"""A stranger's entry and the file that it names, for the tests of entries and of what they consist of."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

ENTRY = """
name = "tuned"
spec = "mine.py:Mine"
authors = ["A. Author", "B. Author"]
link = "https://example.org/paper"

[gains]
L = 80.0

[[sets]]
env = "FJRSquare-v0"
variant = "randomized"
gains = { L = 60.0 }
"""
MINE = """
from baselines import LeTienObserver


class Mine(LeTienObserver):
    pass
"""
Write = Callable[..., Path]


def write_files(folder: Path, **contents: str) -> Path:
    """Write files into a folder, their names with _ for the dot, and name the first."""
    paths = [folder / name.replace("_", ".") for name in contents]
    for path, content in zip(paths, contents.values(), strict=True):
        path.write_text(content, encoding="utf-8")
    return paths[0]
