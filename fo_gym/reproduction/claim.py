"""How a measurement becomes a claim of the paper, that is a row of their table."""

from __future__ import annotations

from collections.abc import Callable

from fo_gym.certificate.statement import Measure, Statement, register

CLAIMS: dict[str, Statement] = {}
"""Claims of the paper by id."""

__all__ = ["CLAIMS", "claim"]


def claim(id: str, *, source: str, text: str, fails: str = "") -> Callable[[Measure], Measure]:
    """Register a claim of the paper; see `Statement`."""
    return register(CLAIMS, id, source, text, fails)
