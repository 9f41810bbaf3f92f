"""Traces: which episodes are kept, which ticks of them, and the files that they become."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tables import SQUARE, STICTION, synthetic

from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.episode.recording import References
from fo_gym.evaluation.episode.trace import BUCKETS, Trace, kept_ticks, write_traces
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.store import Store
from fo_gym.evaluation.runs.trial import Trial, competitor_trial, reference_trials
from fo_gym.files import read_csv

PD = Competitor("pd", "pd-high")
EPISODES = EpisodeSet(STICTION, "randomized", (1, 2, 3, 4), {"duration": 0.5}, traced=True)
SIGNALS = {"time", "theta", "theta_ideal", "theta_d", "tau_f", "tau_f_hat", "tau_m"}


@pytest.fixture(scope="module")
def references() -> References:
    return reference_trials(EPISODES)[0]


@pytest.fixture(scope="module")
def trial(references: References) -> Trial:
    """Four short episodes of an observer."""
    return competitor_trial(EPISODES, PD, references)


# Which ticks


def test_short_episodes_are_kept_whole_and_long_ones_are_bounded() -> None:
    noise = np.random.default_rng(0).normal(size=(20_001, 3))
    assert kept_ticks([noise[:BUCKETS]]).tolist() == list(range(BUCKETS))
    keep = kept_ticks([noise, noise[:, :1] ** 2])
    assert BUCKETS < len(keep) <= 3 * BUCKETS + 1
    assert (keep[0], keep[-1]) == (0, 20_000)
    assert np.all(np.diff(keep) > 0)


def test_one_tick_that_stands_out_is_kept_whatever_its_signal_and_size() -> None:
    """Beside signals a million times as large, and beside one that does not move."""
    for tick in (1, 777, 12_345, 19_999):
        small, large = np.zeros((20_001, 2)), np.linspace(0.0, 1e6, 20_001)[:, None]
        small[tick, 1] = 1e-6
        assert tick in kept_ticks([large, small, np.ones((20_001, 1))])


def test_stick_and_slip_is_drawn_as_it_was() -> None:
    """Hops within one tick or two, wherever they fall, are where they were and as high as they were."""
    ticks = np.arange(20_001)
    starts = range(500, 20_000, 1313)
    for length, error in ((1.0, 1e-12), (2.0, 0.5)):
        hops = np.sum([np.clip((ticks - start) / length, 0.0, 1.0) for start in starts], axis=0)
        keep = kept_ticks([-3.0 * hops[:, None], ticks[:, None] / 5.0])
        missed = np.abs(np.interp(ticks, keep, hops[keep]) - hops)
        assert missed.max() <= error
        assert np.count_nonzero(missed > 1e-12) <= 2 * len(starts)


def test_numbers_that_are_not_finite_are_no_obstacle() -> None:
    values = np.ones((5000, 1))
    values[4000:] = np.inf
    values[4500:] = np.nan
    assert len(kept_ticks([values, np.linspace(0, 1, 5000)[:, None]])) <= 3 * BUCKETS + 1


# Which episodes


def test_the_worst_the_median_and_the_best_are_kept(trial: Trial) -> None:
    frr = trial.rows.set_index("seed")["frr"].sort_values()
    assert [(trace.place, trace.seed) for trace in trial.traces] == [
        ("worst", frr.index[0]), ("median", frr.index[1]), ("best", frr.index[3])
    ]  # fmt: skip
    assert [trace.frr for trace in trial.traces] == [frr.iloc[0], frr.iloc[1], frr.iloc[3]]


def test_a_trace_is_what_happened(trial: Trial, references: References) -> None:
    recording = EPISODES.record(PD.make(STICTION, "randomized"), "pd")
    for trace in trial.traces:
        i = EPISODES.seeds.index(trace.seed)
        assert set(trace.signals) == SIGNALS
        assert {array.dtype for array in trace.signals.values()} == {np.dtype(np.float32)}
        ticks = np.rint(trace.signals["time"] / recording.dt).astype(int)
        assert (ticks[0], ticks[-1]) == (0, 500)
        expected = {name: recording.ticks[name][ticks, i] for name in ("theta", "theta_d")}
        expected["theta_ideal"] = references.ideal.theta[ticks, i]
        periods = np.minimum(ticks, 499)
        expected |= {name: recording.periods[name][periods, i] for name in ("tau_f", "tau_f_hat", "tau_m")}
        for name, values in expected.items():
            np.testing.assert_array_equal(trace.signals[name], values.astype(np.float32), err_msg=name)


def test_the_nominal_episode_is_kept_in_any_case_and_others_where_asked() -> None:
    for variant, traced, places in (("nominal", False, ["median"]), ("randomized", True, ["worst", "best"])):
        episodes = EpisodeSet(SQUARE, variant, (1, 2)[: len(places)], {"duration": 0.05}, traced)
        found, (none, ideal, _) = reference_trials(episodes)
        assert [trace.place for trace in none.traces] == [trace.place for trace in ideal.traces] == places
        assert {"tool", "tool_d", "tool_ideal"} < set(none.traces[0].signals)
        (asked,) = {len(each.traces) for each in (none, competitor_trial(episodes, PD, found))}
        assert asked == len(places)
    episodes = replace(episodes, traced=False)
    assert all(each.traces == () for each in reference_trials(episodes)[1])


def test_what_has_no_score_has_no_trace(references: References) -> None:
    broken = competitor_trial(EPISODES, Competitor("x", "nowhere.py:X"), references)
    assert (broken.failed, broken.traces) == (True, ())


# The store


def test_the_store_keeps_traces_and_computes_again_what_has_none(trial: Trial, tmp_path: Path) -> None:
    store = Store(tmp_path, notice=pytest.fail)
    plain = replace(EPISODES, traced=False)
    assert store.path_of(plain, PD) == store.path_of(EPISODES, PD)
    store.save(plain, PD, replace(trial, traces=()))
    assert store.load(plain, PD) is not None
    assert store.load(EPISODES, PD) is None
    store.save(EPISODES, PD, trial)
    for episodes in (plain, EPISODES):
        loaded = store.load(episodes, PD)
        assert loaded is not None
        for trace, again in zip(trial.traces, loaded.traces, strict=True):
            assert replace(trace, signals={}) == replace(again, signals={})
            assert list(trace.signals) == list(again.signals)
            for name, values in trace.signals.items():
                np.testing.assert_array_equal(again.signals[name], values, strict=True)


# The files


def test_every_trace_is_a_file_that_the_index_names(trial: Trial, tmp_path: Path) -> None:
    index = write_traces(trial.traces, trial.rows, tmp_path / "traces")
    table = read_csv(index.read_text(encoding="utf-8"))
    assert list(table) == [
        *("env", "robot", "variant", "compensator", "seed", "place", "status", "frr", "joint_unit", "origin"),
        *("competitor_hash", "protocol", "ticks", "file"),
    ]
    assert table["file"].tolist() == [
        f"{STICTION}/single_link/randomized/pd.{place}.npz" for place in ("worst", "median", "best")
    ]
    scores = trial.rows.set_index("seed")["frr"]
    assert table["frr"].tolist() == pytest.approx(scores[table["seed"]].tolist(), rel=1e-5)
    for trace, row in zip(trial.traces, table.to_dict("records"), strict=True):
        with np.load(index.parent / row["file"], allow_pickle=False) as arrays:
            assert set(arrays.files) == SIGNALS
            assert {len(arrays[name]) for name in arrays.files} == {row["ticks"]}
            np.testing.assert_array_equal(arrays["theta"], trace.signals["theta"])
    first = {path: hashlib.sha256(path.read_bytes()).digest() for path in tmp_path.rglob("*") if path.is_file()}
    assert len(first) == 4
    write_traces(trial.traces, trial.rows, tmp_path / "traces")
    assert {path: hashlib.sha256(path.read_bytes()).digest() for path in first} == first


def test_no_name_leaves_the_folder_or_takes_the_file_of_another(tmp_path: Path) -> None:
    names = [
        "pd",
        "../../pd",
        "a/b.py:C",
        "a_b.py:C",
        "a-b",
        "a b",
        "a.b",
        "..",
        "",
        "x" * 300,
        "x" * 301,
        "\ud800",
        "\n",
    ]
    rows = synthetic({name: [0.5] for name in names})
    signals = {"time": np.zeros(1, np.float32)}
    traces = [Trace(SQUARE, "miro_like", "randomized", name, 0, "worst", 0.5, "rad", signals) for name in names]
    index = write_traces(traces, rows, tmp_path / "traces")
    files = [str(name) for name in read_csv(index.read_text(encoding="utf-8"))["file"]]
    assert len(set(map(str.lower, files))) == len(names)
    written = {path.relative_to(index.parent).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert written == {*files, "index.csv"}
    assert max(len(Path(file).name) for file in files) < 100


def test_an_index_without_traces_has_its_columns(tmp_path: Path) -> None:
    index = write_traces([], synthetic({"a": [math.nan]}), tmp_path)
    table = pd.read_csv(index)
    assert (len(table), list(table)[:6]) == (0, ["env", "robot", "variant", "compensator", "seed", "place"])
