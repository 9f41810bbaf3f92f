"""The command line `fo-gym`: its own commands, and what plug-ins add to them."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points

import typer

from fo_gym.cli.bench import run_bench
from fo_gym.cli.reproduce import run_reproduce
from fo_gym.cli.scores import evaluate, list_everything, run_leaderboard
from fo_gym.cli.tune import run_tune
from fo_gym.cli.verify import run_verify
from fo_gym.console import errors, say

GROUP = "fo_gym.commands"
"""Entry points of further commands: a name, and a function as Typer takes it."""

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="The benchmark for friction compensation on flexible robot joints.",
)
_OWN: dict[str, Callable[..., None]] = {
    "list": list_everything,
    "evaluate": evaluate,
    "leaderboard": run_leaderboard,
    "verify": run_verify,
    "reproduce": run_reproduce,
    "bench": run_bench,
    "tune": run_tune,
}


def _add_commands(to: typer.Typer) -> None:
    """Our own commands, then those of plug-ins; one that cannot be loaded is reported, and spoils nothing else."""
    for name, function in _OWN.items():
        to.command(name)(function)
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        try:
            if entry.name in _OWN:
                raise ValueError("the name is taken")
            to.command(entry.name)(entry.load())
        except Exception as error:
            say(f"fo-gym: command {entry.name!r} of {entry.value} is left out: {error}", errors)


_add_commands(app)

__all__ = ["GROUP", "app"]
