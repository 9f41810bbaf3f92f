"""Writes docs/api.md, the reference of fo_gym, from docstrings.

python docs/api.py
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import is_dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import fo_gym

PAGE = Path(__file__).parent / "api.md"
WIDTH = 100
HEAD = """# Reference

What `import fo_gym` gives, from its docstrings; `python docs/api.py` writes this page. Arrays are (num_envs, dof) where
nothing else is said; units stand in brackets. `help(fo_gym.Robot)` shows the same.
"""
_SECTION = re.compile(r"^(Args|Attributes|Returns|Raises|Yields):$")
_ENTRY = re.compile(r"^    (\*{0,2}\w[\w, ]*): (.*)$")


def markdown(doc: str) -> str:
    """A docstring in Google's style as Markdown: sections become lists, indented equations stay as they are."""
    lines, section = [], ""
    for line in inspect.cleandoc(doc).splitlines():
        if found := _SECTION.match(line):
            section = found[1]
            lines += [f"*{section}*", ""]
        elif section and (entry := _ENTRY.match(line)):
            lines.append(f"* `{entry[1]}`: {entry[2]}")
        elif section:
            lines.append(f"  {line.strip()}" if section in ("Args", "Attributes", "Raises") else line.strip())
            section = section if line.startswith("    ") or not line else ""
        else:
            lines.append(line)
    return "\n".join(line.rstrip() for line in lines)


class _Text:
    """An annotation that shows itself without quotes."""

    def __init__(self, annotation: Any) -> None:
        self._text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)

    def __repr__(self) -> str:
        return self._text


def signature(name: str, thing: Any) -> str:
    """How it is called, a line for each argument where one line is too short."""
    found = inspect.signature(thing)
    parameters = [
        each if each.annotation is each.empty else each.replace(annotation=_Text(each.annotation))
        for each in found.parameters.values()
        if each.name not in ("self", "cls")
    ]
    returned = found.return_annotation
    returned = found.empty if returned in (found.empty, None, "None") else _Text(returned)
    told = found.replace(parameters=parameters, return_annotation=returned)
    whole = f"{name}{told}".replace("<factory>", "...")
    if len(whole) <= WIDTH:
        return whole
    head, _, tail = whole.rpartition(")")
    inside = head.removeprefix(f"{name}(")
    return f"{name}(\n    " + re.sub(r", (?=\*|\w+: |\w+=)", ",\n    ", inside) + f",\n){tail}"


def entries(name: str, thing: Any, level: str = "##") -> Iterator[str]:
    """A class with its public methods and properties, or a function."""
    yield f"{level} {name}"
    if is_dataclass(thing) or inspect.isfunction(thing):
        yield f"```python\n{signature(name, thing)}\n```"
    yield markdown(thing.__doc__ or "")
    for method, value in vars(thing).items() if inspect.isclass(thing) else ():
        if method.startswith("_") or any(hasattr(base, method) for base in thing.__mro__[1:]):
            continue  # what it has from another class is told there
        function = getattr(value, "__func__", value)
        if inspect.isfunction(function):
            yield from entries(f"{name}.{method}", function, "###")
        elif isinstance(value, property) or hasattr(value, "func"):
            yield f"### {name}.{method}\n\n{markdown(value.__doc__ or '')}"


def environments() -> Iterator[str]:
    """What the docstrings of the environments say."""
    for env_id, row in fo_gym.ENVIRONMENTS.items():
        module, _, name = row.entry_point.partition(":")
        doc = inspect.cleandoc(getattr(import_module(module), f"{name}Env").__doc__ or "")
        yield f"## {env_id}\n\n{re.sub('^## ', '### ', doc, flags=re.MULTILINE)}"


def page() -> str:
    """The text of the page."""
    told = [HEAD.strip(), "# Environments", *environments(), "# Classes and functions"]
    for name in fo_gym.__all__:
        thing = getattr(fo_gym, name)
        if inspect.ismodule(thing):
            told += [f"## {name}", markdown(thing.__doc__ or "")]
            told += [part for each in thing.__all__ for part in entries(f"{name}.{each}", getattr(thing, each), "###")]
        elif inspect.isclass(thing) or inspect.isfunction(thing):
            told += entries(name, thing)
    return "\n\n".join(told) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
