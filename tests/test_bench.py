"""The benchmark of speed: what becomes of times, and `fo-gym bench`."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from environments import IDS
from typer.testing import CliRunner, Result

from fo_gym.bench import accuracy, batches, growth, measurement, precision, run, yardsticks
from fo_gym.bench.bars import BARS, INTEGRATORS, twin_with
from fo_gym.bench.growth import power
from fo_gym.bench.precision import Match, Precision
from fo_gym.bench.report import KINDS, page, read_bench, write_bench
from fo_gym.bench.run import bench
from fo_gym.bench.size import FULL, QUICK, Size
from fo_gym.cli import app
from fo_gym.console import console
from fo_gym.extras import install_command

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"

OF_ALL = [
    *[("batch", peer, count) for count in (2, 4) for peer in ("MuJoCo twin", "MuJoCo forward")],
    ("single", "MuJoCo twin", 1),
    ("threads", "one thread", 4),
    *[("throughput", peer, 2) for peer in ("Gymnasium sync", "Gymnasium async", "SB3 SubprocVecEnv")],
    ("growth", "environments 1 to 16", 16),
    ("growth", "threads 1 to 2", 4),
    *[("compensator", "our step", count) for count in (1, 4)],
]
EQUAL = [
    *[("equal accuracy", f"MuJoCo twin, {name}", 4) for name in ("implicitfast", "euler", "rk4")],
    ("equal accuracy", "SciPy LSODA", 1),
]
ROWS = {
    *[(env_id, *row) for env_id in IDS for row in OF_ALL],
    *[(env_id, *row) for env_id in ("FJRStiction-v0", "FJRRegulation-v0") for row in EQUAL],
    ("FJRStiction-v0", "growth", "seconds 0.1 to 0.2", 1),
    ("FJRRegulation-v0", "growth", "joints 1 to 2", 4),
    ("FJRRegulation-v0", "yardstick", "Gymnasium Pusher-v5", 1),
}


def told(subjects: list[None], repeats: int, slice_seconds: float) -> np.ndarray:
    """Times of three rounds: the first takes 1, 2, 8 ms, everybody else 10, 10, 20 ms."""
    others = [np.array([10.0, 10.0, 20.0])] * (len(subjects) - 1)
    return 1e-3 * np.stack([np.array([1.0, 2.0, 8.0]), *others], axis=1)


def nobody(count: int) -> Callable:
    @contextmanager
    def opened(*_: object, **__: object) -> Iterator[list[None]]:
        yield [None] * count

    return opened


@pytest.fixture
def fixed_times(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is opened, and `told` says how long everybody takes; the peers err as they like."""
    for module in (measurement, growth):
        monkeypatch.setattr(module, "interleaved", told)
    peers = {"some_beside_mujoco": 2, "one_beside_mujoco": 1, "threads_beside_one": 1, "many_beside_peer": 1}
    for name, count in peers.items():
        monkeypatch.setattr(batches, name, nobody(1 + count))
    for module, name, count in (
        (accuracy, "some_beside_twins", 4),
        (accuracy, "one_beside_lsoda", 2),
        (yardsticks, "one_beside_pusher", 2),
        (yardsticks, "tick_beside_step", 2),
        (growth, "batches_of", len(FULL.batches)),
        (growth, "chains_of", len(FULL.joints)),
        (growth, "threads_of", len(FULL.threads)),
        (growth, "episodes_of", len(FULL.lengths)),
    ):
        monkeypatch.setattr(module, name, nobody(count))
    matches = [Match(name, ((1.0, 1.0),), 50.0, "as fine") for name in (*map(twin_with, INTEGRATORS), "SciPy LSODA")]
    found = Precision("m", 1e-6, tuple(matches[:-1]), matches[-1])
    monkeypatch.setattr(precision, "precision", lambda *_: found)


def measured(size: Size) -> pd.DataFrame:
    """Every ratio of all environments."""
    kinds = (batches.batches, accuracy.accuracies, growth.growths, yardsticks.yardsticks)
    chosen = [each for kind in kinds for each in kind(IDS, size)]
    return bench(chosen, told=lambda label: None)["bench"]


