"""The cloud of the nominal episode: where it starts, that it is small, and what rows make of it."""

from __future__ import annotations

import numpy as np
import pytest
from tables import SQUARE, STICTION

from fo_gym import evaluate
from fo_gym.compensators import Ideal, NoCompensation
from fo_gym.evaluation.episode.recorder import record
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.results.ties import RELEVANT
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.cloud import CLOUD
from fo_gym.evaluation.runs.contest import Contest, competitors_of, episodes_in
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.evaluation.runs.run import run_contests

SHORT = {"duration": 0.05}


def test_seed_0_is_the_episode_and_the_others_start_beside_it() -> None:
    own = record(NoCompensation(), "none", SQUARE, "nominal", (3,), SHORT)
    cloud, ideal = (
        EpisodeSet(SQUARE, "nominal", (0, 1, 2), SHORT).record(who, "x") for who in (NoCompensation(), Ideal())
    )
    np.testing.assert_array_equal(cloud.ticks["theta"][:, 0], own.ticks["theta"][:, 0])
    for name in ("theta", "q", "theta_n"):
        moved = cloud.ticks[name][0, 1:] - cloud.ticks[name][0, 0]
        np.testing.assert_allclose(np.abs(moved), CLOUD, rtol=1e-6)
        assert (np.sign(moved[0]) != np.sign(moved[1])).any()
        np.testing.assert_array_equal(ideal.ticks[name][0], cloud.ticks[name][0])
    np.testing.assert_array_equal(cloud.ticks["theta_n"][0], cloud.ticks["theta"][0])
    np.testing.assert_array_equal(cloud.ticks["theta_d"][:, 1], cloud.ticks["theta_d"][:, 0])


def test_a_start_does_not_depend_on_its_neighbours() -> None:
    both, alone = (
        EpisodeSet(STICTION, "nominal", seeds, SHORT).record(NoCompensation(), "none") for seeds in ((0, 7), (7,))
    )
    np.testing.assert_array_equal(both.ticks["theta"][:, 1:], alone.ticks["theta"])


def test_drawn_episodes_have_no_cloud() -> None:
    own = record(NoCompensation(), "none", STICTION, "randomized", (3,), SHORT)
    episodes = EpisodeSet(STICTION, "randomized", (3,), SHORT)
    np.testing.assert_array_equal(episodes.record(NoCompensation(), "none").ticks["theta"], own.ticks["theta"])


def test_a_calm_row_does_not_spread() -> None:
    """In 1 s nothing hunts yet; what the cloud changes is far below what counts, but it changes something."""
    frr = evaluate("pid-high", STICTION, seeds=4, duration=1.0)["frr"]
    assert 0.0 < np.ptp(frr) < 0.1 * RELEVANT
    assert frr[0] == evaluate("pid-high", STICTION, duration=1.0)["frr"][0]


def test_a_nominal_row_has_an_interval_and_its_trace_is_seed_0() -> None:
    protocol = Protocol("small", "leaderboard", 5, (STICTION,), ("nominal",), ("pd-low",))
    (episodes,) = episodes_in(protocol)
    assert episodes.seeds == (0, 1, 2, 3, 4)
    short = EpisodeSet(episodes.env_id, episodes.variant, episodes.seeds, {"duration": 0.5})
    results = run_contests([Contest(short, competitors_of(protocol))], "", backend=Processes(1))
    row = leaderboard(results.episodes).set_index("compensator").loc["pd-low"]
    assert row["episodes"] == 5
    assert row["frr_ci_low"] < row["frr"] < row["frr_ci_high"]
    names = results.episodes["compensator"].unique().tolist()
    expected = [(name, 0, "median") for name in names]
    assert [(trace.compensator, trace.seed, trace.place) for trace in results.traces] == expected


def test_a_number_of_seeds_asks_for_the_cloud() -> None:
    assert evaluate("none", STICTION, **SHORT)["seed"].tolist() == [0]
    assert evaluate("none", STICTION, seeds=3, **SHORT)["seed"].tolist() == [0, 1, 2]
    assert len(evaluate("none", STICTION, variant="randomized", **SHORT)) == 20
    with pytest.raises(ValueError, match="seeds"):
        evaluate("none", STICTION, seeds=0)
