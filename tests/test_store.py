"""The store: what is in it is not computed again, what changed is, and what is damaged never counts."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import pytest
from tables import SQUARE, STICTION

from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.competitors.content import Content
from fo_gym.evaluation.runs import store as store_module
from fo_gym.evaluation.runs.contest import Results
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.evaluation.runs.run import run_protocol
from fo_gym.evaluation.runs.store import Store, key_of
from fo_gym.evaluation.runs.trial import REFERENCES
from fo_gym.files import csv

NONE = REFERENCES[0]

MINE = """
from baselines import LeTienObserver


class Mine(LeTienObserver):
    def __init__(self, L=80.0):
        super().__init__(L)


class Sick(Mine):
    def reset(self, joints, num_envs):
        from pathlib import Path
        assert not Path("ill").exists(), "ill"
        super().reset(joints, num_envs)
"""
PROTOCOL = Protocol("small", "validation", 1, (SQUARE,), ("nominal",), ("mine.py:Mine", "pd-low"))
EPISODES = EpisodeSet(STICTION, "nominal", (7, 8), {})


class Run(NamedTuple):
    """The results of a run, what it told, and what it noticed."""

    results: Results
    told: list[str]
    noticed: list[str]


def run_it(protocol: Protocol = PROTOCOL, *, fresh: bool = False) -> Run:
    """Run a protocol with the store in the working directory."""
    told: list[str] = []
    noticed: list[str] = []
    store = Store(Path("store"), fresh=fresh, notice=noticed.append)
    return Run(run_protocol(protocol, store=store, on_run=told.append), told, noticed)


class First(NamedTuple):
    """A run with an empty store, and the folder in which it was."""

    run: Run
    folder: Path


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory, short_episodes: None) -> First:
    folder = tmp_path_factory.mktemp("first")
    (folder / "mine.py").write_text(MINE, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        return First(run_it(), folder)


@pytest.fixture
def first(original: First, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """The first run; the working directory is a copy of its folder."""
    shutil.copytree(original.folder, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return original.run


def trials() -> list[Path]:
    """The files of the store."""
    return sorted(Path("store").rglob("*.trial"))


def assert_same(one: Results, other: Results) -> None:
    pd.testing.assert_frame_equal(one.episodes, other.episodes, check_exact=True)
    assert csv(one.episodes) == csv(other.episodes)
    for trace, again in zip(one.traces, other.traces, strict=True):
        assert replace(trace, signals={}) == replace(again, signals={})
        for name, values in trace.signals.items():
            np.testing.assert_array_equal(again.signals[name], values)


# What is in it


def test_everything_comes_back_bit_by_bit(first: Run) -> None:
    assert (first.results.stored, first.results.runs) == (0, 3)
    again = run_it()
    assert (again.results.stored, again.results.runs) == (3, 3)
    assert again.told == [f"{label}, from the store" for label in first.told]
    assert_same(first.results, again.results)
    assert_same(first.results, run_protocol(PROTOCOL))
    pd.testing.assert_frame_equal(first.results.timing, again.results.timing, check_exact=True)
    assert len(trials()) == 5
    assert first.noticed == again.noticed == []


def test_a_changed_competitor_is_computed_alone(first: Run) -> None:
    Path("mine.py").write_text(MINE.replace("80.0", "90.0"), encoding="utf-8")
    after = run_it()
    assert after.results.stored == 1
    assert after.told[0] == f"{SQUARE}, nominal: pd-low, from the store"
    changed = first.results.episodes.compare(after.results.episodes)
    assert changed.index.tolist() == [3]
    assert {"frr", "competitor_hash"} <= set(changed.columns.get_level_values(0))


def test_protocols_share_what_they_have_in_common(first: Run) -> None:
    Path("again.toml").write_text('spec = "mine.py:Mine"\nauthors = ["A"]\nlink = ""\n', encoding="utf-8")
    other = run_it(replace(PROTOCOL, name="other", compensators=("pd-low", "again.toml")))
    assert other.results.stored == 3
    assert other.results.episodes["compensator"].tolist() == ["none", "ideal", "bound", "pd-low", "again"]
    assert other.results.timing["compensator"].tolist() == ["none", "ideal", "bound", "pd-low", "again"]
    assert set(other.results.episodes["protocol"].str.partition("@")[0]) == {"other"}


def test_fresh_computes_everything_and_replaces_it(first: Run) -> None:
    for path in trials():
        path.write_bytes(b"")
    fresh = run_it(fresh=True)
    assert (fresh.results.stored, fresh.noticed) == (0, [])
    assert_same(first.results, fresh.results)
    assert run_it().results.stored == 3


@pytest.mark.usefixtures("first")
def test_a_failed_run_is_tried_again() -> None:
    protocol = replace(PROTOCOL, compensators=("mine.py:Sick",))
    Path("ill").touch()
    assert run_it(protocol).results.episodes["status"].tolist() == ["ok", "ok", "ok", "failed"]
    assert len(trials()) == 5
    Path("ill").unlink()
    well = run_it(protocol)
    assert well.results.episodes["status"].tolist() == ["ok"] * 4
    assert (well.results.stored, len(trials())) == (0, 6)


# What is damaged


def _cut(content: bytes) -> bytes:
    return content[: len(content) // 2]


def _flip(content: bytes) -> bytes:
    return content[:-100] + bytes([content[-100] ^ 1]) + content[-99:]


def test_a_damaged_file_is_noticed_and_replaced(first: Run) -> None:
    whole = {path: path.read_bytes() for path in trials()}
    harmed, *_ = trials()
    harmed.write_bytes(_flip(whole[harmed]))
    again = run_it()
    assert len(again.noticed) == 1
    assert f"{harmed} is damaged" in again.noticed[0]
    assert_same(first.results, again.results)
    assert set(trials()) == set(whole)
    assert run_it().noticed == []


@pytest.mark.usefixtures("first")
@pytest.mark.parametrize("harm", [_cut, _flip, lambda content: b"", lambda content: b"\xff" * 99], ids=range(4))
def test_nothing_damaged_is_loaded(harm: Callable[[bytes], bytes]) -> None:
    noticed: list[str] = []
    store = Store(Path("store"), notice=noticed.append)
    episodes = EpisodeSet(SQUARE, "nominal", PROTOCOL.seeds_of("nominal"), {})
    assert store.load(episodes, NONE) is not None
    path = store.path_of(episodes, NONE)
    path.write_bytes(harm(path.read_bytes()))
    assert store.load(episodes, NONE) is None
    assert [text.partition(" (")[0] for text in noticed] == [f"{path} is damaged"]


@pytest.mark.usefixtures("first")
def test_a_store_that_cannot_be_written_stops_nothing() -> None:
    shutil.rmtree("store")
    Path("store").write_text("a file", encoding="utf-8")
    run = run_it()
    assert run.results.episodes["status"].tolist() == ["ok"] * 5
    assert len(run.noticed) == 5
    assert all("cannot be written" in text for text in run.noticed)


# What the key covers


def key(episodes: EpisodeSet = EPISODES, **competitor: Any) -> str:
    return key_of(episodes, Competitor(**{"name": "a", "spec": "pd-low", **competitor}))


def test_names_do_not_count() -> None:
    assert key() == key(name="b", origin="submission", authors=("A",), link="https://example.org")


@pytest.mark.parametrize(
    "episodes",
    [
        replace(EPISODES, env_id=SQUARE),
        replace(EPISODES, variant="randomized"),
        replace(EPISODES, seeds=(8, 7)),
        replace(EPISODES, seeds=(7,)),
        replace(EPISODES, env_kwargs={"duration": 1.0}),
    ],
)
def test_episodes_count(episodes: EpisodeSet) -> None:
    assert key(episodes) != key()


def test_gains_count_where_they_are_used() -> None:
    assert key(gains={"L": 60.0}) != key()
    assert key(sets={(STICTION, "nominal"): {"L": 60.0}}) == key(gains={"L": 60.0})
    assert key(sets={(SQUARE, "nominal"): {"L": 60.0}}) == key()
    assert len({key(), key(spec="pd-high"), key(spec="none"), key(spec="ideal")}) == 4


def test_the_suite_the_versions_and_the_processor_count(monkeypatch: pytest.MonkeyPatch) -> None:
    keys = {key()}
    suite = store_module.suite()
    changed = Content({**suite.files, "fo_gym.evaluation.metrics.rest": "other"}, suite.versions)
    monkeypatch.setattr(store_module, "suite", lambda: changed)
    keys.add(key())
    monkeypatch.setattr(store_module, "versions", lambda: {"version_numpy": "9.9"})
    keys.add(key())
    monkeypatch.setattr(store_module, "processor", lambda: "x86_64 other 00000000")
    keys.add(key())
    assert len(keys) == 4


@pytest.mark.usefixtures("first")
def test_what_another_kind_of_machine_computed_is_not_kept() -> None:
    """A worker of a cluster may be one."""
    store = Store(Path("store"), notice=print)
    episodes = EpisodeSet(SQUARE, "nominal", PROTOCOL.seeds_of("nominal"), {})
    trial = store.load(episodes, NONE)
    assert trial is not None
    store.path_of(episodes, NONE).unlink()
    store.save(episodes, NONE, replace(trial, rows=trial.rows.assign(processor="x86_64 other 00000000")))
    assert store.load(episodes, NONE) is None
    store.save(episodes, NONE, trial)
    assert store.load(episodes, NONE) is not None
