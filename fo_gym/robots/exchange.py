"""robot.toml: a robot's numbers, each with its unit and where it is from, beside the name of its file."""

from __future__ import annotations

import os
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

import tomlkit

from fo_gym.checks import shown, text
from fo_gym.friction import LuGre, law_class, law_name
from fo_gym.hardware import Hardware
from fo_gym.parameters import FlexibleJoint, ImpedanceGains, PDGains
from fo_gym.robots.file import existing_file
from fo_gym.robots.quantities import read_parts, read_quantity, table_of
from fo_gym.toml import read_toml

_PARTS: dict[str, type] = {
    "flexible": FlexibleJoint,
    "friction": LuGre,
    "identified": LuGre,
    "pd_gains": PDGains,
    "impedance_gains": ImpedanceGains,
    "hardware": Hardware,
}
"""Tables of the file that are parameters; of the first two any part may be missing, and is designed then."""

_PARTIAL = ("flexible", "friction")

_USUAL = LuGre.__name__
"""The law of friction that is not named."""

_KEYS = ("name", "file", "package", "joints", "tool", "camera", "home", "redundant", "units", "frozen", *_PARTS)

NO_TOOL = ""
"""The tool of a robot that has none; one that is not named at all is the end of the longest chain."""

__all__ = ["NO_TOOL", "read_robot", "robot_text"]


def robot_text(fields: dict[str, Any], folder: Path) -> str:
    """The text of the robot.toml, to lie in `folder`, of a robot with these fields (vars of a `Robot`)."""
    side, units, sources = fields["link_side"], fields["units"], dict(fields["sources"])
    file = Path(side.file).absolute()
    try:
        relative = Path(os.path.relpath(file, folder.absolute()))
    except ValueError:  # another drive
        relative = file
    content: dict[str, Any] = {"name": fields["name"], "file": relative.as_posix(), "joints": list(side.joints)}
    content["units"] = list(units)
    content["tool"] = side.tool or NO_TOOL
    content |= {} if side.camera is None else {"camera": side.camera}
    content["home"] = fields["home"].tolist()
    content["redundant"] = list(fields["redundant"])
    content["frozen"] = dict(side.frozen)
    for name in _PARTS:
        if fields[name] is not None:
            law = law_name(type(fields[name])) if name == "friction" else _USUAL
            content[name] = ({} if law == _USUAL else {"law": law}) | table_of(name, fields[name], units, sources)
    document = tomlkit.document()
    document.add(tomlkit.comment("A robot of fo-gym: its file, and its numbers with their units and sources."))
    document.update(content)
    return tomlkit.dumps(document)


def read_robot(path: Path) -> dict[str, Any]:
    """What a robot.toml says.

    Returns:
        "name"; "file" as a path; "joints", "tool", "camera", "home", "redundant", "frozen" or None each; "known": the
        numbers of `flexible` and of LuGre's that there are, by name; "friction", of another law, as an object, as its
        class where there are no numbers of it, or None; the other parts as objects, or None; "sources".

    Raises:
        FileNotFoundError: the robot's file is not there, or not the package that has it.
        ValueError: the file is no robot.toml; what is wrong is named.
    """
    data = read_toml("robot", existing_file("robot", path))
    unknown = sorted(set(data) - set(_KEYS))
    if unknown or "file" not in data:
        what = f"there is {shown(unknown)}" if unknown else "there is no file ="
        raise ValueError(f"robot {path}: {what}; it has {', '.join(_KEYS)}")
    try:
        return _read(data, path)
    except ValueError as error:
        raise ValueError(f"robot {path}: {error}") from None


def _read(data: dict[str, Any], path: Path) -> dict[str, Any]:
    units = _units(data)
    said: dict[str, Any] = {key: data.get(key) for key in ("joints", "tool", "camera", "home", "redundant")}
    frozen = data.get("frozen")
    if frozen is not None:
        if not isinstance(frozen, dict) or not all(isinstance(value, int | float) for value in frozen.values()):
            raise ValueError(f"frozen is {shown(frozen)}; give a table of joints and positions")
        frozen = tuple((name, float(value)) for name, value in frozen.items())
    known: dict[str, Any] = {}
    friction, rubs = _law(data, units)
    for part in _PARTIAL:
        table = rubs if part == "friction" else data.get(part, {})
        allowed = [name for name, _ in _fields(_PARTS[part])]
        if not isinstance(table, dict) or not set(table) <= set(allowed):
            raise ValueError(f"{part} is {shown(table)}; it has {', '.join(allowed)}")
        known |= {name: read_quantity(f"{part}.{name}", value, units) for name, value in table.items()}
    others = {
        name: read_parts(kind, name, data[name], units) if name in data else None
        for name, kind in _PARTS.items()
        if name not in _PARTIAL
    }
    return {
        "name": text("name", data.get("name", path.stem)),
        "file": _file(data, path),
        **said,
        "frozen": frozen,
        "known": known,
        "friction": friction,
        **others,
        "sources": dict(_sources("", {name: data[name] for name in _PARTS if name in data})),
    }


def _law(data: dict[str, Any], units: tuple[str, ...]) -> tuple[Any, Any]:
    """Friction of another law than LuGre, its class, or None; and the table of LuGre's numbers that are known."""
    table = data.get("friction", {})
    if not isinstance(table, dict):
        return None, table
    numbers = {name: value for name, value in table.items() if name != "law"}
    if table.get("law", _USUAL) == _USUAL:
        return None, numbers
    kind = law_class(table["law"])
    friction = read_parts(kind, "friction", numbers, units) if numbers else kind
    return friction, {name: numbers[name] for name, _ in _fields(LuGre) if name in numbers}


def _fields(kind: type) -> list[tuple[str, Any]]:
    return list(kind.__annotations__.items())


def _units(data: dict[str, Any]) -> tuple[str, ...]:
    units = data.get("units", ["rad"])
    if not isinstance(units, list) or not units or not set(map(str, units)) <= {"rad", "m"}:
        raise ValueError(f'units is {shown(units)}; give "rad" or "m" for each joint')
    return tuple(units)


def _sources(path: str, table: dict[str, Any]) -> list[tuple[str, str]]:
    found = []
    for name, inner in table.items():
        if isinstance(inner, dict) and "value" in inner:
            found += [(f"{path}{name}", inner["source"])] if inner.get("source") else []
        elif isinstance(inner, dict):
            found += _sources(f"{path}{name}.", inner)
    return found


def _file(data: dict[str, Any], path: Path) -> Path:
    """The robot's file: beside the toml, or in an installed package, which is not imported."""
    name, package = text("file", data["file"]), data.get("package")
    if package is None:
        return existing_file("robot file", os.path.normpath(path.absolute().parent / name))
    try:
        found = Path(str(distribution(text("package", package)).locate_file(name)))
    except PackageNotFoundError:
        raise FileNotFoundError(
            f"robot {path}: its file {name} comes with the package {package}, which is not installed; "
            f"pip install {package}"
        ) from None
    if not found.is_file():
        version = distribution(package).version
        raise FileNotFoundError(f"robot {path}: package {package} {version} has no file {name}; try another version")
    return found
