"""Where a file's meshes are: beside it, in the folders it names, or in the package that it asks for."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import mujoco

from fo_gym.robots.report import Notes

READABLE = {".stl", ".obj", ".msh"}
"""Endings of the meshes that MuJoCo reads."""

MOST_FACES = 200_000
"""Of a mesh in an STL file: what MuJoCo reads."""

_UPWARDS = 6
"""How many folders above the file are searched for a package."""

__all__ = ["READABLE", "find_file", "find_mesh", "find_meshes", "note_missing"]


def _candidates(name: str, file: Path, folder: str) -> Iterator[Path]:
    scheme, found, rest = name.partition("://")
    if not found:
        scheme, rest = "", name
    if scheme in ("package", "model"):
        package, _, inside = rest.partition("/")
        for parent in list(file.parents)[:_UPWARDS]:
            yield parent / rest
            if parent.name == package:
                yield parent / inside
    elif scheme in ("", "file"):
        path = Path(rest)
        yield path if path.is_absolute() else file.parent / folder / path
        yield file.parent / path
        yield file.parent / folder / path.name


def _is_read(path: Path) -> bool:
    """Whether an STL is of the binary kind, which MuJoCo reads, and as long as it says."""
    if path.suffix.lower() != ".stl":
        return True
    with path.open("rb") as stream:
        faces = int.from_bytes(stream.read(84)[80:], "little")
    return 1 <= faces <= MOST_FACES and path.stat().st_size >= 84 + 50 * faces


def find_file(name: str, file: Path, folder: str = "") -> Path | None:
    """The file that a robot's file names, or None where there is none.

    Args:
        name: as the robot's file gives it; `package://` is searched beside the file and upwards.
        file: the robot's file.
        folder: where it says that such files are.
    """
    try:
        return next((path for path in _candidates(name, file, folder) if path.is_file()), None)
    except (OSError, ValueError):  # names that no file can have
        return None


def find_mesh(name: str, file: Path, folder: str = "") -> Path | None:
    """The file of a mesh, or None where there is none that MuJoCo reads. Arguments as of `find_file`."""
    found = find_file(name, file, folder) if Path(name).suffix.lower() in READABLE else None
    return found if found is not None and _is_read(found) else None


def find_meshes(spec: mujoco.MjSpec, file: Path) -> set[str]:
    """Give each mesh of an MJCF file the path of its file, in place; returns the names of those that are not found."""
    missing = set()
    for mesh in spec.meshes:
        if mesh.file:
            found = find_mesh(mesh.file, file, mesh.compiler.meshdir or "")
            if found is None:
                missing.add(mesh.name)
            else:
                mesh.file = str(found.absolute())
    return missing


def note_missing(missing: set[str], notes: Notes) -> None:
    """Write down which meshes pictures do without."""
    if missing:
        few = ", ".join(sorted(missing)[:3]) + (", ..." if len(missing) > 3 else "")
        notes.dropped(
            "meshes", f"{len(missing)} not found, or no (binary) STL, OBJ or MSH, and left out of pictures: {few}"
        )
