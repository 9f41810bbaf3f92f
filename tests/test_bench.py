"""The benchmark of speed: its mathematics on a machine that is made up, and `fo-gym bench`."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from environments import IDS
from typer.testing import CliRunner, Result

from fo_gym.bench import run
from fo_gym.bench.bars import BARS, verdict
from fo_gym.bench.measure import Subject, calls_per_slice, interleaved, seconds, spread
from fo_gym.bench.report import counts, page, write_bench
from fo_gym.bench.run import FULL, QUICK, Size, bench, count
from fo_gym.cli import app
from fo_gym.console import console
from fo_gym.extras import install_command

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"

ROWS = [
    ("batch", "MuJoCo twin"),
    ("batch", "MuJoCo forward"),
    ("single", "MuJoCo twin"),
    ("threads", "one thread"),
    ("growth", "fewer environments"),
    ("throughput", "Gymnasium sync"),
    ("throughput", "Gymnasium async"),
    ("throughput", "SB3 SubprocVecEnv"),
]


class Machine:
    """A machine on which time passes only as its subjects say; it may get slower and slower."""

    def __init__(self, slowing: float = 0.0) -> None:
        self.now = 100.0
        self.slowing = slowing
        self.log: list[str] = []

    def clock(self) -> float:
        return self.now

    def pass_time(self, cost: float) -> None:
        self.now += cost * (1.0 + self.slowing * (self.now - 100.0))

    def subject(self, name: str, cost: float, prepare: float = 7.0) -> Subject:
        def call() -> None:
            self.log.append(name)
            self.pass_time(cost)

        def get_ready() -> None:
            self.log.append(f"prepare {name}")
            self.now += prepare

        return Subject(call, get_ready)

    def turns(self) -> list[str]:
        """Who was timed when."""
        return [entry.removeprefix("prepare ") for entry in self.log if entry.startswith("prepare")]


# The mathematics


def test_only_the_calls_are_timed() -> None:
    machine = Machine()
    assert seconds(machine.subject("a", 0.25), 4, machine.clock) == pytest.approx(1.0)
    assert machine.log == ["prepare a", *["a"] * 5]


@pytest.mark.parametrize(("cost", "calls"), [(0.001, 150), (0.01, 15), (0.06, 2), (0.15, 1), (40.0, 1)])
def test_calls_of_a_slice(cost: float, calls: int) -> None:
    machine = Machine()
    assert calls_per_slice(machine.subject("a", cost), 0.15, machine.clock) == calls


def test_spread() -> None:
    assert spread(np.array([9.0, 1.0, 4.0, 2.0, 3.0])) == (3.0, 2.0, 4.0)
    assert spread(np.array([5.0])) == (5.0, 5.0, 5.0)


@pytest.mark.parametrize("repeats", [2, 6])
def test_everybody_comes_first_as_often_as_last(repeats: int) -> None:
    machine = Machine()
    names = ("a", "b", "c")
    subjects = [machine.subject(name, cost) for name, cost in zip(names, (0.1, 0.2, 0.4), strict=True)]
    times = interleaved(subjects, repeats, 0.4, machine.clock)
    np.testing.assert_allclose(times, np.tile([0.1, 0.2, 0.4], (repeats, 1)))
    turns = machine.turns()[-3 * repeats :]
    rounds = [turns[3 * i : 3 * i + 3] for i in range(repeats)]
    assert all(set(each) == set(names) for each in rounds)
    for first, second in combinations(names, 2):
        assert sum(each.index(first) < each.index(second) for each in rounds) == repeats // 2


def test_a_machine_that_slows_down_is_fair() -> None:
    """The ratio errs to either side in turn."""
    machine = Machine(slowing=1e-3)
    ours, peer = interleaved([machine.subject("ours", 1.0), machine.subject("peer", 1.0)], 10, 5.0, machine.clock).T
    ratios = ours / peer
    assert (ratios[::2] < 1.0).all()
    assert (ratios[1::2] > 1.0).all()
    assert spread(ratios).median == pytest.approx(1.0, abs=1e-3)
    assert ours[-1] > 1.1 * ours[0]


@pytest.mark.parametrize(
    ("measured", "ratio", "bar", "expected"),
    [
        ("batch", 0.25, 0.25, "holds"),
        ("batch", 0.26, 0.25, "misses"),
        ("single", 3.0, 2.0, "misses"),
        ("threads", 1.7, 1.7, "holds"),
        ("threads", 1.6, 1.7, "misses"),
        ("growth", 1.03, 1.02, "misses"),
        ("throughput", 8.0, 8.0, "holds"),
        ("throughput", 7.9, 8.0, "misses"),
        ("throughput", 7.9, np.nan, ""),
    ],
)
def test_verdict(measured: str, ratio: float, bar: float, expected: str) -> None:
    assert verdict(measured, ratio, bar) == expected


@pytest.fixture
def fixed_times(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ours takes 1, 2, 8 ms in three rounds, every peer 10, 10, 20 ms; nothing is opened."""

    def opener(peers: int) -> Callable:
        @contextmanager
        def nobody(*_: object, **__: object) -> Iterator[list[None]]:
            yield [None] * (1 + peers)

        return nobody

    def times(subjects: list[None], repeats: int, slice_seconds: float) -> np.ndarray:
        peers = [np.array([10.0, 10.0, 20.0])] * (len(subjects) - 1)
        return 1e-3 * np.stack([np.array([1.0, 2.0, 8.0]), *peers], axis=1)

    one = ("one_beside_mujoco", "threads_beside_one", "many_beside_few", "many_beside_peer")
    for name, peers in (("some_beside_mujoco", 2), *((name, 1) for name in one)):
        monkeypatch.setattr(run, name, opener(peers))
    monkeypatch.setattr(run, "interleaved", times)


