"""Making an environment of a robot and a task."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from fo_gym.checks import shown, text
from fo_gym.envs.registry import ENVIRONMENTS, TAGS, Environment, add
from fo_gym.modules import is_of_file
from fo_gym.robots import RobotLike, robot_of
from fo_gym.tasks.task import TaskLike, made_for

__all__ = ["register"]

_OWN = "own"


def register(env_id: str, robot: RobotLike, task: TaskLike, *, tags: Iterable[str] = ("arm",)) -> None:
    """Make an environment: `gymnasium.make(env_id)`, `make_vec`, `evaluate`, every command and protocols know it then.

    Call it when a module is imported, not under `if __name__ == "__main__"`: worker processes import it, too. Commands
    find it as "file.py:ID" or "module:ID"; `fo-gym list` shows those of installed packages that name the module under
    the entry points `fo_gym.environments`.

    Args:
        env_id: a Gymnasium id such as "MyTask-v0".
        robot: a Robot, the name of a shipped one, or a file.
        task: a Task, or a function that makes one for a robot.
        tags: what it is, of link, arm, step, path, square, hand; "arm" has the commands run it on other robots.

    Raises:
        ValueError: the id is none or taken, a tag is unknown, the robot cannot be had, or the task does not suit it.
    """
    if not re.fullmatch(r"[\w.-]+-v\d+", text("env_id", env_id)):
        raise ValueError(f"env_id is {shown(env_id)}; give letters, digits and _ . - and a version, such as MyTask-v0")
    source = _source(inspect.stack()[1].frame.f_globals)
    taken = ENVIRONMENTS.get(env_id)
    if taken is not None and (taken.source != source or _OWN not in taken.tags):
        raise ValueError(f"env_id {env_id!r} is taken, by {taken.source or 'fo_gym'}; choose another one")
    if isinstance(tags, str) or not set(tags) <= set(TAGS):
        raise ValueError(f"tags is {shown(tags)}; give some of {', '.join(TAGS)}, as a tuple or a list")
    own = robot_of(robot)
    made_for(own, task).fitted_to(own)  # what does not fit is told now
    add(Environment(env_id, "fo_gym.envs.made:Made", frozenset({*tags, _OWN}), own, task, source))


def _source(caller: dict[str, Any]) -> str:
    """The module, or where it cannot be imported by its name the file, that these globals are of; "" of a console."""
    name, file = caller.get("__name__", ""), caller.get("__file__")
    if name and name != "__main__" and not is_of_file(name) and find_spec(name):
        return str(name)
    return str(Path(file).resolve()) if file else ""
