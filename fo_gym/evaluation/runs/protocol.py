"""A protocol: which competitors meet which episodes."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from importlib.resources import files
from pathlib import Path
from typing import Any

from fo_gym.checks import choice, instance, shown, text
from fo_gym.envs.registry import Environment, environment_of
from fo_gym.evaluation.runs.seeds import LEADERBOARD_SEEDS, VALIDATION_SEEDS, first, seeds_for
from fo_gym.friction import law_class
from fo_gym.tasks.variants import VARIANTS
from fo_gym.toml import read_toml

_OPTIONAL = {"robots", "laws"}

SPLITS = {"leaderboard": LEADERBOARD_SEEDS, "validation": VALIDATION_SEEDS}

__all__ = ["Protocol", "load_protocol", "shipped_protocols"]


@dataclass(frozen=True)
class Protocol:
    """What is run. The order of the names is the order of the rows.

    Attributes:
        name: what to call it.
        split: "leaderboard" or "validation", whose seeds are used.
        seeds: episodes of each variant (`seeds_for`).
        environments: registered ids, or "file.py:ID" and "module:ID" of one's own.
        variants: variants of each.
        compensators: registered names, "module:Class", "file.py:Class", or entries: the name of a shipped one, or
            the path of a TOML file. The references `none`, `ideal` and `bound` run always.
        robots: by the names that tables call them, shipped robots or files, on each of which the environments for arms
            run; without any they run on their own.
        laws: friction laws, by the names of `fo_gym.friction.law_class`, under each of which everything is run, with
            the parameters that make them most like the robot's own friction; without any that is as it is.
    """

    name: str
    split: str
    seeds: int
    environments: tuple[str, ...]
    variants: tuple[str, ...]
    compensators: tuple[str, ...]
    robots: Mapping[str, str] = field(default_factory=dict)
    laws: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.seeds, int) or isinstance(self.seeds, bool):
            raise ValueError(f"protocol {self.name!r}: seeds is {shown(self.seeds)}; it must be a whole number")
        text("protocol: name", self.name)
        choice(f"protocol {self.name!r}: split", self.split, SPLITS)
        for value in self.variants:
            if value not in VARIANTS:
                known = ", ".join(VARIANTS)
                raise ValueError(f"protocol {self.name!r}: unknown variant {value!r}; known are {known}")
        for what, names in (
            ("environments", self.environments),
            ("variants", self.variants),
            ("compensators", self.compensators),
        ):
            if not names or not all(isinstance(name, str) for name in names):
                raise ValueError(f"protocol {self.name!r}: {what} is {list(names)}; give at least one name")
        for what in ("environments", "variants", "compensators", "laws"):
            names = getattr(self, what)
            if len(set(names)) != len(names):
                raise ValueError(f"protocol {self.name!r}: {what} {list(names)} names one of them twice; leave one out")
        for law in self.laws:
            _law(self.name, law)
        first(SPLITS[self.split], self.seeds)
        rows = [_environment(self.name, name) for name in self.environments]
        _check_table(f"protocol {self.name!r}: robots", self.robots)
        if self.robots and not any("arm" in row.tags for row in rows):
            raise ValueError(
                f"protocol {self.name!r}: robots are {', '.join(self.robots)}, but {', '.join(self.environments)} take "
                "none; add an environment for arms, such as FJRRegulation-v0, or leave robots out"
            )

    def seeds_of(self, variant: str) -> tuple[int, ...]:
        """The seeds that a variant runs."""
        return seeds_for(variant, SPLITS[self.split], self.seeds)

    @property
    def stamp(self) -> str:
        """Name and hash of the whole protocol; every row of the results carries it."""
        told = {name: value for name, value in asdict(self).items() if name not in _OPTIONAL or value}
        content = json.dumps(told, sort_keys=True).encode()
        return f"{self.name}@{hashlib.sha256(content).hexdigest()[:12]}"


def _environment(protocol: str, name: str) -> Environment:
    try:
        return environment_of(name)
    except ValueError as error:
        raise ValueError(f"protocol {protocol!r}: {error}") from error


def _law(protocol: str, name: str) -> None:
    try:
        law_class(name)
    except ValueError as error:
        raise ValueError(f"protocol {protocol!r}: {error}") from error


def _check_table(what: str, table: Any) -> None:
    """Raise ValueError where it is no table from texts to texts."""
    instance(what, table, Mapping)
    for name, value in table.items():
        text(f"{what}: a name", name)
        text(f"{what}: {shown(name)}", value)


def shipped_protocols() -> dict[str, Path]:
    """The protocols that come with the package, by name."""
    folder = Path(str(files("fo_gym.protocols")))
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def load_protocol(file: str | Path) -> Protocol:
    """Read a protocol: the name of a shipped one, or a TOML file.

    Raises:
        ValueError: there is no such protocol, or a key is missing, unknown or out of range.
    """
    shipped = shipped_protocols()
    path = shipped.get(str(file), Path(file))
    if not os.path.isfile(path):
        raise ValueError(f"there is no protocol {shown(str(file))}; name a TOML file or one of {', '.join(shipped)}")
    content = read_toml("protocol", path)
    allowed = {each.name for each in fields(Protocol)}
    missing, unknown = sorted(allowed - _OPTIONAL - set(content)), sorted(set(content) - allowed)
    if missing or unknown:
        raise ValueError(f"protocol {path}: missing keys {missing}, unknown keys {unknown}")
    for name in ("environments", "variants", "compensators", "laws"):
        if not isinstance(content.get(name, []), list):
            raise ValueError(f"protocol {path}: {name} is {content[name]!r}; it must be a list")
    return Protocol(
        name=content["name"],
        split=content["split"],
        seeds=content["seeds"],
        environments=tuple(content["environments"]),
        variants=tuple(content["variants"]),
        compensators=tuple(content["compensators"]),
        robots=content.get("robots", {}),
        laws=tuple(content.get("laws", [])),
    )