def test_rows_are_medians_of_ratios(fixed_times: None) -> None:
    table = bench(IDS, FULL, on_group=lambda label: None).set_index(["env", "measured", "beside"]).sort_index()
    batch = table.loc[(STICTION, "batch", "MuJoCo twin")]
    # Ratios of the rounds are 0.1, 0.2 and 0.4; the ratio of the medians is 0.2, that of the means 0.275.
    assert batch[["ratio", "q1", "q3"]].tolist() == pytest.approx([0.2, 0.15, 0.3])
    assert batch[["ours_us", "peer_us"]].tolist() == pytest.approx([2000 / 256, 10000 / 256])
    assert batch["verdict"] == "misses"
    threads = table.loc[(STICTION, "threads", "one thread")]
    assert threads[["ratio", "ours_us", "peer_us"]].tolist() == pytest.approx([5.0, 2000 / 256, 10000 / 256])
    growth = table.loc[(STICTION, "growth", "fewer environments")]
    assert growth[["num_envs", "ours_us", "peer_us"]].tolist() == pytest.approx([1024, 2000 / 1024, 10000 / 64])
    # 16 times as many take 0.2 of the time in the middle round.
    assert growth["ratio"] == pytest.approx(np.log(0.2) / np.log(16.0))
    assert growth["verdict"] == "holds"
    single = table.loc[(REGULATION, "single", "MuJoCo twin")]
    assert single[["num_envs", "ours_us", "peer_us"]].tolist() == pytest.approx([1, 2000, 10000])
    many = table.loc[(STICTION, "throughput", "Gymnasium async")]
    assert many[["ratio", "q1", "q3"]].tolist() == pytest.approx([5.0, 3.75, 7.5])
    assert (many["bar"], many["verdict"]) == (8.0, "misses")
    assert table.loc[(REGULATION, "throughput", "Gymnasium async"), "verdict"] == "holds"
    assert table.loc[(SQUARE, "throughput"), "bar"].isna().all()
    assert (table.loc[(SQUARE, "throughput"), "verdict"] == "").all()
    assert counts(table) == f"{len(BARS)} bars measured: 14 hold, 5 missed"


def test_bars_are_about_their_number_of_environments(fixed_times: None) -> None:
    def judged(size: Size) -> set[tuple[object, ...]]:
        table = bench(IDS, size, on_group=lambda label: None)
        rows = table[table["bar"].notna()]
        return set(rows[["env", "measured", "beside", "num_envs"]].itertuples(index=False, name=None))

    assert judged(FULL) == set(BARS)
    assert judged(QUICK) == {key for key in BARS if key[1] == "single"}


