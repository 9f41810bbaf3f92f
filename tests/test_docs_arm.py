"""docs/arm.md: its numbers are the arm's, its tables those that were measured, and these show what was promised."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fo_gym.reproduction.runs import PAPER
from fo_gym.robots import robot_of

DOCS = Path(__file__).parents[1] / "docs"
PAGE = (DOCS / "arm.md").read_text(encoding="utf-8")


def table(name: str) -> pd.DataFrame:
    return pd.read_csv(DOCS / "arm" / f"{name}.csv")


@pytest.mark.parametrize("name", ["f_c", "f_s", "v_s", "sigma_0", "sigma_1", "sigma_2"])
def test_its_friction_is_the_arms(name: str) -> None:
    found = re.search(rf"^\| {name} \[[^|]*\] \| ([\d.]+) \| ([\d.]+) \|", PAGE, re.MULTILINE)
    assert found
    shown = np.array([float(found[1])] * 4 + [float(found[2])] * 3)
    np.testing.assert_allclose(getattr(robot_of("miro_like").friction, name), shown, rtol=1e-3)


def test_its_tables_are_the_measured_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(DOCS)
    spec = importlib.util.spec_from_file_location("docs_tables", DOCS / "tables.py")
    assert spec is not None
    assert spec.loader is not None
    tables = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tables)
    assert tables.page("docs/arm.md") == PAGE


def test_verdicts_are_the_same_at_every_micro_step() -> None:
    """PID-low and Le Tien's observer hunt, all others rest [mrad]; every observer undoes 85 % of friction's effect."""
    rows = table("verdicts")
    assert set(rows["physics_dt"]) == {2e-4, 1e-4, 5e-5}
    assert len(rows) == 3 * len(PAPER)
    hunts = rows["compensator"].isin(["pid-low", "letien-low", "letien-high"])
    assert (rows["moves 40-60 s"][hunts] > 1.0).all()
    assert (rows["moves 40-60 s"][~hunts] < 0.1).all()
    assert (rows["FRR on the square"] > 0.85).all()


def test_randomized_counts() -> None:
    counts = table("randomized").set_index("compensator")["joint 2 hunts"]
    assert counts["pid-low"] >= 10
    assert counts["pid-high"] <= 2
    assert counts["pd-low"] == counts["pd-high"] == 0
