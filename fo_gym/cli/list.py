"""`fo-gym list`: what there is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from fo_gym.console import Stop, say

if TYPE_CHECKING:
    from fo_gym.envs.registry import Environment

__all__ = ["run_list"]


def run_list(
    sources: Annotated[
        list[str] | None,
        typer.Argument(metavar="SOURCE...", help="Files (*.py) or modules that register environments of your own."),
    ] = None,
) -> None:
    """Show the environments, robots, variants, compensators, metrics, entries and protocols there are.

    Examples:
        fo-gym list

        fo-gym list mine.py
    """
    try:
        for kind, texts in _found(sources or ()).items():
            for text in texts:
                say(f"{kind:<12} {text}")
    except ValueError as error:
        raise Stop(str(error)) from error


def _found(sources: Sequence[str]) -> dict[str, list[str]]:
    """Lines of text by kind. Raises ValueError where a source, or a module of a plug-in, cannot be imported."""
    from fo_gym import list_compensators
    from fo_gym.envs.registry import environment_of, import_source, known_environments
    from fo_gym.evaluation.competitors.entry import shipped_entries
    from fo_gym.evaluation.metrics import METRICS
    from fo_gym.evaluation.runs.protocol import shipped_protocols
    from fo_gym.robots import shipped_robots
    from fo_gym.tasks.variants import VARIANTS

    for source in sources:
        import_source(source, f"source {source!r}")
    metrics = [
        f"{name} ({metric.unit_text}, {metric.better} is better): {metric.description}"
        for name, metric in METRICS.items()
    ]
    return {
        "environment": [_environment(environment_of(name)) for name in known_environments()],
        "robot": list(shipped_robots()),
        "variant": list(VARIANTS),
        "compensator": list_compensators(),
        "metric": metrics,
        "entry": [f"{name}: {path}" for name, path in shipped_entries().items()],
        "protocol": [f"{name}: {path}" for name, path in shipped_protocols().items()],
    }


def _environment(row: Environment) -> str:
    """An environment with its tags, its robot, and where it is from."""
    source = f", from {row.source}" if row.source else ""
    return f"{row.id} ({', '.join(sorted(row.tags))}): on {row.robot_name}{source}"
