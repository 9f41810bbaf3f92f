"""Environments, compensators, columns and rows without a simulation, for the tests of the evaluation."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fo_gym.evaluation.runs.episodes import EpisodeSet, failed_rows

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"
SIX = ("pid-low", "pid-high", "pd-low", "pd-high", "letien-low", "letien-high")
PACKAGES = {name: f"version_{name.replace('-', '_')}" for name in ("fo-gym", "gymnasium", "mujoco", "numba", "numpy")}
PACKAGES["scipy"] = "version_scipy"
PROVENANCE = ["origin", "learned", "competitor_hash", "protocol", "processor", *PACKAGES.values(), "version_python"]
KEYS = ["env", "robot", "variant", "compensator"]


def synthetic(
    frr: Mapping[str, Sequence[float]], variant: str = "randomized", env: str = SQUARE, **columns: Any
) -> pd.DataFrame:
    """Episodes with these friction rejection ratios, as `evaluate` would give them."""
    parts = []
    for name, values in frr.items():
        part = failed_rows(EpisodeSet(env, variant, tuple(range(len(values))), {}), name, "")
        parts.append(part.assign(frr=values, status="ok", joint_unit="rad", protocol="p@0", **columns))
    return pd.concat(parts, ignore_index=True)
