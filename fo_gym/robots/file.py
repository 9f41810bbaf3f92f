"""A robot's file, MJCF or URDF, becomes MuJoCo's editable model; what is broken is told in one line."""

from __future__ import annotations

import os
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import mujoco

from fo_gym.checks import shown
from fo_gym.robots.log import keep_off_disk
from fo_gym.robots.report import Notes
from fo_gym.robots.urdf import urdf_for_mujoco
from fo_gym.text import one_line

MAX_BYTES = 50_000_000
"""Size of a file at most, without its meshes; those of whole humanoids have less than one megabyte."""

_REMEDIES = {
    "mjMINVAL": "give the body an <inertial>, or geoms, with a mass and an inertia above 0",
    "Error opening file": "put the file where it is looked for, or take its name out",
    "positive eigenvalues": "give the body an inertia that is above 0 about every axis",
    "unknown plugin": "take the plugin out, or load its library first",
}
"""What to do about some of the things that MuJoCo says."""

__all__ = ["MAX_BYTES", "existing_file", "mujoco_errors", "read_spec"]

keep_off_disk()


@contextmanager
def mujoco_errors(file: Path, doing: str) -> Iterator[None]:
    """Have what MuJoCo says of a file told as a ValueError in one line, naming the file.

    Args:
        file: what is read.
        doing: what MuJoCo cannot do, such as "read it".
    """
    try:
        with warnings.catch_warnings():  # of attributes that MuJoCo will not read one day
            warnings.simplefilter("ignore")
            yield
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        told = one_line(" ".join(str(error).split()), 300)
        remedy = next((remedy for part, remedy in _REMEDIES.items() if part in told), "mend the file there")
        raise ValueError(f"{file}: MuJoCo cannot {doing}: {told}; {remedy}") from None


def existing_file(name: str, value: Any) -> Path:
    """The value as the absolute path of a file.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: the value is no path, or that of a folder.
    """
    if not isinstance(value, str | os.PathLike) or not str(value) or "\0" in str(value):
        raise ValueError(f"{name} is {shown(value)}; give the path of an MJCF (.xml) or URDF (.urdf) file")
    path = Path(value)
    try:
        if path.is_dir():
            raise ValueError(f"{name} {path} is a folder; give the MJCF (.xml) or URDF (.urdf) file in it")
        if not path.is_file():
            raise FileNotFoundError(f"{name} {one_line(str(path), 300)} does not exist; give the path of a file")
    except OSError as error:  # names too long, loops of links
        if isinstance(error, FileNotFoundError):
            raise
        raise ValueError(f"{name} {one_line(str(path), 300)} cannot be opened: {error.strerror}") from None
    return path.absolute()


def _root(file: Path) -> str:
    """Name of the outermost element."""
    size = file.stat().st_size
    if size == 0:
        raise ValueError(f"{file} is empty; give an MJCF or URDF file")
    if size > MAX_BYTES:
        raise ValueError(f"{file} has {size} bytes; a robot's file has at most {MAX_BYTES}, its meshes apart")
    try:
        with file.open("rb") as stream:
            for _, element in ET.iterparse(stream, events=("start",)):
                return element.tag
    except (ET.ParseError, ValueError, LookupError) as error:
        raise ValueError(f"{file} is no XML: {one_line(str(error), 200)}; give an MJCF or URDF file") from None
    except OSError as error:
        raise ValueError(f"{file} cannot be read: {error.strerror}") from None
    raise ValueError(f"{file} has no element; give an MJCF or URDF file")


def read_spec(file: Path, notes: Notes) -> mujoco.MjSpec:
    """Read an MJCF or URDF file; unnamed joints and bodies get names.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it is none that MuJoCo reads.
    """
    file = existing_file("robot file", file)
    root = _root(file)
    if root == "mujoco":
        with mujoco_errors(file, "read it"):
            spec = mujoco.MjSpec.from_file(str(file))
    elif root == "robot":
        text = urdf_for_mujoco(file, notes)
        with mujoco_errors(file, "read it"):
            spec = mujoco.MjSpec.from_string(text)
    else:
        raise ValueError(
            f"{file}: its outermost element is <{one_line(root, 60)}>; it must be <mujoco> (MJCF) or <robot> (URDF)"
        )
    _name("body", spec.bodies, notes)
    _name("joint", spec.joints, notes)
    return spec


def _name(kind: str, elements: Any, notes: Notes) -> None:
    taken = {element.name for element in elements}
    for number, element in enumerate(elements):
        if element.name:
            continue
        stem = name = f"{element.parent.name}_joint" if kind == "joint" else f"body{number}"
        extra = 2
        while name in taken:
            name, extra = f"{stem}{extra}", extra + 1
        element.name = name
        taken.add(name)
        if kind == "joint":
            notes.assumed(f"joint {name}", "has no name in the file and got this one")
