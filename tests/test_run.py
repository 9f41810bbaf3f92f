"""A whole protocol: everybody meets the same episodes, nobody spoils it for the others, and the files are the same."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import fo_gym
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.results.leaderboard import leaderboard, standings
from fo_gym.evaluation.results.report import write_results
from fo_gym.evaluation.runs.contest import Results
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.evaluation.runs.run import run_protocol
from fo_gym.evaluation.runs.seeds import LEADERBOARD_SEEDS
from fo_gym.specs import BUILT_IN

pytestmark = pytest.mark.usefixtures("short_episodes")
SQUARE = "FJRSquare-v0"
KEY = ["variant", "compensator"]
BROKEN = '''\
import numpy as np


class Late:
    """Works for three ticks."""

    feedback = "measured"

    def reset(self, joints, num_envs):
        self.tick = 0

    def estimate(self, signals):
        self.tick += 1
        if self.tick > 3:
            raise KeyError("no | such [key]\\nin my table")
        return np.zeros_like(signals.theta)


class Pushy(Late):
    """Pushes the joints out of their range."""

    def estimate(self, signals):
        return np.full_like(signals.theta, -150.0)
'''
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where the strangers' file lies, as the working directory."""
    folder = tmp_path_factory.mktemp("run")
    (folder / "theirs.py").write_text(BROKEN, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield folder


@pytest.fixture(scope="module")
def protocol() -> Protocol:
    """A competitor that fails, one whose episodes end early, one that does not exist, and one that works."""
    names = ("theirs.py:Late", "ideal", "theirs.py:Pushy", "nobody", "pid-high")
    return Protocol("small", "leaderboard", 2, (SQUARE,), ("nominal", "randomized"), names)


ORDER = [*BUILT_IN, "theirs.py:Late", "theirs.py:Pushy", "nobody", "pid-high"]


@pytest.fixture(scope="module")
def labels() -> list[str]:
    """What `on_run` was told, in the run of `results`."""
    return []


@pytest.fixture(scope="module")
def results(folder: Path, protocol: Protocol, labels: list[str]) -> Results:
    """The protocol, run in this process."""
    return run_protocol(protocol, jobs=1, on_run=labels.append)


@pytest.fixture(scope="module")
def out(folder: Path, protocol: Protocol, results: Results) -> Path:
    """The results, written."""
    write_results(protocol, results, folder / "deep" / "out")
    return folder / "deep" / "out"


def test_every_competitor_has_every_episode_in_order(results: Results, protocol: Protocol) -> None:
    table = results.episodes
    first, second = LEADERBOARD_SEEDS[:2]
    expected = [("nominal", name, seed) for name in ORDER for seed in (0, 1)]
    expected += [("randomized", name, seed) for name in ORDER for seed in (first, second)]
    assert list(table[[*KEY, "seed"]].itertuples(index=False, name=None)) == expected
    assert set(table["env"]) == {SQUARE}
    assert set(table["protocol"]) == {protocol.stamp}


def test_a_failing_competitor_fails_alone(results: Results) -> None:
    status = results.episodes.groupby("compensator", sort=False)["status"].agg(set)
    assert status.to_dict() == {
        **{name: {"ok"} for name in ORDER},
        "theirs.py:Late": {"failed"},
        "nobody": {"failed"},
        "theirs.py:Pushy": {"terminated"},
    }
    errors = results.episodes.groupby("compensator")["error"].first()
    assert "CompensatorError: theirs.py:Late: estimate raised KeyError at tick 3" in errors["theirs.py:Late"]
    assert "unknown compensator 'nobody'" in errors["nobody"]
    assert errors["pid-high"] == ""
    failed = results.episodes[results.episodes["status"] == "failed"]
    assert failed[list(METRICS)].isna().all(axis=None)


def test_scores_are_those_of_evaluate(results: Results) -> None:
    alone = fo_gym.evaluate("pid-high", SQUARE, variant="randomized", seeds=LEADERBOARD_SEEDS[1:2])
    here = results.episodes[results.episodes["compensator"] == "pid-high"].tail(1).reset_index(drop=True)
    labels = ["protocol", "origin"]
    pd.testing.assert_frame_equal(alone.drop(columns=labels), here.drop(columns=labels), check_exact=True)


def test_every_row_says_where_its_competitor_is_from(results: Results) -> None:
    told = results.episodes.groupby("compensator", sort=False)[["origin", "competitor_hash"]].agg(set)
    assert [origin for (origin,) in told["origin"]] == ["reference"] * len(BUILT_IN) + ["baseline"] * 4
    hashes = [content for (content,) in told["competitor_hash"]]
    assert hashes[: len(BUILT_IN)] == [""] * len(BUILT_IN)
    assert hashes[ORDER.index("nobody")] == ""
    others = [content for content in hashes if content]
    assert len(set(others)) == 3
    assert all(re.fullmatch("[0-9a-f]{16}", content) for content in others)


def test_the_references_are_the_ends_of_the_scale(results: Results) -> None:
    frr = results.episodes.groupby("compensator")["frr"].agg(["min", "max"])
    assert frr.loc["none"].tolist() == [0.0, 0.0]
    assert frr.loc["ideal"].tolist() == [1.0, 1.0]
    assert frr.loc["theirs.py:Pushy", "max"] < -1.0


def test_the_seeds_make_a_difference(results: Results) -> None:
    assert results.episodes.query("compensator == 'pid-high'")["frr"].nunique() == 4


def test_progress_is_told_as_often_as_there_are_runs(results: Results, labels: list[str]) -> None:
    expected = [f"{SQUARE}, {variant}: none, ideal, bound" for variant in ("nominal", "randomized")]
    expected += [
        f"{SQUARE}, {variant}: {name}" for variant in ("nominal", "randomized") for name in ORDER[len(BUILT_IN) :]
    ]
    assert labels == expected
    assert len(results.timing) == 2 * (len(ORDER) - 2)


def test_nominal_episodes_leave_a_trace(results: Results) -> None:
    assert [trace.compensator for trace in results.traces] == [
        n for n in ORDER if n not in ("theirs.py:Late", "nobody")
    ]
    for trace in results.traces:
        assert (trace.variant, trace.place) == ("nominal", "median")
        assert {"tool", "tool_d", "tool_ideal"} < set(trace.signals)
        assert trace.signals["time"][-1] == pytest.approx(1.0)


def test_files(out: Path, protocol: Protocol, results: Results) -> None:
    texts = ["episodes.csv", "leaderboard.csv", "leaderboard.md", "processor.json", "timing.csv"]
    pictures = [f"figures/{SQUARE}.png", f"figures/ranking-{SQUARE}.png"]
    found = sorted(path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file())
    assert found == sorted([*texts, *pictures])
    for picture in pictures:
        content = (out / picture).read_bytes()
        assert content.startswith(PNG)
        assert len(content) > 10_000


def test_csv_files_hold_the_tables(out: Path, results: Results) -> None:
    for name, table in {"episodes.csv": results.episodes, "leaderboard.csv": leaderboard(results.episodes)}.items():
        read = pd.read_csv(out / name, keep_default_na=False, na_values=[""])
        assert list(read) == list(table)
        assert len(read) == len(table)
        np.testing.assert_allclose(read[list(METRICS)].astype(float), table[list(METRICS)], rtol=1e-5)
        assert "\r" not in (out / name).read_text(encoding="utf-8")


def test_nothing_tells_the_time(out: Path) -> None:
    text = (out / "leaderboard.csv").read_text(encoding="utf-8") + (out / "episodes.csv").read_text(encoding="utf-8")
    assert not re.search(r"\d{4}-\d\d-\d\d|\d\d:\d\d:\d\d", text)
    head = text.partition("\n")[0]
    assert not re.search(r"date|timestamp|_us\b|host", head)


def tables_of(page: str) -> dict[str, list[list[str]]]:
    """Headings of the page with the rows of their tables, cells split."""
    sections = {}
    for part in page.split("\n## ")[1:]:
        title, _, body = part.partition("\n")
        lines = [line for line in body.splitlines() if line.startswith("|")]
        sections[title] = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]
    return sections


