"""Tasks that end the process that runs them, at a chosen moment, for the tests of the backends."""

from __future__ import annotations

import os
import signal
from pathlib import Path


def answer(name: str, folder: str) -> str:
    """The name; but where it is "shot" the process is killed the first time, and where it is "deadly" every time."""
    shot = Path(folder, "shot")
    if name == "deadly" or (name == "shot" and not shot.exists()):
        if name == "shot":
            shot.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return name


def tasks(folder: str) -> list[tuple[str, str]]:
    """One of each, and calm ones around them."""
    return [(name, folder) for name in ("calm", "shot", "deadly", "calm")]


ANSWERS = {0: "calm", 1: "shot", 2: None, 3: "calm"}
"""What comes back: whatever dies once is tried again, and nobody else is lost."""
