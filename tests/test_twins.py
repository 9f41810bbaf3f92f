"""Perturbed twins of episodes, and what they and the tolerances say of a row that another processor computed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tables import SQUARE, STICTION
from typer.testing import CliRunner

from fo_gym.cli import app
from fo_gym.compensators import Ideal, NoCompensation
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.results.published import published
from fo_gym.evaluation.runs import verify
from fo_gym.evaluation.runs.comparison import CHAOTIC, MISMATCH, OTHER, SAME, WITHIN, Comparison, Difference, compared
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.processor import processor, processor_features
from fo_gym.evaluation.runs.store import key_of
from fo_gym.evaluation.runs.trial import REFERENCES
from fo_gym.evaluation.runs.twins import SHIFT, TwinSet, spread

NONE = REFERENCES[0]

Verified = Callable[..., tuple[int, list[str]]]

ROW = ("env", "nominal", "who", "1")
OLDER = (Difference("version_numpy", "1", "2"),)
ELSEWHERE = ("x86_64 other 00000000", "x86_64 here 11111111")
ALLOWED = METRICS["frr"].tolerance.of(0.9, "nominal")

PROTOCOL = f"""
name = "small"
split = "validation"
seeds = 1
environments = ["{SQUARE}"]
variants = ["nominal"]
compensators = ["pd-low", "mine.py:Chaos"]
"""
CHAOS = """
import numpy as np


class Chaos:
    '''Holds a torque that the logistic map chooses anew every 50 ticks; it begins at a last digit of theta.'''

    feedback = "measured"

    def reset(self, joints, num_envs):
        self.x = None
        self.tick = 0

    def estimate(self, signals):
        if self.x is None:
            self.x = 0.25 + 0.5 * (signals.theta * 1e11 % 1.0)
        if self.tick % 50 == 0:
            for _ in range(5):
                self.x = 4.0 * self.x * (1.0 - self.x)
        self.tick += 1
        return 2.0 * (self.x - 0.5)
