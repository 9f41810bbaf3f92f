"""The command line `fo-gym`: its own commands, and what plug-ins add to them.

The modules of the commands import what they need when they run: `fo-gym --help`, and that of each command, are there
at once.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from itertools import pairwise
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from fo_gym.cli.bench import run_bench
from fo_gym.cli.evaluate import run_evaluate
from fo_gym.cli.leaderboard import run_leaderboard
from fo_gym.cli.list import run_list
from fo_gym.cli.map import run_map
from fo_gym.cli.page import run_page
from fo_gym.cli.render import run_render
from fo_gym.cli.reproduce import run_reproduce
from fo_gym.cli.robot import robot_commands
from fo_gym.cli.sweep import run_sweep
from fo_gym.cli.tune import run_tune
from fo_gym.cli.verify import run_verify
from fo_gym.console import Stop, errors, say

GROUP = "fo_gym.commands"
"""Entry points of further commands: a name, and a function as Typer takes it."""

__all__ = ["GROUP", "app"]


class _Command(TyperCommand):
    """A command with options that are not empty: `--out "$UNSET"` would mean the folder where one is."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """What is left of the arguments. Stops at an option with an empty text."""
        for option, value in pairwise((*args, None)):
            if option and ((option.startswith("--") and value == "") or re.fullmatch(r"--[\w-]+=", option)):
                raise Stop(f"{option.removesuffix('=')} is ''; give a text that is not empty, or leave it out")
        return super().parse_args(ctx, args)


class _PlugIn(TyperCommand):
    """A command of a plug-in, which is loaded when it is called."""

    def __init__(self, entry: EntryPoint) -> None:
        super().__init__(entry.name, callback=None, short_help=f"From {entry.module}; see fo-gym {entry.name} --help.")
        self._entry = entry

    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        """The context of the command itself, which runs in place of this one."""
        single = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
        try:
            single.command(self.name, cls=_Command)(self._entry.load())
            command = typer.main.get_command(single)
        except Exception as error:
            raise Stop(f"command {self.name!r} of {self._entry.value} cannot be loaded: {error}") from error
        return command.make_context(*args, **kwargs)


class _Commands(TyperGroup):
    """Our own commands, then those of plug-ins by name; one that takes a name of ours is reported and left out."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
            if entry.name in self.commands:
                say(f"fo-gym: command {entry.name!r} of {entry.value} is left out: the name is taken", errors)
            else:
                self.add_command(_PlugIn(entry))


app = typer.Typer(
    cls=_Commands,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="The benchmark for friction compensation on flexible robot joints.",
    epilog="Example: fo-gym evaluate mine.py:Mine --env FJRStiction-v0",
)
_OWN: dict[str, Callable[..., None]] = {
    "list": run_list,
    "evaluate": run_evaluate,
    "sweep": run_sweep,
    "map": run_map,
    "render": run_render,
    "leaderboard": run_leaderboard,
    "verify": run_verify,
    "page": run_page,
    "reproduce": run_reproduce,
    "bench": run_bench,
    "tune": run_tune,
}
for _name, _function in _OWN.items():
    app.command(_name, cls=_Command)(_function)
app.add_typer(robot_commands, name="robot")
