"""From a compensator to a row, from rows to the leaderboard: columns, seeds, protocols, verdicts."""

from __future__ import annotations

import math
import platform
from dataclasses import fields, replace
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pandas as pd
import pytest

from fo_gym import ENVIRONMENTS, FRICTIONLESS, evaluate
from fo_gym.evaluation.evaluate import failed_rows
from fo_gym.evaluation.leaderboard import leaderboard, standings
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.protocol import Protocol, load_protocol, shipped_protocols
from fo_gym.evaluation.run import EpisodeSet
from fo_gym.evaluation.seeds import LEADERBOARD_SEEDS, TRAINING_SEEDS, VALIDATION_SEEDS, first

STICTION, REGULATION, SQUARE = ENVIRONMENTS
SIX = ("pid-low", "pid-high", "pd-low", "pd-high", "letien-low", "letien-high")
PACKAGES = {name: f"version_{name.replace('-', '_')}" for name in ("fo-gym", "gymnasium", "mujoco", "numba", "numpy")}
PACKAGES["scipy"] = "version_scipy"
PROVENANCE = ["protocol", *PACKAGES.values(), "version_python"]
KEYS = ["env", "variant", "compensator"]

# evaluate


@pytest.fixture(scope="module")
def scores() -> dict[str, pd.DataFrame]:
    """Everybody on the first half second of the single link."""
    return {name: evaluate(name, STICTION, duration=0.5) for name in ("none", "ideal", *SIX)}


def test_columns_and_their_order(scores: dict[str, pd.DataFrame]) -> None:
    expected = [*KEYS, "seed", "status", "error", *METRICS, "joint_unit", *PROVENANCE]
    assert expected[6] == "frr"
    assert all(list(table) == expected for table in scores.values())
    row = scores["pid-low"].iloc[0]
    assert row[[*KEYS, "status", "error", "joint_unit"]].tolist() == [STICTION, "nominal", "pid-low", "ok", "", "m"]
    assert math.isnan(row["contour_error_mm"])


def test_the_references_are_the_ends_of_the_scale(scores: dict[str, pd.DataFrame]) -> None:
    assert scores["none"]["frr"].tolist() == [0.0]
    assert scores["ideal"]["frr"].tolist() == [1.0]


def test_higher_gains_reject_more(scores: dict[str, pd.DataFrame]) -> None:
    frr = {name: table["frr"].iloc[0] for name, table in scores.items()}
    assert all(0.0 < frr[name] < 1.0 for name in SIX)
    assert frr["pid-high"] > frr["pid-low"]
    assert frr["pd-high"] > frr["pd-low"]
    assert frr["letien-high"] > frr["letien-low"]


def test_versions_are_the_installed_ones(scores: dict[str, pd.DataFrame]) -> None:
    row = scores["none"].iloc[0]
    assert {name: row[column] for name, column in PACKAGES.items()} == {name: version(name) for name in PACKAGES}
    assert row["version_python"] == platform.python_version()
    assert row["protocol"] == ""


def test_a_number_of_seeds_is_so_many_validation_seeds(scores: dict[str, pd.DataFrame]) -> None:
    table = evaluate("none", STICTION, variant="randomized", seeds=3, duration=0.1)
    assert table["seed"].tolist() == list(VALIDATION_SEEDS[:3])
    assert scores["none"]["seed"].tolist() == [VALIDATION_SEEDS[0]]
    assert len(evaluate("none", STICTION, variant="randomized", duration=0.01)) == 20
    numpy = evaluate("none", STICTION, variant="randomized", seeds=np.array([4, 2]), duration=0.01)  # type: ignore[arg-type]
    assert numpy["seed"].tolist() == [4, 2]


@pytest.mark.parametrize(
    "seeds",
    [0, 1001, [], [-1], [1.5], -1],
)
def test_impossible_seeds_are_refused(seeds: Any) -> None:
    variant = "nominal" if seeds == -1 else "randomized"
    with pytest.raises((ValueError, TypeError, gym.error.Error), match=r"[Ss]eed|num_envs|integer"):
        evaluate("none", STICTION, variant=variant, seeds=seeds, duration=0.01)


def test_arguments_reach_the_environment() -> None:
    frictionless = evaluate("pid-low", STICTION, duration=0.1, friction=FRICTIONLESS)
    assert frictionless["frr"].isna().all()
    assert frictionless["status"].tolist() == ["ok"]
    fast, slow = (evaluate("pid-low", STICTION, duration=0.1, control_dt=dt)["frr"].iloc[0] for dt in (1e-3, 2e-3))
    assert fast != slow


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"env_id": "FJRNothing-v0"}, ValueError, "FJRNothing"),
        ({"env_id": "CartPole-v1"}, (TypeError, ValueError), "CartPole|variant"),
        ({"variant": "wild"}, ValueError, "variant is 'wild'; allowed are 'nominal', 'randomized'"),
        ({"wobble": 1}, TypeError, "wobble"),
        ({"num_envs": 3}, TypeError, "num_envs"),
        ({"duration": -1.0}, ValueError, "duration is -1.0"),
        ({"compensator": "nobody"}, ValueError, "unknown compensator 'nobody'"),
        ({"feedback": "measured"}, (TypeError, ValueError), "feedback"),
        ({"action_mode": "torque"}, (TypeError, ValueError), "action_mode"),
    ],
)
def test_bad_arguments(arguments: dict[str, Any], error: Any, message: str) -> None:
    with pytest.raises(error, match=message):
        evaluate(**({"compensator": "pid-low", "env_id": STICTION, "duration": 0.01} | arguments))


