"""The robots that come as data, and what else names one."""

from __future__ import annotations

from functools import lru_cache
from os import PathLike
from pathlib import Path

from fo_gym.checks import shown
from fo_gym.robots.robot import Robot

RobotLike = Robot | str | PathLike[str]
"""A robot, the name of a shipped one, or a file: *.toml, *.xml (MJCF), *.urdf."""

_DATA = Path(__file__).parent / "data"

__all__ = ["RobotLike", "robot_of", "shipped_robots"]


def shipped_robots() -> tuple[str, ...]:
    """Names of the robots that come with the package; of some only the numbers do, and the files in other packages."""
    return tuple(sorted(path.stem for path in _DATA.glob("*.toml")))


@lru_cache(maxsize=8)
def _shipped(name: str) -> Robot:
    return Robot.from_toml(_DATA / f"{name}.toml")


def robot_of(value: RobotLike) -> Robot:
    """The robot that a value means.

    Raises:
        FileNotFoundError: there is no such file, or its package is not installed.
        ValueError: it means no robot; the message names what is allowed.
    """
    if isinstance(value, Robot):
        return value
    if isinstance(value, str) and value in shipped_robots():
        return _shipped(value)
    if isinstance(value, str | PathLike):
        kind = Path(value).suffix.lower()
        if kind == ".toml":
            return Robot.from_toml(value)
        if kind in (".xml", ".urdf"):
            return Robot.from_file(value)
    names = ", ".join(shipped_robots())
    raise ValueError(f"robot is {shown(value)}; give a Robot, one of {names}, or a file *.toml, *.xml or *.urdf")
