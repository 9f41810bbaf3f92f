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


def provenance(origin: str = "", *, learned: bool = False) -> dict[str, str | bool]:
    """What a row says about how it came about; which competitor and protocol it is of, the run says, see `Trial`.

    Args:
        origin: "reference" (built in, or privileged), or "" of what a run has yet to name: "baseline" (named by the
            protocol), "submission" (from the folder of submissions), "yours" (given to `fo-gym evaluate` or a sweep).
        learned: whether the competitor says that data trained it; False where it could not be made.

    Returns:
        Columns `origin`, `learned`, `competitor_hash`, `protocol`, `processor` (see `processor`) and `version_*`.
    """
    made_by: dict[str, str | bool] = {"origin": origin, "learned": learned, "competitor_hash": "", "protocol": ""}
    return {**made_by, "processor": processor(), **versions()}


def is_provenance(column: str) -> bool:
    """Whether a column says how a row came about, not what came out."""
    return column in _COLUMNS or column.startswith("version_")


def is_reference(rows: pd.DataFrame) -> pd.Series[bool]:
    """Which rows are of references: built in, or privileged."""
    return rows["compensator"].isin(BUILT_IN) | (rows["origin"] == REFERENCE)
