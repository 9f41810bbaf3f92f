"""What a competitor consists of, byte by byte: source code, weights and the packages it builds on.

Nothing of a competitor is imported for that: the source is read. Of its modules count

* the module that is named, and whatever it imports of the same package, or from files that no package owns, but not the
  `__init__` of packages that lie merely on the way: else every new module that one of them names would count;
* data: of a module in a package, all files in that package's folder that are no Python source (without sub-packages);
  of a single file, the files and folders beside it that a string in it names.

Of other packages the version counts.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.machinery import ModuleSpec, PathFinder
from importlib.metadata import packages_distributions, version
from pathlib import Path
from typing import Any

from fo_gym.specs import plug_in, spec_of

SUITE = ("fo_gym", "envs_assets")
"""Packages that make up the suite itself: they count through `suite`, not as part of a competitor."""

# Running and scoring; where the process of a stranger's code begins, and what answers there, which are named as text;
# the package itself, which registers the environments by name.
_GUARD = "fo_gym.evaluation.competitors.guard"
_COMPUTES = ("fo_gym.evaluation.runs.trial", f"{_GUARD}.boot", f"{_GUARD}.server", "fo_gym", "envs_assets")
_ENVIRONMENTS = Path(__file__).parents[2] / "envs"
_LONGEST_NAME = 200

__all__ = ["SUITE", "Content", "content_of", "content_of_source", "digest", "suite"]


def digest(content: Any) -> str:
    """SHA-256 of what JSON can hold, in hexadecimal. Mappings are sorted; dates count as their text."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


@dataclass(frozen=True)
class Content:
    """What something consists of.

    Attributes:
        files: SHA-256 of each file by its name inside its package.
        versions: of the other packages that it imports, by name.
    """

    files: Mapping[str, str]
    versions: Mapping[str, str]


@dataclass(frozen=True)
class _Sources:
    """Modules by name with their files, and the foreign packages that they import."""

    files: dict[str, Path]
    foreign: set[str]


def _spec(name: str) -> ModuleSpec | None:
    """Where a module is, found without importing anything; None if it is nowhere."""
    top, *rest = name.split(".")
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):  # ValueError: a module without a spec, such as __main__
        return None
    for part in rest:
        if spec is None or spec.submodule_search_locations is None:
            return None
        top += f".{part}"
        spec = PathFinder.find_spec(top, list(spec.submodule_search_locations))
    return spec


def _file(name: str) -> Path | None:
    spec = _spec(name)
    path = Path(spec.origin) if spec is not None and spec.origin else None
    return path if path is not None and path.is_file() else None


def _tree(path: Path) -> ast.AST:
    """The syntax of a source file; an empty one for what is none, which fails when it is run."""
    try:
        return ast.parse(path.read_bytes() if path.suffix == ".py" else b"")
    except (SyntaxError, ValueError, RecursionError, MemoryError):  # the last two: it is nested too deeply
        return ast.Module([], [])


def _run_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """All nodes that are run: without what stands there for type checkers alone."""
    yield node
    children: Iterable[ast.AST] = ast.iter_child_nodes(node)
    if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
        children = node.orelse
    for child in children:
        yield from _run_nodes(child)


def _imports(path: Path, package: str) -> Iterator[str]:
    """Names of what a file imports, modules or not: `from a import b` may mean a.b."""
    for node in _run_nodes(_tree(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) + 1 - node.level] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            if base:
                yield base
                yield from (f"{base}.{alias.name}" for alias in node.names)


def _follow(start: Iterable[str], follows: Callable[[str], bool]) -> _Sources:
    """The modules of `start` and all that they import, as far as `follows` says so of their top-level package."""
    found = _Sources({}, set())
    waiting, seen = list(start), set()
    while waiting:
        name = waiting.pop()
        top = name.partition(".")[0]
        if name in seen:
            continue
        seen.add(name)
        if not follows(top):
            found.foreign.add(top)
            continue
        path = _file(name)
        if path is not None:
            found.files[name] = path
            waiting += _imports(path, name if path.name == "__init__.py" else name.rpartition(".")[0])
    return found


