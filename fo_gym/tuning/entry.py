"""The chosen gains as an entry, which protocols and `fo-gym evaluate` take."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

from fo_gym.tuning.study import Outcome

__all__ = ["entry_text"]

NOMINAL = "nominal"
STANDS_FOR_NOMINAL = "randomized"
"""The nominal variant is one episode, which cannot be tuned on: it has the gains of this one."""


def entry_text(spec: str, outcomes: Iterable[Outcome], command: str) -> str:
    """An entry (TOML) with the gains of every environment and variant.

    Args:
        spec: the compensator that was tuned.
        outcomes: what the studies found.
        command: what to run to get it again.
    """
    lines = [
        f"# Tuned by: {command}",
        f"spec = {json.dumps(spec)}",
        'authors = ["The fo-gym authors"]',
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
                f"env = {json.dumps(outcome.case.env_id)}",
                f"variant = {json.dumps(variant)}",
                f"gains = {_inline(outcome.gains)}",
                "",
            ]
    return "\n".join(lines)


def _inline(gains: Mapping[str, float]) -> str:
    return "{ " + ", ".join(f"{name} = {float(f'{value:.6g}')!r}" for name, value in gains.items()) + " }"