# Seeds


def test_splits_are_disjoint() -> None:
    splits = (LEADERBOARD_SEEDS, VALIDATION_SEEDS, TRAINING_SEEDS)
    ends = sorted(splits, key=lambda split: split.start)
    assert all(split.step == 1 and len(split) >= 1000 for split in splits)
    assert all(one.stop <= other.start for one, other in pairwise(ends))
    assert first(LEADERBOARD_SEEDS, 3) == tuple(LEADERBOARD_SEEDS)[:3]


# Protocols

SMALL = Protocol("small", "validation", 2, (SQUARE,), ("nominal", "randomized"), ("pid-low", "pd-low"))
TOML = """
name = "small"
split = "validation"
seeds = 2
environments = ["FJRSquare-v0"]
variants = ["nominal", "randomized"]
compensators = ["pid-low", "pd-low"]
"""


def test_shipped_protocols() -> None:
    assert set(shipped_protocols()) == {"full", "quick"}
    full, quick = load_protocol("full"), load_protocol("quick")
    assert full.environments == ENVIRONMENTS
    assert (full.split, full.seeds, full.variants) == ("leaderboard", 20, ("nominal", "randomized"))
    assert set(SIX) <= set(full.compensators)
    assert replace(full, name="quick", seeds=2) == quick
    assert full.seeds_of("randomized") == tuple(range(20))
    assert full.seeds_of("nominal") == (0,)
    assert SMALL.seeds_of("randomized") == (1_000_000, 1_000_001)


def test_a_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(TOML, encoding="utf-8")
    assert load_protocol(tmp_path / "small.toml") == SMALL
    assert load_protocol(str(tmp_path / "small.toml")).stamp == SMALL.stamp


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("seeds = 2\n", "", r"small\.toml.*missing keys \['seeds'\]"),
        ("seeds = 2", "seeds = 2\ncolour = 3", r"small\.toml.*unknown keys \['colour'\]"),
        ("seeds = 2", "seeds = 0", "0 seeds were asked for"),
        ("seeds = 2", "seeds = 1001", "1001 seeds.*from 1 to 1000"),
        ("seeds = 2", "seeds = ", r"small\.toml"),
        ('"validation"', '"training"', "split is 'training'; allowed are leaderboard, validation"),
        ("FJRSquare-v0", "CartPole-v1", "unknown environment 'CartPole-v1'; known are FJRStiction-v0"),
        ('"randomized"', '"hardware"', "unknown variant 'hardware'; known are nominal, randomized"),
        ('"randomized"', '"nominal"', r"variants \['nominal', 'nominal'\] names one of them twice"),
        ('"pd-low"', '"pid-low"', "compensators .* names one of them twice"),
        ("seeds = 2", 'seeds = "2"', "seeds is '2'"),
        ("seeds = 2", "seeds = 2.5", r"seeds is 2\.5"),
        ('["FJRSquare-v0"]', '"FJRSquare-v0"', "environments is 'FJRSquare-v0'"),
        ('["pid-low", "pd-low"]', "[]", "compensators"),
        ('["FJRSquare-v0"]', "[]", "environments"),
        ('"pd-low"', "7", "compensators.*7"),
    ],
)
def test_a_bad_protocol_is_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    file = tmp_path / "small.toml"
    assert old in TOML
    file.write_text(TOML.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ValueError, match=message):
        load_protocol(file)


def test_a_missing_protocol_names_the_shipped_ones() -> None:
    with pytest.raises(ValueError, match=r"no protocol 'fulll'.*full, quick"):
        load_protocol("fulll")


CHANGES = {
    "name": "large",
    "split": "leaderboard",
    "seeds": 3,
    "environments": (STICTION,),
    "variants": ("nominal",),
    "compensators": ("pd-low",),
}


def test_the_stamp_tells_protocols_apart() -> None:
    assert set(CHANGES) == {field.name for field in fields(Protocol)}
    others = [replace(SMALL, **{name: value}) for name, value in CHANGES.items()]  # type: ignore[arg-type]
    stamps = {each.stamp for each in (SMALL, *others)}
    assert len(stamps) == len(CHANGES) + 1
    assert replace(SMALL).stamp == SMALL.stamp
    assert SMALL.stamp.startswith("small@")


# Leaderboard and standings


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
