"""From a compensator to a row: columns, seeds, arguments."""

from __future__ import annotations

import math
import platform
from importlib.metadata import version
from itertools import pairwise
from typing import Any

import gymnasium as gym
import numpy as np
import pandas as pd
import pytest
from tables import KEYS, PACKAGES, PROVENANCE, SIX, STICTION

from fo_gym import ENVIRONMENTS, FRICTIONLESS, evaluate
from fo_gym.evaluation.competitors.entry import competitor_of
from fo_gym.evaluation.episode.recorder import record
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.meeting import meet
from fo_gym.evaluation.runs.seeds import LEADERBOARD_SEEDS, TRAINING_SEEDS, VALIDATION_SEEDS, first

# evaluate


@pytest.fixture(scope="module")
def scores() -> dict[str, pd.DataFrame]:
    """Everybody on the first half second of the single link."""
    return {name: evaluate(name, STICTION, duration=0.5) for name in ("none", "ideal", *SIX)}


def test_a_meeting_is_short_everywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever an environment does later, the first moments of its episodes can be run."""
    ticks = []
    monkeypatch.setattr(
        "fo_gym.evaluation.runs.episodes.record", lambda *run: ticks.append(record(*run).ended.tolist())
    )
    for env_id in ENVIRONMENTS:
        meet(competitor_of("pid-high"), EpisodeSet(env_id, "hardware", (1, 2), {}))
    assert ticks == [[50]] * len(ENVIRONMENTS)


def test_columns_and_their_order(scores: dict[str, pd.DataFrame]) -> None:
    expected = [*KEYS, "seed", "status", "error", *METRICS, "joint_unit", *PROVENANCE]
    assert expected[7] == "frr"
    assert all(list(table) == expected for table in scores.values())
    row = scores["pid-low"].iloc[0]
    assert row[[*KEYS, "status", "error", "joint_unit"]].tolist() == [
        STICTION,
        "single_link",
        "nominal",
        "pid-low",
        "ok",
        "",
        "m",
    ]
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
    assert scores["none"]["seed"].tolist() == [0]
    assert len(evaluate("none", STICTION, variant="randomized", duration=0.01)) == 20
    numpy = evaluate("none", STICTION, variant="randomized", seeds=np.array([4, 2]), duration=0.01)  # type: ignore[arg-type]
    assert numpy["seed"].tolist() == [4, 2]


def test_an_environment_is_the_same_however_it_is_named() -> None:
    """Gains, columns and hash are those of its id; these gains are of this environment alone."""
    one, other = (evaluate("eso-tuned", name, duration=0.1) for name in (STICTION, f"fo_gym:{STICTION}"))
    pd.testing.assert_frame_equal(one, other)


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
