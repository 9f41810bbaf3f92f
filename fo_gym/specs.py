"""What a text names as a compensator: a registered name, module:Class, file.py:Class, or an entry (*.toml)."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Literal

from fo_gym.checks import shown, text

GROUP = "fo_gym.compensators"
"""Entry points of compensators: a name, and a class or a function that makes one."""

BUILT_IN = ("none", "ideal", "bound")
"""The references, which the suite makes itself; their names are reserved."""

_OURS = "fo-gym"
"""The distribution whose plug-ins are the project's own."""

__all__ = ["BUILT_IN", "GROUP", "Spec", "check_spec", "is_ours", "list_compensators", "plug_in", "spec_of"]


@dataclass(frozen=True)
class Spec:
    """A text that names a compensator, taken apart. Whether there is such a one shows when it is made.

    Attributes:
        text: as it was given.
        kind: "name", "module", "file" or "entry".
        where: the module, or the path of the file or of the entry; "" of a name.
        attribute: what is taken of module or file; "" of the others.
    """

    text: str
    kind: Literal["name", "module", "file", "entry"]
    where: str = ""
    attribute: str = ""

    def with_file(self, path: Path) -> str:
        """The text that names the same in the file at another path."""
        return f"{path.as_posix()}:{self.attribute}"


def spec_of(given: str) -> Spec:
    """Take a text apart; what is nothing else counts as a name."""
    where, _, attribute = given.rpartition(":")
    if given.endswith(".toml"):
        return Spec(given, "entry", given)
    if attribute and where.endswith(".py"):
        return Spec(given, "file", where, attribute)
    if attribute and where and not where.startswith("."):
        return Spec(given, "module", where, attribute)
    return Spec(given, "name")


def _is_own(entry: EntryPoint) -> bool:
    return entry.dist is not None and entry.dist.name == _OURS


@lru_cache(maxsize=4)
def _registered(read: Callable[..., Iterable[EntryPoint]], path: tuple[str, ...]) -> list[tuple[EntryPoint, bool]]:
    """What is installed in the folders of `path`, and whether it is the project's own.

    It is read once: that takes far longer than to make a compensator.
    """
    return [(entry, _is_own(entry)) for entry in sorted(read(group=GROUP), key=lambda entry: entry.name)]


def _plug_ins() -> dict[str, tuple[EntryPoint, ...]]:
    """Registered names and what each stands for; a name that two plug-ins claim has both, ours nobody else can."""
    found: dict[str, dict[str, EntryPoint]] = {}
    registered = _registered(entry_points, tuple(sys.path))
    ours = {entry.name for entry, own in registered if own}
    for entry, own in registered:
        if entry.name in BUILT_IN or (entry.name in ours and not own):
            warnings.warn(f"plug-in {entry.value!r} is ignored: the name {entry.name!r} is reserved", stacklevel=2)
            continue
        found.setdefault(entry.name, {})[entry.value] = entry
    return {name: tuple(entries.values()) for name, entries in found.items()}


def plug_in(name: str) -> EntryPoint | None:
    """What a plug-in registered under a name, None where none did. Raises ValueError where two different ones did."""
    entries = _plug_ins().get(name, ())
    if len(entries) > 1:
        both = " and ".join(entry.value for entry in entries)
        raise ValueError(f"two plug-ins are called {name!r}: {both}; name one of them as module:Class")
    return entries[0] if entries else None


def list_compensators() -> list[str]:
    """Registered names: the built-in `none`, `ideal` and `bound`, then the plug-ins of `fo_gym.compensators`."""
    return [*BUILT_IN, *_plug_ins()]


def is_ours(given: str) -> bool:
    """Whether a text names the project's own code: a built-in reference, or what its own distribution registered.

    Everything else is a stranger's code, which evaluations run in a process of its own.
    """
    return given in BUILT_IN or any(_is_own(entry) for entry in _plug_ins().get(given, ()))


def check_spec(given: str) -> None:
    """Raise ValueError where no name is registered, or there is no such file; modules are not sought."""
    if text("compensator", given) in list_compensators():
        return
    spec = spec_of(given)
    if spec.kind in ("name", "entry"):
        known = ", ".join(list_compensators())
        raise ValueError(
            f"unknown compensator {shown(given)}; registered are {known}; or name module:Class or file.py:Class"
        )
    if spec.kind == "file" and not os.path.isfile(spec.where):
        raise ValueError(f"compensator {shown(given)}: there is no file {spec.where}; name one that exists")