# The command


def invoke(*arguments: str) -> Result:
    result = CliRunner().invoke(app, ["bench", *arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit), repr(result.exception)
    return result


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Path]:
    """The command at its smallest, and where it wrote."""
    out = tmp_path_factory.mktemp("bench") / "new" / "folder"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(console, "width", 140)  # so that the table does not fold its words
        return invoke("--quick", "--num-envs", "4", "--repeats", "2", "--out", str(out)), out


@pytest.mark.slow
def test_all_rows_are_there(quick: tuple[Result, Path]) -> None:
    result, out = quick
    assert result.exit_code == 0
    table = pd.read_csv(out / "bench.csv", keep_default_na=False, na_values=[""])
    assert list(table[["env", "measured", "beside"]].itertuples(index=False, name=None)) == [
        (env_id, *row) for env_id in IDS for row in ROWS
    ]
    numbers = table[["ratio", "q1", "q3", "ours_us", "peer_us"]].to_numpy()
    assert np.isfinite(numbers).all()
    assert (numbers[:, -2:] > 0.0).all()
    assert ((table["q1"] <= table["ratio"]) & (table["ratio"] <= table["q3"])).all()
    assert table["num_envs"].tolist() == [4, 4, 1, 4, 16, 2, 2, 2] * len(IDS)
    assert set(table.loc[table["bar"].notna(), "verdict"]) <= {"holds", "misses"}
    assert table["bar"].count() == 3
    assert (table["version_stable_baselines3"] != "").all()


@pytest.mark.slow
def test_the_page_says_what_the_table_says(quick: tuple[Result, Path]) -> None:
    result, out = quick
    assert {path.name for path in out.iterdir()} == {"bench.csv", "bench.md"}
    text = (out / "bench.md").read_text(encoding="utf-8")
    for env_id in IDS:
        for measured, beside in ROWS:
            assert text.count(f"| {env_id} | {measured} | {beside} |") == 1
            assert f"{env_id}, {measured}, beside " in result.stderr
    assert "mujoco 4" in text
    assert "3 bars measured" in text
    assert "3 bars measured" in result.stdout
    assert result.stdout.count("SB3 SubprocVecEnv") == len(IDS)


def test_nothing_is_written_unless_asked(fixed_times: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = invoke("--env", REGULATION, "--env", STICTION)
    assert result.exit_code == 0
    assert "missed" in result.stdout  # the table may fold its words
    assert SQUARE not in result.stdout
    assert list(tmp_path.iterdir()) == []


def test_a_missing_peer_is_a_row_that_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for module in ("stable_baselines3", "stable_baselines3.common.vec_env"):
        monkeypatch.setitem(sys.modules, module, None)
    tiny = Size(num_envs=2, few=1, most=2, many=2, repeats=1, slice_seconds=1e-3)
    done: list[str] = []
    table = bench([STICTION], tiny, on_group=done.append)
    assert len(done) == count([STICTION], tiny) == 7
    assert list(table[["measured", "beside"]].itertuples(index=False, name=None)) == ROWS
    missing = table.iloc[-1]
    assert missing[["ratio", "q1", "q3", "ours_us", "peer_us"]].isna().all()
    assert missing["verdict"].startswith("not measured: ")
    assert install_command("rl") in missing["verdict"]
    assert table["ratio"].notna().sum() == 7
    assert "not measured: " in page(table)
    write_bench(table, tmp_path)
    assert pd.read_csv(tmp_path / "bench.csv")["ratio"].isna().sum() == 1


def test_an_unknown_environment_is_refused() -> None:
    result = invoke("--env", STICTION, "--env", "Ant-v5")
    assert result.exit_code == 2
    assert "env is 'Ant-v5'; allowed are 'FJRStiction-v0', " in result.stderr
    assert result.stdout == ""


def test_help_shows_examples() -> None:
    result = invoke("--help")
    assert result.exit_code == 0
    assert "fo-gym bench --quick" in result.stdout
