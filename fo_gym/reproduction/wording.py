"""What a row of the tables says, in words: its number, its tolerance, its verdict; needs nothing that measures."""

from __future__ import annotations

import numpy as np

HOLDS, FAILS, NOT_MEASURED = "holds", "fails", "not measured"
"""Verdicts."""

__all__ = ["FAILS", "HOLDS", "NOT_MEASURED", "number", "tolerance"]


def tolerance(low: float, high: float) -> str:
    """An interval as text; NaN is an open end."""
    if np.isnan(low) and np.isnan(high):
        return "-"
    if np.isnan(low):
        return f"≤ {high:.4g}"
    return f"≥ {low:.4g}" if np.isnan(high) else f"{low:.4g} to {high:.4g}"


def number(value: float, unit: str) -> str:
    """A number with its unit; "-" where nothing was measured."""
    return "-" if np.isnan(value) else f"{value:.4g} {unit}".strip()
