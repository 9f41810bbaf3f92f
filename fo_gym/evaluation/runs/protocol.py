"""A protocol: which competitors meet which episodes."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import asdict, dataclass, fields
from importlib.resources import files
from pathlib import Path

from fo_gym.checks import choice, shown, text
from fo_gym.envs.registry import known_environments
from fo_gym.evaluation.runs.seeds import LEADERBOARD_SEEDS, VALIDATION_SEEDS, first, seeds_for
from fo_gym.tasks.variants import VARIANTS
from fo_gym.toml import read_toml

SPLITS = {"leaderboard": LEADERBOARD_SEEDS, "validation": VALIDATION_SEEDS}

__all__ = ["Protocol", "load_protocol", "shipped_protocols"]


@dataclass(frozen=True)
class Protocol:
    """What is run. The order of the names is the order of the rows.

    Attributes:
        name: what to call it.
        split: "leaderboard" or "validation", whose seeds are used.
        seeds: episodes of each variant; of one without randomness a single one is run (`seeds_for`).
        environments: registered ids.
        variants: variants of each.
        compensators: registered names, "module:Class", "file.py:Class", or entries: the name of a shipped one, or
            the path of a TOML file. `none` and `ideal` run always.
    """

    name: str
    split: str
    seeds: int
    environments: tuple[str, ...]
    variants: tuple[str, ...]
    compensators: tuple[str, ...]

    def __post_init__(self) -> None:
        if not isinstance(self.seeds, int) or isinstance(self.seeds, bool):
            raise ValueError(f"protocol {self.name!r}: seeds is {shown(self.seeds)}; it must be a whole number")
        text("protocol: name", self.name)
        choice(f"protocol {self.name!r}: split", self.split, SPLITS)
        for what, values, allowed in (
            ("environment", self.environments, known_environments()),
            ("variant", self.variants, VARIANTS),
        ):
            for value in values:
                if value not in allowed:
                    raise ValueError(
                        f"protocol {self.name!r}: unknown {what} {value!r}; known are {', '.join(allowed)}"
                    )
        for what, names in (
            ("environments", self.environments),
            ("variants", self.variants),
            ("compensators", self.compensators),
        ):
            if not names or not all(isinstance(name, str) for name in names):
                raise ValueError(f"protocol {self.name!r}: {what} is {list(names)}; give at least one name")
            if len(set(names)) != len(names):
                raise ValueError(f"protocol {self.name!r}: {what} {list(names)} names one of them twice; leave one out")
        first(SPLITS[self.split], self.seeds)

    def seeds_of(self, variant: str) -> tuple[int, ...]:
        """The seeds that a variant runs."""
        return seeds_for(variant, SPLITS[self.split], self.seeds)

    @property
    def stamp(self) -> str:
        """Name and hash of the whole protocol; every row of the results carries it."""
        content = json.dumps(asdict(self), sort_keys=True).encode()
        return f"{self.name}@{hashlib.sha256(content).hexdigest()[:12]}"


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
    expected = {field.name for field in fields(Protocol)}
    if set(content) != expected:
        missing, unknown = sorted(expected - set(content)), sorted(set(content) - expected)
        raise ValueError(f"protocol {path}: missing keys {missing}, unknown keys {unknown}")
    for name in ("environments", "variants", "compensators"):
        if not isinstance(content[name], list):
            raise ValueError(f"protocol {path}: {name} is {content[name]!r}; it must be a list")
    return Protocol(
        name=content["name"],
        split=content["split"],
        seeds=content["seeds"],
        environments=tuple(content["environments"]),
        variants=tuple(content["variants"]),
        compensators=tuple(content["compensators"]),
    )
