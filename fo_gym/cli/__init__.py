"""The command line: `fo-gym list | evaluate | leaderboard | reproduce`."""

from __future__ import annotations

import typer

from fo_gym.cli.reproduce import run_reproduce
from fo_gym.cli.scores import evaluate, list_everything, run_leaderboard

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="The benchmark for friction compensation on flexible robot joints.",
)
app.command("list")(list_everything)
app.command("evaluate")(evaluate)
app.command("leaderboard")(run_leaderboard)
app.command("reproduce")(run_reproduce)

__all__ = ["app"]