@cache
def _owners() -> Mapping[str, list[str]]:
    """Installed distributions by the top-level packages that they hold."""
    return packages_distributions()


def _own(root: str) -> Callable[[str], bool]:
    """Whether a top-level package belongs to the same distribution as `root`, or to none, as files of one's own do."""
    mine = set(_owners().get(root, ()))

    def follows(top: str) -> bool:
        if top in sys.stdlib_module_names or (top in SUITE and root not in SUITE):
            return False
        owners = set(_owners().get(top, ()))
        return not owners or bool(owners & mine)

    return follows


def _files_below(folder: Path) -> Iterator[Path]:
    """Data of a package: neither Python source, nor sub-packages, nor what is hidden, nor folders by way of a link."""
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name == "__pycache__":
            continue
        if path.is_dir():
            if not (path / "__init__.py").is_file() and not path.is_symlink():
                yield from _files_below(path)
        elif path.is_file() and path.suffix not in (".py", ".pyc"):
            yield path


def _named_beside(file: Path) -> Iterator[Path]:
    """Files and folders beside a source file that a string in it names."""
    for node in ast.walk(_tree(file)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and 0 < len(node.value) < _LONGEST_NAME:
            path = Path(node.value)
            beside = file.parent / path
            if path.is_absolute() or ".." in path.parts or not path.parts:
                continue
            if beside.is_dir():
                yield from _files_below(beside)
            elif beside.is_file():
                yield beside


def _data(name: str, path: Path) -> dict[str, Path]:
    """Data files of a module, by their name inside its package."""
    in_package = (path.parent / "__init__.py").is_file()
    found = _files_below(path.parent) if in_package else _named_beside(path)
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    return {f"{package.replace('.', '/')}/{data.relative_to(path.parent).as_posix()}": data for data in found}


def _content(sources: _Sources) -> Content:
    paths = dict(sources.files)
    for name, path in sources.files.items():
        paths |= _data(name, path)
    owners = {owner for top in sources.foreign - set(SUITE) for owner in _owners().get(top, ())}
    return Content(
        {label: hashlib.sha256(path.read_bytes()).hexdigest() for label, path in sorted(paths.items())},
        {owner: version(owner) for owner in sorted(owners)},
    )


def content_of(spec: str) -> Content:
    """What a compensator consists of.

    Args:
        spec: a registered name, "module:Class" or "file.py:Class", as `make_compensator` takes it.

    Returns:
        Its files and the versions of the packages that they import; nothing for what cannot be found.
    """
    if module := _module(spec):
        return content_of_source(module)
    named = spec_of(spec)
    if named.kind != "file" or not os.path.isfile(named.where):
        return Content({}, {})
    return content_of_source(named.where)


def content_of_source(source: str) -> Content:
    """What a module, or a file that ends with .py, consists of."""
    if not source.endswith(".py"):
        return _content(_follow([source], _own(source.partition(".")[0])))
    path = Path(source)
    sources = _follow(_imports(path, ""), _own(""))
    sources.files[path.name] = path
    return _content(sources)


def _module(spec: str) -> str:
    """The module that a registered name or "module:Class" is taken from; "" for others."""
    try:
        entry = plug_in(spec)
    except ValueError:  # two plug-ins of one name, which is said when it is made
        return ""
    named = spec_of(spec)
    return entry.module if entry is not None else named.where if named.kind == "module" else ""


@cache
def suite() -> Content:
    """Everything of the suite that decides the rows: whatever running and scoring imports, environments, robots."""
    environments = [f"fo_gym.envs.{path.stem}" for path in sorted(_ENVIRONMENTS.glob("[!_]*.py"))]
    return _content(_follow([*_COMPUTES, *environments], _own(SUITE[0])))