def test_rows_are_medians_of_ratios(fixed_times: None) -> None:
    table = measured(FULL).set_index(["env", "measured", "beside", "num_envs"]).sort_index()
    batch = table.loc[(STICTION, "batch", "MuJoCo twin", 256)]
    # Ratios of the rounds are 0.1, 0.2 and 0.4; the ratio of the medians is 0.2, that of the means 0.275.
    assert batch[["ratio", "q1", "q3"]].tolist() == pytest.approx([0.2, 0.15, 0.3])
    assert batch[["ours_us", "peer_us"]].tolist() == pytest.approx([2000 / 256, 10000 / 256])
    assert batch["verdict"] == "misses"
    assert table.loc[(STICTION, "batch", "MuJoCo twin", [1, 16, 1024]), "bar"].isna().all()
    threads = table.loc[(STICTION, "threads", "one thread", 256)]
    assert threads[["ratio", "ours_us", "peer_us"]].tolist() == pytest.approx([5.0, 2000 / 256, 10000 / 256])
    single = table.loc[(REGULATION, "single", "MuJoCo twin", 1)]
    assert single[["ours_us", "peer_us"]].tolist() == pytest.approx([2000, 10000])
    many = table.loc[(STICTION, "throughput", "Gymnasium async", 64)]
    assert many[["ratio", "q1", "q3"]].tolist() == pytest.approx([5.0, 3.75, 7.5])
    assert (many["bar"], many["verdict"]) == (8.0, "misses")
    assert table.loc[(REGULATION, "throughput", "Gymnasium async", 64), "verdict"] == "holds"
    equal = table.loc[(REGULATION, "equal accuracy", "MuJoCo twin, rk4", 256)]
    assert equal[["ratio", "bar"]].tolist() == pytest.approx([5.0, 40.0])
    assert equal[["verdict", "note"]].tolist() == ["misses", "as fine"]
    # A step of Pusher counts as five physics steps.
    pusher = table.loc[(REGULATION, "yardstick", "Gymnasium Pusher-v5", 1)]
    assert pusher[["ratio", "ours_us", "peer_us"]].tolist() == pytest.approx([1.0, 2000, 2000])


def test_a_growth_is_a_power(fixed_times: None) -> None:
    """The first size takes 1, 2, 8 ms, all others 10, 10, 20 ms: no growth from the second one on."""
    table = measured(FULL).set_index(["env", "measured", "beside"]).sort_index()
    row = table.loc[(STICTION, "growth", "environments 64 to 1024")]
    assert row[["num_envs", "ratio"]].tolist() == pytest.approx([1024, 0.0])
    assert row[["ours_us", "peer_us"]].tolist() == pytest.approx([10000 / 1024, 10000 / 64])
    assert row["verdict"] == "holds"
    whole = table.loc[(REGULATION, "growth", "joints 1 to 14")]
    sizes = np.log(FULL.joints) - np.mean(np.log(FULL.joints))
    assert whole["ratio"] == pytest.approx(-sizes[0] * np.log(5.0) / np.sum(sizes**2))


@pytest.mark.parametrize("exponent", [-1.0, 0.0, 1.02])
def test_the_power_of_a_power(exponent: float) -> None:
    points = np.array([1.0, 4.0, 7.0])
    times = np.array([[0.1], [3.0]]) * points**exponent
    np.testing.assert_allclose(power(points, times), exponent, atol=1e-12)


def test_bars_are_about_their_number_of_environments(fixed_times: None) -> None:
    def judged(size: Size) -> set[tuple[object, ...]]:
        table = measured(size)
        rows = table[table["bar"].notna()]
        return set(rows[["env", "measured", "beside", "num_envs"]].itertuples(index=False, name=None))

    assert judged(FULL) == set(BARS)
    same = replace(QUICK, batches=FULL.batches, joints=FULL.joints, threads=FULL.threads, lengths=FULL.lengths)
    assert judged(same) == {key for key in BARS if key[1] == "single"}


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
    tables = read_bench(out)
    table = tables["bench"]
    rows = list(table[["env", "measured", "beside", "num_envs"]].itertuples(index=False, name=None))
    assert set(rows) == ROWS
    assert len(rows) == len(ROWS)
    numbers = table[["ratio", "q1", "q3", "ours_us", "peer_us"]].to_numpy()
    assert np.isfinite(numbers).all()
    assert (numbers[:, -2:] > 0.0).all()
    assert ((table["q1"] <= table["ratio"]) & (table["ratio"] <= table["q3"])).all()
    assert set(table.loc[table["bar"].notna(), "verdict"]) <= {"holds", "misses"}
    assert table["bar"].count() == 3
    assert (table[["version_stable_baselines3", "version_pin"]] != "").all(axis=None)
    assert table.loc[table["measured"] == "equal accuracy", "note"].str.contains("ours").all()
    assert set(tables["growth"]["over"]) == {"environments", "joints", "threads", "seconds"}
    assert set(tables["precision"]["env"]) == {STICTION, REGULATION}
    assert tables["memory"]["env"].tolist() == [STICTION, REGULATION, SQUARE]
    assert (tables["memory"]["ours_mb"] > 0.0).all()
    assert tables["job"]["share"].sum() == pytest.approx(1.0, abs=1e-4)


