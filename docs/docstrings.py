"""The project's docstrings for autodoc: plain text in Google's style, which reStructuredText would misread.

What is indented after an empty line is an equation or a program and stays as it is; in all other lines the characters
that are markup (`|v|`, `a * b`, `f_`) are escaped. Names in single backquotes are code.
"""

from __future__ import annotations

import re
from typing import Any

_SECTION = re.compile(r"^(Args|Attributes|Returns|Raises|Yields):$")
_MARKUP = re.compile(r"(`[^`]*`)|([|*\\])|(?<=\w)(_)(?!\w)")


def readable(lines: list[str]) -> list[str]:
    """The docstring as reStructuredText, its sections left to napoleon."""
    out: list[str] = []
    section = literal = False
    for line in lines:
        if line and not line.startswith(" "):
            section, literal = bool(_SECTION.match(line)), False
        elif line.startswith("    ") and not section and not literal and (not out or not out[-1]):
            out += ["::", ""]
            literal = True
        out.append(line if literal else _MARKUP.sub(_escaped, line))
    return out


def _escaped(found: re.Match[str]) -> str:
    code, character, underscore = found.groups()
    return code or f"\\{character or underscore}"


def _process(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    lines[:] = readable(lines)


def setup(app: Any) -> dict[str, bool]:
    """Come before napoleon, which is at 500."""
    app.connect("autodoc-process-docstring", _process, priority=400)
    return {"parallel_read_safe": True}
