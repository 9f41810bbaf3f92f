"""Modules of a user: a file is imported under a name of its own, which a second import of the same file finds again."""

from __future__ import annotations

import hashlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

_PREFIX = "fo_gym_file_"

__all__ = ["file_module", "import_file", "is_of_file", "module_name"]


def module_name(path: Path) -> str:
    """The name under which a file is imported."""
    return f"{_PREFIX}{hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:16]}"


def is_of_file(name: str) -> bool:
    """Whether a module has such a name: no other process can import it by that."""
    return name.startswith(_PREFIX)


def file_module(path: Path) -> ModuleType:
    """The module of a file: as it has been imported, or imported now. Raises as `import_file` does."""
    return sys.modules.get(module_name(path)) or import_file(path)


def import_file(path: Path) -> ModuleType:
    """Import a file; what it raises leaves no module behind. Raises ValueError where it is no Python file."""
    name = module_name(path)
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ValueError(f"{path} is not a Python file")
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module