def test_the_page_ranks_every_set(out: Path, results: Results) -> None:
    sections = tables_of((out / "leaderboard.md").read_text(encoding="utf-8"))
    sets = [f"{SQUARE}, nominal", f"{SQUARE}, randomized"]
    assert [title for title in sections if title.startswith("FJR")] == sets
    for title in sets:
        headings, rule, *rows = sections[title]
        assert set(rule) == {"---"}
        assert {len(row) for row in rows} == {len(headings)}
        cells = [dict(zip(headings, row, strict=True)) for row in rows]
        assert sorted(row["compensator"] for row in cells) == sorted(ORDER)
        ranked = [row for row in cells if row["rank"]]
        assert [row["rank"] for row in ranked] == ["1", "2"]
        assert cells[:2] == ranked
        frr = [float(row["FRR"]) for row in ranked]
        assert frr == sorted(frr, reverse=True)
        verdicts = {row["compensator"]: row["verdict"] for row in cells}
        assert verdicts["none"] == verdicts["ideal"] == "reference"
        assert verdicts[ranked[0]["compensator"]] == "best"
        assert re.match("(behind|tied); terminated: ", verdicts["theirs.py:Pushy"])  # two episodes tell few apart
        assert verdicts["theirs.py:Late"].startswith("failed: CompensatorError")
    assert standings(results.episodes)["rank"].tolist() == [1, 2] * 2


def test_the_page_says_where_it_is_from(out: Path, protocol: Protocol) -> None:
    page = (out / "leaderboard.md").read_text(encoding="utf-8")
    assert protocol.stamp in page
    assert fo_gym.__version__ in page
    assert all((out / link).is_file() for link in re.findall(r"!\[.*?\]\((.*?)\)", page))
    assert page.count("![") == 2


def test_results_are_written_over_older_ones(folder: Path, protocol: Protocol, results: Results) -> None:
    out = folder / "older"
    out.mkdir()
    (out / "episodes.csv").write_text("older", encoding="utf-8")
    written = write_results(protocol, results, out)
    assert (out / "episodes.csv").read_text(encoding="utf-8").startswith("env,robot,variant,compensator,seed,")
    assert sorted(written) == sorted(path for path in out.rglob("*") if path.is_file())


def test_results_in_which_everybody_failed_are_still_written(
    folder: Path, protocol: Protocol, results: Results
) -> None:
    names = ["none", "ideal", "theirs.py:Late"]
    rest = results.episodes[results.episodes["compensator"].isin(names)]
    write_results(protocol, Results(rest, results.timing.head(0), []), folder / "sad")
    rows = pd.read_csv(folder / "sad" / "leaderboard.csv")
    assert rows["status"].tolist() == ["ok", "ok", "failed"] * 2
    assert rows["compensator"].tolist() == names * 2
