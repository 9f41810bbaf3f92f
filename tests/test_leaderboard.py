"""From rows to the leaderboard: columns, means, intervals, ranks, verdicts, and what is said about them."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from tables import KEYS, REGULATION, SQUARE, STICTION, synthetic

from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.results.leaderboard import STANDING, is_baseline, leaderboard, overall, standings
from fo_gym.evaluation.results.tables import finding, rankings
from fo_gym.evaluation.results.ties import LEVEL
from fo_gym.evaluation.runs.provenance import provenance

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
    others = [name for name in METRICS if name != "frr"]
    assert list(table) == [*expected, *STANDING, *others, "joint_unit", *provenance()]
    assert table["compensator"].tolist() == list(KNOWN)
    assert table["episodes"].tolist() == [20] * 5
    assert table["protocol"].tolist() == ["p@0"] * 5


def test_means_are_interquartile_and_inside_their_interval() -> None:
    table = leaderboard(
        synthetic({"a": [0.0, 0.4, 0.6, 99.0], "b": [0.1] * 4}, steady_state_error_ju=[1.0, 2.0, 4.0, 99.0])
    )
    assert table["frr"].tolist() == pytest.approx([0.5, 0.1])
    assert table["steady_state_error_ju"].tolist() == pytest.approx([3.0, 3.0])
    assert table["joint_rms_error_ju"].isna().all()
    assert table["frr_ci_low"][0] < 0.5 < table["frr_ci_high"][0]
    assert table.loc[1, ["frr_ci_low", "frr_ci_high"]].tolist() == pytest.approx([0.1, 0.1])


def test_shares_are_shares_and_hunting_is_told_of_the_episodes_that_hunt() -> None:
    """Of four episodes one does not apply, and of the other three two hunt, by 3 and 5."""
    hunting = {"hunting_ratio": [1.0, math.nan, 0.0, 1.0], "limit_cycle_peak_to_peak_ju": [3.0, math.nan, 1e-9, 5.0]}
    table = leaderboard(synthetic({"a": [0.9] * 4}, **hunting))
    assert table["hunting_ratio"][0] == pytest.approx(2.0 / 3.0)
    assert table["limit_cycle_peak_to_peak_ju"][0] == pytest.approx(4.0)
    calm = leaderboard(synthetic({"a": [0.9] * 4}, hunting_ratio=0.0, limit_cycle_peak_to_peak_ju=1e-9)).iloc[0]
    assert calm["hunting_ratio"] == 0.0
    assert math.isnan(calm["limit_cycle_peak_to_peak_ju"])


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
    close = synthetic({"best": list(BASE), "behind": list(BASE - 0.002)})
    assert standings(close)["verdict"].tolist() == ["best", "behind"]
    assert standings(close.sample(frac=1.0, random_state=3))["verdict"].tolist() == ["best", "behind"]


@pytest.mark.parametrize("variant", ["randomized", "nominal"])
def test_what_no_robot_could_show_is_tied(variant: str) -> None:
    """However steady, a difference below the smallest relevant one ranks nobody, of one episode neither."""
    for count in (20, 1):
        frr = {"best": list(BASE[:count]), "tied": list(BASE[:count] - 0.0009), "behind": list(BASE[:count] - 0.0011)}
        table = standings(synthetic(frr, variant))
        assert table["verdict"].tolist() == ["best", "tied", "behind"]
        assert table["tied_group"].tolist() == ["a", "ab", "b"]


def test_many_rows_ask_for_more() -> None:
    """A difference that is significant of one pair is not where hundreds of other pairs are looked at as well."""
    source = np.random.default_rng(0)
    noise = source.normal(size=20)
    pair = {"best": list(BASE), "other": list(BASE - 0.01 + 0.0145 * (noise - noise.mean()))}
    crowd = {f"n{i}": list(BASE - 1.0 + 0.02 * source.normal(size=20)) for i in range(23)}
    alone, among = (standings(synthetic(frr)).set_index("compensator").loc["other"] for frr in (pair, pair | crowd))
    assert (alone["verdict"], among["verdict"]) == ("behind", "tied")
    assert alone["frr_to_best_p"] < LEVEL < among["frr_to_best_p"]
    assert among["frr_to_best_ci_low"] == alone["frr_to_best_ci_low"]


def test_a_new_competitor_leaves_the_other_rows_alone() -> None:
    """What is said of a row alone, and its difference to the best, stays to the bit; what needs the others may move."""
    small, large = synthetic(KNOWN), synthetic({"new": list(BASE[::-1] - 0.2), **KNOWN})
    moves = ["rank", "rank_ci_low", "rank_ci_high", "tied_group", "frr_to_best_p"]
    before, after = (leaderboard(table).drop(columns=moves).to_csv(index=False) for table in (small, large))
    assert [line for line in after.splitlines() if ",new," not in line] == before.splitlines()


def test_standings_where_the_answer_is_known() -> None:
    table = leaderboard(synthetic(KNOWN)).set_index("compensator")
    assert table.loc[["none", "ideal"], STANDING].isna().all(axis=None)
    assert table["tied_group"].dropna().to_dict() == {"behind": "b", "best": "a", "tied": "a"}
    assert table.loc["best", ["rank_ci_low", "frr_to_best", "frr_to_best_ci_low"]].tolist() == [1, 0, 0]
    assert table.loc["behind", ["rank_ci_low", "rank_ci_high"]].tolist() == [3, 3]
    assert table.loc["tied", ["rank_ci_low", "rank_ci_high"]].tolist() == [1, 2]
    behind = table.loc["behind"]
    assert behind["frr_to_best_ci_low"] < behind["frr_to_best"] < behind["frr_to_best_ci_high"] < 0.0
    assert behind["frr_to_best"] == pytest.approx(-0.1, abs=0.02)


def test_the_difference_to_the_best_baseline_passes_over_what_learned_and_what_is_not_ours() -> None:
    frr = {"network": 0.9, "mine.py:Mine": 0.8, "pid": 0.7, "pd": 0.6}
    episodes = synthetic({name: list(BASE + level) for name, level in frr.items()})
    episodes["learned"] = episodes["compensator"] == "network"
    table = standings(episodes).set_index("compensator")
    assert table["frr_to_baseline"].to_dict() == pytest.approx({name: level - 0.7 for name, level in frr.items()})
    assert table["frr_to_best"].to_dict() == pytest.approx({name: level - 0.9 for name, level in frr.items()})
    assert standings(synthetic({"a": [0.1], "b": [0.2]}, learned=True))["frr_to_baseline"].isna().all()


BASELINES = [
    ("pid-high", "baseline", False, True),
    ("pid-high", "", False, True),
    ("rl-table", "baseline", False, True),
    ("network", "baseline", True, False),
    ("mine.py:Mine", "baseline", False, False),
    ("package.module:Mine", "baseline", False, False),
    ("mine", "submission", False, False),
    ("none", "reference", False, False),
]


def test_what_a_baseline_is() -> None:
    found = [(*case, is_baseline(*case[:2], learned=case[2])) for *case, _ in BASELINES]
    assert found == BASELINES


def test_equal_competitors_share_the_rank() -> None:
    table = standings(synthetic({"a": list(BASE), "b": list(BASE), "c": list(BASE - 0.4)}))
    assert table["rank"].tolist() == [1, 1, 3]
    assert table["rank_ci_low"].tolist() == [1, 1, 3]
    assert table["verdict"].tolist() == ["best", "tied", "behind"]


def three(levels: dict[str, tuple[float, float, float]], variant: str = "hardware") -> pd.DataFrame:
    """Episodes on all three environments, at these levels of frr, of which every second is 0.02 better."""
    sets = [
        synthetic({name: list(level[i] - 0.02 * (TURNS > 0)) for name, level in levels.items()}, variant, env)
        for i, env in enumerate((STICTION, REGULATION, SQUARE))
    ]
    return pd.concat(sets, ignore_index=True)


def test_overall_counts_every_environment_the_same() -> None:
    episodes = pd.concat([three({"a": (0.9, 0.8, 0.1), "b": (0.5, 0.5, 0.5)}), synthetic({"a": [1.0]}, "nominal")])
    table = overall(episodes)
    assert table[["env", "variant"]].drop_duplicates().to_numpy().tolist() == [["overall", "hardware"]]
    assert table["frr"].tolist() == pytest.approx([0.59, 0.49])
    assert table["episodes"].tolist() == [60, 60]
    assert table["verdict"].tolist() == ["best", "behind"]
    assert ((table["frr_ci_low"] < table["frr"]) & (table["frr"] < table["frr_ci_high"])).all()
    others = ["status", "error", "episodes", "frr", "frr_ci_low", "frr_ci_high"]
    assert list(table) == [*KEYS, *others, *STANDING, *provenance()]


def test_overall_needs_a_score_on_every_environment() -> None:
    episodes = three({"a": (0.9, 0.8, 0.1), "b": (0.95, 0.95, 0.95)})
    lost = (episodes["compensator"] == "b") & (episodes["env"] == SQUARE)
    episodes.loc[lost, ["status", "error", "frr"]] = ["failed", "KeyError: oops", math.nan]
    table = overall(episodes).set_index("compensator")
    assert table["rank"].fillna(0).to_dict() == {"a": 1, "b": 0}
    assert table.loc["b", ["status", "error"]].tolist() == ["failed", "KeyError: oops"]
    assert overall(synthetic(KNOWN)).empty
    absent = overall(episodes[~lost]).set_index("compensator")
    assert absent["rank"].fillna(0).to_dict() == {"a": 1, "b": 0}
    assert absent.loc["b", ["frr", "frr_ci_low", "frr_ci_high"]].isna().all()


def test_the_page_begins_with_all_environments_together() -> None:
    episodes = three({"a": (0.9, 0.8, 0.1), "none": (0.0, 0.0, 0.0)})
    everywhere, *single = rankings(episodes)
    assert everywhere.title == "All environments, hardware"
    assert everywhere.headings[:6] == ["rank", "compensator", "FRR", "1-FRR", "95 % interval", "ranks"]
    assert everywhere.cells[0][:5] == ["1", "a", "0.5900", "0.41", "0.41 ... 0.41"]
    assert everywhere.cells[0][5:] == ["1 ... 1", "a", "best"]
    assert everywhere.cells[1][5:] == ["", "", "reference"]
    assert [ranking.title for ranking in single] == [f"{env}, hardware" for env in (STICTION, REGULATION, SQUARE)]
    assert list(rankings(episodes, leaderboard(episodes)))[1:] == single


FINDING = (
    "In `hardware`, `b` is best on FJRStiction-v0, tied with nobody; `a` is best on FJRRegulation-v0, tied with "
    "`e` and `b`; `a` is best on FJRSquare-v0, tied with `e`. Behind the best, by more than chance and 0.001: "
    "everywhere: `c`; on FJRStiction-v0: `a`, `e`; on FJRSquare-v0: `b`; without a score somewhere: `d`."
)


def test_the_finding_names_who_is_tied_and_who_is_beaten() -> None:
    episodes = three({"a": (0.7, 0.8, 0.9), "e": (0.7, 0.8, 0.9), "b": (0.8, 0.799, 0.5), "c": (0.1, 0.1, 0.1)})
    noisy = (episodes["compensator"] == "b") & (episodes["env"] == REGULATION)
    episodes.loc[noisy, "frr"] += 0.05 * TURNS
    failed = synthetic({"d": [math.nan] * 20}, "hardware").assign(status="failed", error="oops")
    text = finding(leaderboard(pd.concat([episodes, failed])), "hardware")
    assert text == FINDING
    assert text.count(". ") == 1
    with pytest.raises(ValueError, match="no variant 'wild'; it has hardware"):
        finding(leaderboard(episodes), "wild")


def test_the_finding_where_nobody_is_beaten_or_scored() -> None:
    assert finding(leaderboard(synthetic({"a": [0.5]})), "randomized") == (
        f"In `randomized`, `a` is best on {SQUARE}, tied with nobody. "
        "Behind the best, by more than chance and 0.001: nobody."
    )
    assert f"nobody has a score on {SQUARE}. " in finding(leaderboard(synthetic({"a": [math.nan]})), "randomized")
