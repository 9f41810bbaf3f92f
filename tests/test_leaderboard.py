"""From rows to the leaderboard and to the standings: columns, means, intervals, verdicts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest
from tables import KEYS, PROVENANCE, SQUARE

from fo_gym.evaluation.evaluate import failed_rows
from fo_gym.evaluation.leaderboard import leaderboard, standings
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.run import EpisodeSet


def synthetic(frr: dict[str, list[float]], variant: str = "randomized", **columns: Any) -> pd.DataFrame:
    """Episodes with these friction rejection ratios, as `evaluate` would give them."""
    parts = []
    for name, values in frr.items():
        part = failed_rows(EpisodeSet(SQUARE, variant, tuple(range(len(values))), {}), name, "", "p@0")
        parts.append(part.assign(frr=values, status="ok", joint_unit="rad", **columns))
    return pd.concat(parts, ignore_index=True)


BASE = np.linspace(0.1, 0.9, 20)
TURNS = np.where(np.arange(20) % 2, -1.0, 1.0)
KNOWN = {
    "none": [0.0] * 20,
    "ideal": [1.0] * 20,
    "behind": list(BASE - 0.1 + 0.02 * TURNS),
    "best": list(BASE),
    "tied": list(BASE - 0.003 + 0.02 * TURNS),
}


def test_columns_of_the_leaderboard() -> None:
    expected = [*KEYS, "status", "error", "episodes", "frr", "frr_ci_low", "frr_ci_high"]
    table = leaderboard(synthetic(KNOWN))
    assert list(table) == [*expected, *[name for name in METRICS if name != "frr"], "joint_unit", *PROVENANCE]
    assert table["compensator"].tolist() == list(KNOWN)
    assert table["episodes"].tolist() == [20] * 5
    assert table["protocol"].tolist() == ["p@0"] * 5


def test_means_are_interquartile_and_inside_their_interval() -> None:
    table = leaderboard(synthetic({"a": [0.0, 0.4, 0.6, 99.0], "b": [0.1] * 4}, rest_error_ju=[1.0, 2.0, 4.0, 99.0]))
    assert table["frr"].tolist() == pytest.approx([0.5, 0.1])
    assert table["rest_error_ju"].tolist() == pytest.approx([3.0, 3.0])
    assert table["frr_ci_low"][0] < 0.5 < table["frr_ci_high"][0]
    assert table.loc[1, ["frr_ci_low", "frr_ci_high"]].tolist() == pytest.approx([0.1, 0.1])


def test_the_interval_of_one_episode_is_its_value() -> None:
    row = leaderboard(synthetic({"a": [0.7]}, "nominal")).iloc[0]
    assert row[["frr", "frr_ci_low", "frr_ci_high"]].tolist() == [0.7, 0.7, 0.7]


def test_what_does_not_apply_is_left_out() -> None:
    table = leaderboard(synthetic({"a": [math.nan, 0.4, 0.6], "b": [math.nan] * 3}))
    assert table["frr"][0] == pytest.approx(0.5)
    assert table["episodes"].tolist() == [3, 3]
    assert table.loc[1, ["frr", "frr_ci_low", "frr_ci_high"]].isna().all()


def test_what_does_not_apply_is_counted() -> None:
    table = leaderboard(synthetic({"a": [math.nan, 0.4, 0.6], "b": [0.1] * 3}))
    assert table["status"].tolist() == ["ok", "ok"]
    assert "1 of 3" in table["error"][0]
    assert table["error"][1] == ""


def test_failed_and_ended_episodes_say_so() -> None:
    table = synthetic({"a": [0.5, 0.6], "b": [-3.0, 0.6], "c": [math.nan] * 2})
    table.loc[2, ["status", "error"]] = ["terminated", "joint_limit at 0.300 s"]
    table.loc[[4, 5], ["status", "error"]] = ["failed", "KeyError: oops"]
    board = leaderboard(table)
    assert board["status"].tolist() == ["ok", "terminated", "failed"]
    assert board["error"].tolist()[0::2] == ["", "KeyError: oops"]
    assert "1 of 2" in board["error"][1]
    assert "joint_limit at 0.300 s" in board["error"][1]
    assert set(standings(table)["compensator"]) == {"a", "b"}


def test_verdicts_where_the_answer_is_known() -> None:
    result = standings(synthetic(KNOWN)).set_index("compensator")
    assert result["verdict"].to_dict() == {"best": "best", "tied": "tied", "behind": "behind"}
    assert result["rank"].to_dict() == {"best": 1, "tied": 2, "behind": 3}


def test_verdicts_compare_seed_by_seed() -> None:
    """A small and steady distance counts, although it drowns in the spread between the episodes."""
    close = synthetic({"best": list(BASE), "behind": list(BASE - 0.001)})
    assert standings(close)["verdict"].tolist() == ["best", "behind"]
    assert standings(close.sample(frac=1.0, random_state=3))["verdict"].tolist() == ["best", "behind"]


def test_a_new_competitor_leaves_the_other_rows_alone() -> None:
    small, large = synthetic(KNOWN), synthetic({"new": list(BASE[::-1] - 0.2), **KNOWN})
    before, after = leaderboard(small).to_csv(index=False), leaderboard(large).to_csv(index=False)
    assert [line for line in after.splitlines() if ",new," not in line] == before.splitlines()
    ranked = standings(large).set_index("compensator")
    assert ranked["verdict"].drop("new").to_dict() == standings(small).set_index("compensator")["verdict"].to_dict()
