"""What a text names: a registered name, a class in a module or a file, an entry; taken apart in one place."""

from __future__ import annotations

import ast
from pathlib import Path

from test_architecture import SOURCES, TREES

from fo_gym.specs import Spec, spec_of

CASES = {
    "pid-high": ("name", "", ""),
    "": ("name", "", ""),
    "mine": ("name", "", ""),
    "mine:": ("name", "", ""),
    ":Mine": ("name", "", ""),
    "./mine:Mine": ("name", "", ""),
    "mine.py:": ("name", "", ""),
    "package.module:Class": ("module", "package.module", "Class"),
    "mine.py:Mine": ("file", "mine.py", "Mine"),
    "../a folder/mine.py:Mine": ("file", "../a folder/mine.py", "Mine"),
    "C:/work/mine.py:Mine": ("file", "C:/work/mine.py", "Mine"),
    "submissions/mine.toml": ("entry", "submissions/mine.toml", ""),
}


def test_a_text_is_taken_apart() -> None:
    found = {text: spec_of(text) for text in CASES}
    assert found == {text: Spec(text, *parts) for text, parts in CASES.items()}  # type: ignore[arg-type]


def test_a_file_is_named_from_elsewhere() -> None:
    assert spec_of("mine.py:Mine").with_file(Path("there") / "mine.py") == "there/mine.py:Mine"


def test_nobody_else_takes_specs_apart() -> None:
    """A spec is split at its colon from the right, whether it names a competitor or an environment."""
    elsewhere = [
        module
        for module in SOURCES
        for node in ast.walk(TREES[module])
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "rpartition"
        if [part.value for part in node.args if isinstance(part, ast.Constant)] == [":"]
    ]
    assert elsewhere == ["fo_gym.specs"]
