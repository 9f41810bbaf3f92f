"""The robots: one MJCF file each, describing the link side only (see README.md in this folder)."""

from pathlib import Path

__all__ = ["asset_path", "is_asset"]

_FOLDER = Path(__file__).resolve().parent


def asset_path(name: str) -> Path:
    """Return the MJCF file of a robot.

    Args:
        name: File name without its ending, for example "single_link" or "miro_like".

    Raises:
        ValueError: If there is no such robot; the message names those there are.
    """
    files = {file.stem: file for file in sorted(_FOLDER.glob("*.xml"))}
    if name not in files:
        raise ValueError(f"unknown robot {name!r}; expected one of: {', '.join(files)}")
    return files[name]


def is_asset(path: Path) -> bool:
    """Whether a robot's file is one of these."""
    return path.resolve().parent == _FOLDER
