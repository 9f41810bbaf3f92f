"""Environments, compensators and columns, for the tests of the evaluation."""

from fo_gym import ENVIRONMENTS

STICTION, REGULATION, SQUARE = ENVIRONMENTS
SIX = ("pid-low", "pid-high", "pd-low", "pd-high", "letien-low", "letien-high")
PACKAGES = {name: f"version_{name.replace('-', '_')}" for name in ("fo-gym", "gymnasium", "mujoco", "numba", "numpy")}
PACKAGES["scipy"] = "version_scipy"
PROVENANCE = ["origin", "competitor_hash", "protocol", *PACKAGES.values(), "version_python"]
KEYS = ["env", "variant", "compensator"]
