"""Protocols: the shipped ones, files, what is refused, and the stamp."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import pytest
from tables import SIX, SQUARE, STICTION

from fo_gym import ENVIRONMENTS
from fo_gym.evaluation.runs.contest import competitors_of
from fo_gym.evaluation.runs.protocol import Protocol, load_protocol, shipped_protocols
from fo_gym.tasks.variants import VARIANTS

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
    assert set(shipped_protocols()) == {"full", "laws", "quick"}
    full, quick = load_protocol("full"), load_protocol("quick")
    assert load_protocol("laws").compensators == full.compensators
    assert set(full.environments) <= set(ENVIRONMENTS)
    assert (full.split, full.seeds, full.variants) == ("leaderboard", 20, VARIANTS)
    assert set(SIX) <= set(full.compensators)
    assert set(quick.compensators) < set(full.compensators)
    assert replace(full, name="quick", seeds=2, compensators=quick.compensators) == quick
    assert full.seeds_of("randomized") == tuple(range(2_000_000_000, 2_000_000_020))
    assert full.seeds_of("nominal") == tuple(range(20))
    assert SMALL.seeds_of("randomized") == (1_000_000_000, 1_000_000_001)


@pytest.mark.parametrize("name", shipped_protocols())
def test_everybody_in_a_shipped_protocol_exists(name: str) -> None:
    competitors = competitors_of(load_protocol(name))
    assert [each.name for each in competitors if not each.content.files] == []


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
        ('"validation"', '"training"', "split is 'training'; allowed are 'leaderboard', 'validation'"),
        ("FJRSquare-v0", "CartPole-v1", "unknown environment 'CartPole-v1'; known are FJRStiction-v0"),
        ('"randomized"', '"virtual"', "unknown variant 'virtual'; known are nominal, randomized, hardware"),
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
    with pytest.raises(ValueError, match=r"no protocol 'fulll'.*full, laws, quick"):
        load_protocol("fulll")


CHANGES = {
    "name": "large",
    "split": "leaderboard",
    "seeds": 3,
    "environments": (STICTION,),
    "variants": ("nominal",),
    "compensators": ("pd-low",),
    "robots": {"mine": "miro_like"},
    "laws": ("Dahl",),
}


def test_the_stamp_tells_protocols_apart() -> None:
    assert set(CHANGES) == {field.name for field in fields(Protocol)}
    others = [replace(SMALL, **{name: value}) for name, value in CHANGES.items()]  # type: ignore[arg-type]
    stamps = {each.stamp for each in (SMALL, *others)}
    assert len(stamps) == len(CHANGES) + 1
    assert replace(SMALL).stamp == SMALL.stamp
    assert SMALL.stamp.startswith("small@")
