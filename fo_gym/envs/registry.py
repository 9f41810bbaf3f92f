"""The environments there are: one row each, which names it, says what it is for, and registers it with Gymnasium.

Those of others are named "module:ID" or "file.py:ID", the module or file being what calls `fo_gym.register`, or by
their id alone, where an installed package names such a module under the entry points `fo_gym.environments`.
"""

from __future__ import annotations

import importlib
import os
import sys
from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import gymnasium as gym

from fo_gym.checks import shown, text
from fo_gym.modules import import_file, module_name
from fo_gym.specs import spec_of

GROUP = "fo_gym.environments"
"""Entry points of modules that register environments when they are imported."""

TAGS = ("link", "arm", "step", "path", "square", "hand")
"""What an environment may be said to be; an "arm" takes any robot."""

__all__ = [
    "ENVIRONMENTS",
    "GROUP",
    "TAGS",
    "Environment",
    "add",
    "environment_of",
    "import_source",
    "import_sources",
    "known_environments",
    "sources",
]


@dataclass(frozen=True)
class Environment:
    """A registered environment.

    Attributes:
        id: by which `gymnasium.make` finds it.
        entry_point: "module:Name", where NameEnv is the single and NameVectorEnv the batched environment.
        tags: what it is, for whoever picks some of them: of TAGS, and "own" of one that `register` made.
        robot: its own robot: the name of a shipped one, or a Robot.
        task: what `register` was given; None of the project's own, whose class names it.
        source: module or file that registered it, to be imported where it is not known; "" of the project's own.
    """

    id: str
    entry_point: str
    tags: frozenset[str]
    robot: Any
    task: Any = None
    source: str = ""

    @property
    def robot_name(self) -> str:
        """What its own robot is called."""
        return str(getattr(self.robot, "name", self.robot))


ENVIRONMENTS: dict[str, Environment] = {}
"""Every environment by its id."""


def add(row: Environment) -> None:
    """Register an environment, here and with Gymnasium; one of the same id makes way."""
    gym.registry.pop(row.id, None)
    # The environments truncate themselves at `duration`, so that `decimation` does not stretch time.
    gym.register(
        row.id,
        entry_point=f"{row.entry_point}Env",
        vector_entry_point=f"{row.entry_point}VectorEnv",
        kwargs={} if row.task is None else {"robot": row.robot, "task": row.task},
    )
    ENVIRONMENTS[row.id] = row


for _id, _name, _tags, _robot in (
    ("FJRStiction-v0", "stiction:Stiction", {"link", "step"}, "single_link"),
    ("FJRRegulation-v0", "regulation:Regulation", {"arm", "step"}, "miro_like"),
    ("FJRSquare-v0", "square:Square", {"arm", "square"}, "miro_like"),
    ("FJRTracking-v0", "tracking:Tracking", {"arm", "path"}, "miro_like"),
    ("FJRInteraction-v0", "interaction:Interaction", {"arm", "hand"}, "miro_like"),
):
    add(Environment(_id, f"fo_gym.envs.{_name}", frozenset(_tags), _robot))


@cache
def _import_plug_ins() -> None:
    """Import the modules that installed packages name, once. One that raises is told of, and left out."""
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        try:
            entry.load()
        except Exception as error:
            package = entry.dist.name if entry.dist else "an installed package"
            gym.logger.warn(
                f"environments of {package} are missing: importing {entry.value} raised {type(error).__name__}: {error}"
            )


def known_environments() -> tuple[str, ...]:
    """The environments that can be scored, by their ids, those of installed packages included."""
    _import_plug_ins()
    return tuple(ENVIRONMENTS)


def environment_of(name: str) -> Environment:
    """The environment of an id, "module:ID" or "file.py:ID"; the module or file is imported.

    Raises:
        ValueError: there is none; the message names those there are.
    """
    spec = spec_of(text("environment", name))
    env_id = spec.attribute or name
    if spec.attribute:
        import_source(spec.where, f"environment {shown(name)}")
    elif env_id not in ENVIRONMENTS:
        _import_plug_ins()
    if env_id not in ENVIRONMENTS:
        raise ValueError(
            f"unknown environment {shown(name)}; known are {', '.join(ENVIRONMENTS)}; one of your own is "
            "file.py:ID or module:ID, of what calls fo_gym.register"
        )
    return ENVIRONMENTS[env_id]


def import_source(where: str, what: str) -> None:
    """Import the module or the file of a user, whose code may raise anything.

    Args:
        where: a module, or a file that ends with .py.
        what: begins the message of an error.

    Raises:
        ValueError: there is no such file, or it raised something; the message says what.
    """
    if where.endswith(".py") and not os.path.isfile(where):
        raise ValueError(f"{what}: there is no file {where}; name one that exists")
    try:
        import_sources([where])
    except Exception as error:
        raise ValueError(f"{what}: importing {where} raised {type(error).__name__}: {error}") from error


def sources() -> tuple[str, ...]:
    """Modules and files that registered the environments of others: a worker has to import them."""
    return tuple(dict.fromkeys(row.source for row in ENVIRONMENTS.values() if row.source))


def import_sources(names: tuple[str, ...] | list[str]) -> None:
    """Import modules and files, each once."""
    for name in names:
        if not name.endswith(".py"):
            importlib.import_module(name)
            continue
        path = Path(name).resolve()
        if module_name(path) not in sys.modules and str(path) != getattr(sys.modules["__main__"], "__file__", None):
            import_file(path)
