"""Entries: TOML files that name a compensator, who made it, and its gains.

name = "mine"                        # optional; the name of the file by default
spec = "mine.py:Mine"                # a registered name, module:Class, or file.py:Class beside the entry
authors = ["A. Author"]
link = "https://example.org/paper"   # or ""

[gains]                              # optional; keyword arguments of the compensator
L = 80.0
weights = "mine.npz"                 # a text that names a file beside the entry stands for that file

[[sets]]                             # optional; gains that replace those above on one environment and variant
env = "FJRSquare-v0"
variant = "randomized"
gains = { L = 60.0 }
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from fo_gym.checks import shown
from fo_gym.envs.registry import known_environments
from fo_gym.evaluation.competitors.competitor import BASELINE, REFERENCE, SUBMISSION, YOURS, Competitor, Gains
from fo_gym.specs import BUILT_IN, is_ours, spec_of
from fo_gym.tasks.variants import VARIANTS
from fo_gym.text import one_line
from fo_gym.toml import read_toml

_NEEDED, _ALLOWED = ("spec", "authors", "link"), ("name", "gains", "sets")
_LONGEST_NAME = 100
_WORDS: Mapping[type, str] = {str: "text", list: "list", dict: "table"}

__all__ = [
    "check_authors",
    "check_name",
    "check_names",
    "competitor_of",
    "handed_over",
    "load_entry",
    "shipped_entries",
    "submissions_in",
]


def shipped_entries() -> dict[str, Path]:
    """The entries that come with the package, by the name of their file."""
    folder = Path(str(files("fo_gym.protocols"))) / "tuned"
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def competitor_of(text: str) -> Competitor:
    """The competitor that a name means.

    Args:
        text: a shipped entry, the path of an entry (*.toml), a registered compensator, "module:Class" or
            "file.py:Class". Whether there is such a compensator shows when it is made.

    Raises:
        ValueError: an entry cannot be read or is not allowed.
    """
    shipped = shipped_entries()
    if text in shipped or spec_of(text).kind == "entry":
        return load_entry(shipped.get(text, Path(text)))
    return Competitor(text, text, REFERENCE if text in BUILT_IN else BASELINE)


def handed_over(text: str, gains: Gains, name: str | None = None) -> Competitor:
    """What a user hands over to be scored beside others: the same as `competitor_of`, with gains and a name.

    Args:
        text: as `competitor_of` takes it.
        gains: replace its own.
        name: what to call it; by default its own name and those gains.

    Returns:
        The competitor, with the origin "yours" where it is not one that the project ships as it is.

    Raises:
        ValueError: an entry cannot be read or is not allowed, or the name is not, or it is for a reference.
    """
    if name is not None and text in BUILT_IN:
        raise ValueError(f"--name is {name!r}; the reference {text} keeps its own: leave --name out")
    found = competitor_of(text)
    if gains:
        found = found.with_gains(gains)
    elif not (text in shipped_entries() or is_ours(text)):
        found = replace(found, origin=YOURS)
    return found if name is None else replace(found, name=check_name("--name", name))


def submissions_in(folder: Path) -> tuple[Competitor, ...]:
    """The entries *.toml of a folder, by the name of their file. Raises ValueError for one that is not allowed."""
    if not os.path.isdir(folder):
        raise ValueError(f"there is no folder {folder}; name one with entries *.toml")
    return tuple(replace(load_entry(path), origin=SUBMISSION) for path in sorted(folder.glob("*.toml")))


def check_names(competitors: Iterable[Competitor]) -> None:
    """Raise ValueError where two competitors have the same name, as files show it, whatever the case."""
    seen: dict[str, Competitor] = {}
    for each in competitors:
        shown = one_line(each.name).casefold()
        if shown in seen:
            raise ValueError(
                f"two competitors are called {each.name!r}: {seen[shown].spec} and {each.spec}; "
                "give one of them another name (the key 'name' of its entry)"
            )
        seen[shown] = each


def load_entry(path: Path) -> Competitor:
    """Read an entry (see the head of this module).

    Raises:
        ValueError: there is no such file, or a key is missing, unknown or not what it must be; it names file and key.
    """
    if not os.path.isfile(path):
        raise ValueError(f"there is no entry {path}; shipped ones are {', '.join(shipped_entries()) or 'none'}")
    content = read_toml("entry", path)
    _check_keys(path, "", content, _NEEDED, _ALLOWED)
    for key, kind in (("spec", str), ("link", str), ("name", str), ("authors", list), ("gains", dict), ("sets", list)):
        if not isinstance(content.get(key, kind()), kind):
            raise ValueError(f"entry {path}: {key} is {content[key]!r}; it must be a {_WORDS[kind]}")
    authors = check_authors(f"entry {path}: authors", content["authors"])
    link = content["link"]
    if link and not re.fullmatch(r"https?://[!#-;=?-Z_a-z~]+", link):
        raise ValueError(f'entry {path}: link is {link!r}; give an address https://..., or ""')
    return Competitor(
        name=check_name(f"entry {path}: name", content.get("name", path.stem)),
        spec=_spec(path, content["spec"]),
        gains=_gains(path, content.get("gains", {})),
        sets=_sets(path, content.get("sets", [])),
        authors=authors,
        link=link,
    )


def _check_keys(
    path: Path, where: str, table: Mapping[str, Any], needed: Iterable[str], allowed: Iterable[str]
) -> None:
    missing = [key for key in needed if key not in table]
    unknown = [key for key in table if key not in (*needed, *allowed)]
    if missing or unknown:
        besides = f", and may have {', '.join(allowed)}" if allowed else ""
        raise ValueError(
            f"entry {path}: {where}missing keys {missing}, unknown keys {unknown}; "
            f"it needs {', '.join(needed)}{besides}"
        )


def check_name(what: str, name: str) -> str:
    """A name that tables and files can bear. Raises ValueError for another one; `what` says where it stands."""
    if name.casefold() in BUILT_IN or len(name) > _LONGEST_NAME or not re.fullmatch(r"\w[\w.+-]*( [\w.+-]+)*", name):
        raise ValueError(
            f"{what} is {shown(name)}; give letters, digits and . _ + - with single spaces between, a letter or digit "
            f"first, at most {_LONGEST_NAME} of them, and neither of the references {', '.join(BUILT_IN)}"
        )
    return name


def check_authors(what: str, authors: Sequence[object]) -> tuple[str, ...]:
    """Those who made it. Raises ValueError where there is none, or one is not a line of text."""
    names = tuple(author for author in authors if isinstance(author, str) and author.strip() and author.isprintable())
    if not names or len(names) < len(authors):
        raise ValueError(f"{what} is {list(authors)!r}; give at least one name, each a line of text")
    return names


def _spec(path: Path, spec: str) -> str:
    """The spec, with a file as seen from here instead of from the entry."""
    if spec in BUILT_IN or not spec:
        raise ValueError(f"entry {path}: spec is {spec!r}; name a compensator of your own, not a reference")
    named = spec_of(spec)
    return named.with_file(path.parent / named.where) if named.kind == "file" else spec


def _gains(path: Path, gains: Mapping[str, Any]) -> Gains:
    """The gains, with a file beside the entry as seen from here."""
    return {key: _beside(path, value) if isinstance(value, str) else value for key, value in gains.items()}


def _beside(path: Path, value: str) -> str:
    return str(path.parent / value) if value and os.path.isfile(path.parent / value) else value


def _sets(path: Path, tables: list[Any]) -> dict[tuple[str, str], Gains]:
    found: dict[tuple[str, str], Gains] = {}
    allowed = {"env": known_environments(), "variant": VARIANTS}
    for number, table in enumerate(tables, start=1):
        where = f"set {number}: "
        if not isinstance(table, dict):
            raise ValueError(f"entry {path}: {where}it is {table!r}; write [[sets]] with env, variant and gains")
        _check_keys(path, where, table, ("env", "variant", "gains"), ())
        for key, values in allowed.items():
            if table[key] not in values:
                raise ValueError(f"entry {path}: {where}{key} is {table[key]!r}; allowed are {', '.join(values)}")
        if not isinstance(table["gains"], dict):
            raise ValueError(f"entry {path}: {where}gains is {table['gains']!r}; it must be a table")
        if (table["env"], table["variant"]) in found:
            raise ValueError(f"entry {path}: {where}{table['env']} {table['variant']} is there twice; keep one")
        found[table["env"], table["variant"]] = _gains(path, table["gains"])
    return found
