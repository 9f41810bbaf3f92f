"""The chosen gains as an entry, which protocols and `fo-gym evaluate` take."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from fo_gym.specs import is_ours, spec_of
from fo_gym.tasks.variants import NOMINAL
from fo_gym.tuning.study import Outcome

OURS, UNNAMED = ("The fo-gym authors",), ("unnamed",)

__all__ = ["authors_of", "entry_text", "spec_beside"]

STANDS_FOR_NOMINAL = "randomized"
"""The nominal variant is one episode, which cannot be tuned on: it has the gains of this one."""


def authors_of(spec: str) -> tuple[str, ...]:
    """Whom an entry credits where nobody is named: the project for its own compensators, else nobody by name."""
    return OURS if is_ours(spec) else UNNAMED


def spec_beside(spec: str, folder: Path) -> str:
    """The spec as an entry in that folder has it: a file is named from there."""
    named = spec_of(spec)
    if named.kind != "file":
        return spec
    file, start = Path(named.where).resolve(), folder.resolve()
    # Windows has no way from one drive to another.
    path = file if file.drive != start.drive else Path(os.path.relpath(file, start))
    return named.with_file(path)


def entry_text(spec: str, authors: Sequence[str], outcomes: Iterable[Outcome], command: str) -> str:
    """An entry (TOML) with the gains of every environment and variant.

    Args:
        spec: the compensator that was tuned, as seen from the entry.
        authors: who made it.
        outcomes: what the studies found.
        command: what to run to get it again.
    """
    lines = [
        f"# Tuned by: {' '.join(command.splitlines())}",
        f"spec = {_text(spec)}",
        f"authors = [{', '.join(map(_text, authors))}]",
        'link = ""',
        "",
    ]
    for outcome in outcomes:
        variants = [outcome.case.variant]
        if outcome.case.variant == STANDS_FOR_NOMINAL:
            variants.insert(0, NOMINAL)
        for variant in variants:
            lines += [
                "[[sets]]",
                f"env = {_text(outcome.case.env_id)}",
                f"variant = {_text(variant)}",
                f"gains = {_inline(outcome.gains)}",
                "",
            ]
    return "\n".join(lines)


def _text(value: str) -> str:
    return json.dumps(value, ensure_ascii=False)


def _inline(gains: Mapping[str, float]) -> str:
    return "{ " + ", ".join(f"{name} = {float(f'{value:.6g}')!r}" for name, value in gains.items()) + " }"