"""


# Twins


@pytest.mark.parametrize("variant", ["nominal", "hardware"])
def test_a_twin_starts_next_to_its_episode(variant: str) -> None:
    """Motors are moved by the shift, to either side; all else that was drawn stays."""
    episodes = EpisodeSet(SQUARE, variant, (5, 6), {"duration": 0.02})
    own = episodes.record(NoCompensation(), "none")
    starts = []
    for number in (1, 2):
        twins = TwinSet(**vars(episodes), number=number)
        twin, ideal = twins.record(NoCompensation(), "none"), twins.record(Ideal(), "ideal")
        for name in ("theta", "q"):
            moved = twin.ticks[name][0] - own.ticks[name][0]
            np.testing.assert_allclose(np.abs(moved), SHIFT, rtol=1e-3)
            assert set(np.sign(moved).ravel()) == {-1.0, 1.0}
            np.testing.assert_array_equal(ideal.ticks[name][0], twin.ticks[name][0])
        np.testing.assert_allclose(twin.ticks["theta"], own.ticks["theta"], atol=1e-9, rtol=0.0)
        np.testing.assert_array_equal(twin.ticks["theta_d"], own.ticks["theta_d"])
        starts.append(twin.ticks["theta"][0])
    assert (starts[0] != starts[1]).any()


def test_a_twin_does_not_depend_on_its_neighbours() -> None:
    both = TwinSet(STICTION, "randomized", (5, 6), {"duration": 0.05}, number=3).record(NoCompensation(), "none")
    alone = TwinSet(STICTION, "randomized", (6,), {"duration": 0.05}, number=3).record(NoCompensation(), "none")
    np.testing.assert_array_equal(both.ticks["theta"][:, 1:], alone.ticks["theta"])


def test_a_store_never_takes_a_twin_for_its_episode() -> None:
    episodes = EpisodeSet(STICTION, "randomized", (5,), {})
    twins = [TwinSet(**vars(episodes), number=number) for number in (1, 2)]
    twins.append(replace(twins[0], shift=1e-9))
    assert len({key_of(each, NONE) for each in (episodes, *twins)}) == 4


def test_the_spread_of_twins() -> None:
    around = spread([1.0, 3.0, math.nan])
    assert [around.holds(value, 0.1) for value in (-1.2, -1.0, 2.0, 5.0, 5.2, math.nan)] == [0, 1, 1, 1, 0, 1]
    assert not spread([1.0, 3.0]).holds(math.nan, 0.1)
    assert not spread([math.nan, math.nan]).holds(1.0, 0.1)


# Verdicts


def row(frr: str = "0.9", status: str = "ok", error: str = "", where: str = ELSEWHERE[0]) -> dict[str, str]:
    return {"frr": frr, "status": status, "error": error, "processor": where}


def verdict(before: dict[str, str], now: dict[str, str], *twins: dict[str, str]) -> str:
    return compared(ROW, before, now | {"processor": ELSEWHERE[1]}).beside(twins).verdict


def test_verdicts_on_the_same_kind_of_processor() -> None:
    here = ELSEWHERE[1]
    assert verdict(row(where=here), row()) == SAME
    assert verdict(row("0.9000001", where=here), row("0.9")) == MISMATCH
    assert verdict(row("0.9000001", where=here), row("0.9"), row("0.95"), row("0.85")) == MISMATCH
    different = (Difference("frr", "1", "2"),)
    assert Comparison(ROW, (), OLDER).verdict == SAME
    assert Comparison(ROW, different, OLDER).verdict == OTHER
    assert Comparison(ROW, different, (), (here, here)).verdict == MISMATCH


@pytest.mark.parametrize("where", [ELSEWHERE[0], ""])
def test_verdicts_elsewhere(where: str) -> None:
    """Also where it is not known where."""
    near, far = str(0.9 + 0.9 * ALLOWED), str(0.9 + 1.1 * ALLOWED)
    assert verdict(row(where=where), row()) == SAME
    assert verdict(row(where=where), row(near)) == WITHIN
    assert verdict(row(where=where), row(far)) == MISMATCH
    assert verdict(row("0.5", where=where), row("0.9"), row("0.6"), row("0.8")) == CHAOTIC
    assert verdict(row("0.1", where=where), row("0.9"), row("0.6"), row("0.8")) == MISMATCH
    assert verdict(row("", where=where), row("0.9"), row("0.6"), row("")) == CHAOTIC
    assert verdict(row("", where=where), row("0.9"), row("0.6")) == MISMATCH


def test_an_early_end_may_come_at_another_time_where_twins_end_so_too() -> None:
    early = row("0.5", "terminated", "joint_limit at 1.234 s")
    late = row("0.6", "terminated", "joint_limit at 2.345 s")
    assert verdict(early, late) == MISMATCH
    assert verdict(early, late, early, late) == CHAOTIC
    assert verdict(early, row("0.5"), row("0.5")) == MISMATCH
    assert verdict(early, row("0.4"), late) == CHAOTIC
    assert verdict(row() | {"joint_unit": "m"}, row() | {"joint_unit": "rad"}) == MISMATCH


def test_a_column_that_is_missing_is_no_matter_of_tolerance() -> None:
    assert verdict(row() | {"older": "1"}, row(), row()) == MISMATCH
    assert verdict(row(), row() | {"steady_state_error_ju": "1"}, row() | {"steady_state_error_ju": "1"}) == MISMATCH


# The command


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the results of a calm competitor and of one that is chaotic throughout."""
    folder = tmp_path_factory.mktemp("elsewhere")
    (folder / "small.toml").write_text(PROTOCOL, encoding="utf-8")
    (folder / "mine.py").write_text(CHAOS, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(Competitor, "guarded", False)  # many short calls: a process of its own would take longer
        command = ["leaderboard", "--protocol", "small.toml", "--out", "out", "--jobs", "1"]
        assert CliRunner().invoke(app, command).exit_code == 0
    return folder


@pytest.fixture
def verified(original: Path, monkeypatch: pytest.MonkeyPatch) -> Verified:
    """Publish changed numbers as another processor's, and verify them: exit code and lines."""
    monkeypatch.chdir(original)
    monkeypatch.setattr(Competitor, "guarded", False)
    monkeypatch.setattr(verify, "TWINS", 3)  # a few do
    table = published(Path("out"))

    def run(where: str, **frr: float) -> tuple[int, list[str]]:
        """Add to the frr of the competitors that are named, and leave the rows of these alone."""
        names = {"calm": "pd-low", "chaos": "mine.py:Chaos"}
        chosen = {names[name]: change for name, change in frr.items()}
        some = table[table["compensator"].isin(chosen)].assign(processor=where)
        change = some["compensator"].map(chosen)
        changed = (some["frr"].astype(float) + change).map("{:.6g}".format).where(change != 0.0, some["frr"])
        Path("again").mkdir(exist_ok=True)
        some.assign(frr=changed).to_csv("again/episodes.csv", index=False)
        answer = CliRunner().invoke(
            app, ["verify", "again", "--sample", "9", "--protocol", "small.toml", "--jobs", "1"]
        )
        return answer.exit_code, answer.stdout.splitlines()

    return run


@pytest.mark.slow
def test_the_features_are_beside_the_rows(original: Path) -> None:
    rows = pd.read_csv(original / "out" / "episodes.csv")
    told = pd.read_json(original / "out" / "processor.json", typ="series", dtype=False)
    assert rows["processor"].unique().tolist() == [processor()] == list(told.index)
    assert told[processor()] == dict(processor_features())


@pytest.mark.slow
def test_elsewhere_a_calm_row_is_compared_within_tolerance(verified: Verified) -> None:
    code, lines = verified("x86_64 other 00000000", calm=0.5 * ALLOWED)
    assert code == 0
    assert lines[0] == (
        f"published on x86_64 other 00000000, here is {processor()}: compared within the tolerance of each metric"
    )
    assert lines[-1].startswith("1 rows of 1 runs: 0 same to the byte, 1 within tolerance, 0 chaotic")


@pytest.mark.slow
def test_a_chaotic_row_is_compared_with_its_twins(verified: Verified) -> None:
    code, lines = verified("x86_64 other 00000000", chaos=5e-4)
    assert (code, lines[-1]) == (
        0,
        "1 rows of 1 runs: 0 same to the byte, 0 within tolerance, 1 chaotic, 0 of other versions, 0 mismatch",
    )
    assert f"chaotic: {SQUARE} miro_like nominal mine.py:Chaos 0" in lines


@pytest.mark.slow
def test_wrong_numbers_are_found_elsewhere(verified: Verified) -> None:
    """In a calm episode, and in a chaotic one beyond the spread of its twins."""
    code, lines = verified("x86_64 other 00000000", calm=0.01, chaos=0.5)
    assert code == 2
    for name in ("pd-low", "mine.py:Chaos"):
        assert f"mismatch: {SQUARE} miro_like nominal {name} 0" in lines
    assert lines[-1].endswith("0 chaotic, 0 of other versions, 2 mismatch")


@pytest.mark.slow
def test_the_features_that_differ_are_told(verified: Verified, original: Path) -> None:
    features = dict(processor_features()) | {"cpu": "other", "libc": processor_features()["libc"]}
    pd.Series({"x86_64 other 00000000": features}).to_json(original / "again" / "processor.json")
    code, lines = verified("x86_64 other 00000000", calm=0.0)
    assert code == 0
    assert lines[1:-1] == [f"    cpu: other published, {processor_features()['cpu']} here"]
    (original / "again" / "processor.json").write_text("[]", encoding="utf-8")
    assert verified("x86_64 other 00000000", calm=0.0)[0] == 2
    (original / "again" / "processor.json").unlink()