@pytest.mark.slow
def test_the_page_says_what_the_tables_say(quick: tuple[Result, Path]) -> None:
    result, out = quick
    names = ("bench", "growth", "precision", "memory", "job")
    assert {path.name for path in out.iterdir()} == {"bench.md", "growth.png", *(f"{name}.csv" for name in names)}
    text = (out / "bench.md").read_text(encoding="utf-8")
    assert text == page(read_bench(out))
    for env_id, measured_, beside, num_envs in ROWS:
        assert text.count(f"| {env_id} | {measured_} | {beside} | {num_envs} |") == 1
    for title, explanation in KINDS.values():
        assert f"## {title}\n\n{explanation}\n" in text
    assert "![times over what they grow with](growth.png)" in text
    assert "mujoco 4" in text
    assert "3 bars measured" in text
    assert "3 bars measured" in result.stdout
    assert f"{STICTION}, equal accuracy" in result.stderr


def test_the_published_page_is_that_of_its_tables() -> None:
    folder = Path(__file__).parents[1] / "docs" / "bench"
    assert (folder / "bench.md").read_text(encoding="utf-8") == page(read_bench(folder))


def test_nothing_is_written_unless_asked(fixed_times: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(run, "_KINDS", (batches.batches,))
    result = invoke("--env", REGULATION, "--env", STICTION)
    assert result.exit_code == 0
    assert "missed" in result.stdout  # the table may fold its words
    assert SQUARE not in result.stdout
    assert list(tmp_path.iterdir()) == []


def test_a_missing_peer_is_a_row_that_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for module in ("stable_baselines3", "stable_baselines3.common.vec_env", "fo_gym.bench.precision", "imageio"):
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.delitem(sys.modules, "gymnasium.envs.mujoco", raising=False)
    for module in [name for name in sys.modules if name.startswith("gymnasium.envs.mujoco.")]:
        monkeypatch.delitem(sys.modules, module)
    tiny = replace(QUICK, num_envs=2, other_envs=(), repeats=1, slice_seconds=1e-3)
    chosen = [*batches.batches([REGULATION], tiny)[-1:], *accuracy.accuracies([REGULATION], tiny)]
    chosen += yardsticks.yardsticks([REGULATION], tiny)[-1:]
    done: list[str] = []
    tables = bench(chosen, told=done.append)
    assert len(done) == len(chosen)
    table = tables["bench"].set_index("beside")
    missing = table.loc[["SB3 SubprocVecEnv", *map(twin_with, INTEGRATORS), "SciPy LSODA", "Gymnasium Pusher-v5"]]
    assert missing[["ratio", "q1", "q3", "ours_us", "peer_us"]].isna().all(axis=None)
    assert missing["verdict"].str.startswith("not measured: ").all()
    assert missing["verdict"].str.contains(install_command("bench"), regex=False).all()
    assert len(missing) == len(table)
    write_bench(tables, tmp_path)
    assert "not measured: " in (tmp_path / "bench.md").read_text(encoding="utf-8")
    assert {path.name for path in tmp_path.iterdir()} == {"bench.csv", "bench.md"}


def test_an_unknown_environment_is_refused() -> None:
    result = invoke("--env", STICTION, "--env", "Ant-v5")
    assert result.exit_code == 2
    assert "env is 'Ant-v5'; allowed are 'FJRStiction-v0', " in result.stderr
    assert result.stdout == ""


def test_help_shows_examples() -> None:
    result = invoke("--help")
    assert result.exit_code == 0
    assert "fo-gym bench --quick" in result.stdout
