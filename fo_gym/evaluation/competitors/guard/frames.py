"""Where a competitor went wrong: the part of a traceback that is its author's."""

from __future__ import annotations

import os
import traceback
from pathlib import Path

from fo_gym.specs import spec_of

_SUITE = Path(__file__).parents[3]

__all__ = ["place_of", "traceback_of"]


def _frames(error: BaseException, spec: str) -> list[traceback.FrameSummary]:
    """The frames of the competitor's code: in its folder, neither of the suite nor of installed packages."""
    file = spec_of(spec)
    home = os.path.dirname(os.path.abspath(file.where)) if file.kind == "file" else os.sep
    found = []
    for frame in traceback.extract_tb(error.__traceback__):
        path = Path(frame.filename)
        if path.is_relative_to(home) and not path.is_relative_to(_SUITE) and "site-packages" not in path.parts:
            found.append(frame)
    return found


def place_of(error: BaseException, spec: str) -> str:
    """Where in the competitor's code it was raised: file, line and function; "" where that is not known."""
    frames = _frames(error, spec)
    return f"{Path(frames[-1].filename).name}, line {frames[-1].lineno}, in {frames[-1].name}" if frames else ""


def traceback_of(error: BaseException, spec: str) -> str:
    """The traceback as Python prints it, of the competitor's frames alone; "" where there are none."""
    frames = _frames(error, spec)
    if not frames and not isinstance(error, SyntaxError):
        return ""
    told = traceback.TracebackException.from_exception(error)
    told.stack = traceback.StackSummary.from_list(frames)
    return "".join(told.format(chain=False)).rstrip()
