"""What every published row says about how it came about."""

from __future__ import annotations

import platform
from functools import lru_cache
from importlib.metadata import version

import pandas as pd

from fo_gym.evaluation.competitors.competitor import REFERENCE
from fo_gym.evaluation.runs.processor import processor
from fo_gym.specs import BUILT_IN

PACKAGES = ("fo-gym", "gymnasium", "mujoco", "numba", "numpy", "scipy")

_COLUMNS = ("origin", "learned", "competitor_hash", "protocol", "processor")

__all__ = ["PACKAGES", "is_provenance", "is_reference", "provenance", "versions"]


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Columns `version_*`: the package, what computes, and Python."""
    packages = {f"version_{name.replace('-', '_')}": version(name) for name in PACKAGES}
    return packages | {"version_python": platform.python_version()}


def provenance(
    protocol: str = "", origin: str = "", competitor_hash: str = "", *, learned: bool = False
) -> dict[str, str | bool]:
    """What a row says about how it came about.

    Args:
        protocol: name and hash of what was run, or "" outside a protocol.
        origin: "baseline" (named by the protocol), "submission" (from the folder of submissions), "yours" (given to
            `fo-gym evaluate` or a sweep), "reference" (built in, or privileged), or "" outside a protocol.
        competitor_hash: of the competitor's source, weights and gains; "" for the references, and for a class or an
            instance.
        learned: whether the competitor says that data trained it; False where it could not be made.

    Returns:
        Columns `origin`, `learned`, `competitor_hash`, `protocol`, `processor` (see `processor`) and `version_*`.
    """
    made_by: dict[str, str | bool] = {
        "origin": origin,
        "learned": learned,
        "competitor_hash": competitor_hash,
        "protocol": protocol,
    }
    return {**made_by, "processor": processor(), **versions()}


def is_provenance(column: str) -> bool:
    """Whether a column says how a row came about, not what came out."""
    return column in _COLUMNS or column.startswith("version_")


def is_reference(rows: pd.DataFrame) -> pd.Series[bool]:
    """Which rows are of references: built in, or privileged."""
    return rows["compensator"].isin(BUILT_IN) | (rows["origin"] == REFERENCE)
