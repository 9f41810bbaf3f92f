"""Tuning: the search, its budget, what it chooses and leaves, and searches that were killed."""

from __future__ import annotations

import math
import re
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
from typer.testing import CliRunner

import baselines
from fo_gym import CompensatorError, make_compensator
from fo_gym.cli import app
from fo_gym.evaluation.competitors.entry import load_entry, shipped_entries
from fo_gym.evaluation.runs.processor import processor
from fo_gym.evaluation.runs.protocol import load_protocol
from fo_gym.evaluation.runs.seeds import LEADERBOARD_SEEDS, TRAINING_SEEDS, TUNING_SEEDS, VALIDATION_SEEDS, first
from fo_gym.evaluation.runs.store import Store
from fo_gym.evaluation.runs.trial import Trial, failed_trial
from fo_gym.tuning import study as study_module
from fo_gym.tuning.run import tune
from fo_gym.tuning.space import default_gains, search_space
from fo_gym.tuning.study import Case, run_study

MAKEFILE = (Path(__file__).parents[1] / "Makefile").read_text(encoding="utf-8")
STICTION, SQUARE = "FJRStiction-v0", "FJRSquare-v0"
CASE = Case("pid-high", STICTION, "randomized", trials=12, episodes=2, seed=0)
BEST = {"L": 200.0, "Lp": 40.0, "Li": 300.0}


def quality(gains):
    """A smooth score with its best at BEST."""
    return 1.0 - 0.1 * sum(math.log(gains[name] / best) ** 2 for name, best in BEST.items())


@pytest.fixture
def synthetic(monkeypatch):
    """A score without simulation, which notes the seeds that it was made for and the gains that it saw."""
    seen = {"seeds": [], "gains": []}

    def run(episodes, competitors, references):
        seen["seeds"].append(episodes.seeds)
        seen["gains"] += [dict(each.gains) for each in competitors]
        return [trial_of(seen.get("quality", quality)(each.gains)) for each in competitors]

    monkeypatch.setattr(study_module, "references_of", lambda episodes: (SimpleNamespace(motions=()),) * 2)
    monkeypatch.setattr(study_module, "trials_together", run)
    return seen


def trial_of(*frr):
    """A trial with these scores, one for each episode."""
    return Trial(pd.DataFrame({"frr": frr, "status": "ok", "processor": processor()}), None, ())


def kept_in(folder):
    """A store that must not complain."""
    return Store(folder, notice=pytest.fail)


class TestSearch:
    def test_it_starts_from_what_was_published_and_gets_better(self, synthetic, tmp_path):
        outcome = run_study(CASE, kept_in(tmp_path))
        first = outcome.trials.iloc[0]
        assert {name: first[name] for name in BEST} == {"L": 100.0, "Lp": 20.0, "Li": 100.0}
        assert outcome.trials["frr_tuning"].max() > first["frr_tuning"]
        assert quality(outcome.gains) == outcome.trials["frr_validation"].max()

    def test_only_trials_that_the_compensator_accepts_count(self, synthetic, tmp_path):
        outcome = run_study(CASE, kept_in(tmp_path))
        assert len(outcome.trials) == CASE.trials
        for gains in outcome.trials[list(BEST)].to_dict("records"):
            make_compensator("pid-high", **gains)
        for name, (low, high) in search_space("pid-high").items():
            assert outcome.trials[name].between(low, high).all()

    def test_where_nothing_is_better_the_published_gains_stay(self, synthetic, tmp_path):
        synthetic["quality"] = lambda gains: float(gains == default_gains("pid-high"))
        assert dict(run_study(CASE, kept_in(tmp_path)).gains) == default_gains("pid-high")

    def test_seeds_of_the_leaderboard_are_never_used(self, synthetic, tmp_path):
        run_study(CASE, kept_in(tmp_path))
        *searched, validation = synthetic["seeds"]
        (tuning,) = set(searched)
        assert tuning == tuple(TUNING_SEEDS[:2])
        assert validation == tuple(VALIDATION_SEEDS[: CASE.final_episodes])
        splits = (TRAINING_SEEDS, VALIDATION_SEEDS, TUNING_SEEDS, LEADERBOARD_SEEDS)
        for one in splits:
            for other in splits:
                assert one is other or one.stop <= other.start or other.stop <= one.start

    def test_finalists_meet_again_on_validation_seeds(self, synthetic, tmp_path):
        trials = run_study(CASE, kept_in(tmp_path)).trials
        met = trials[trials["frr_validation"].notna()]
        expected = {0, *trials["frr_tuning"].nlargest(study_module.FINALISTS).index}
        assert set(met.index) == expected

    def test_a_killed_search_goes_on_as_if_it_had_not_been(self, synthetic, tmp_path):
        def stop(gains):
            if len(synthetic["gains"]) > study_module.TOGETHER:
                raise KeyboardInterrupt
            return quality(gains)

        whole = run_study(CASE, kept_in(tmp_path / "whole")).trials
        synthetic["gains"].clear()
        synthetic["quality"] = stop
        with pytest.raises(KeyboardInterrupt):
            run_study(CASE, kept_in(tmp_path / "killed"))
        synthetic["quality"] = quality
        synthetic["gains"].clear()
        pd.testing.assert_frame_equal(run_study(CASE, kept_in(tmp_path / "killed")).trials, whole)
        trials_and_finals = CASE.trials + 1 + study_module.FINALISTS
        assert len(synthetic["gains"]) <= trials_and_finals - study_module.TOGETHER

    def test_a_finished_search_is_not_repeated(self, synthetic, tmp_path):
        run_study(CASE, kept_in(tmp_path))
        synthetic["gains"].clear()
        run_study(CASE, kept_in(tmp_path))
        assert synthetic["gains"] == []

    def test_another_seed_is_another_search(self, synthetic, tmp_path):
        one, other = (run_study(Case(*astuple(CASE)[:-1], seed), kept_in(tmp_path)).trials for seed in (0, 1))
        assert (one["L"] != other["L"]).any()

    def test_an_environment_goes_by_its_id(self):
        assert Case("pid-high", f"fo_gym:{STICTION}", "randomized", 12, 2, 0) == CASE
        with pytest.raises(ValueError, match="unknown environment 'FJRNothing-v0'"):
            Case("pid-high", "FJRNothing-v0", "randomized", 12, 2, 0)


def astuple(case):
    return (case.spec, case.env_id, case.variant, case.trials, case.episodes, case.seed)


class TestEverybody:
    """Makefile's TUNED: who has the same budget."""

    ROWS = re.search(r"^TUNED := ((?:.*\\\n)*.*)", MAKEFILE, re.MULTILINE).group(1).replace("\\", " ").split()

    def test_every_classical_family_with_free_gains_is_tuned(self):
        tuned = tuple(type(make_compensator(row)) for row in self.ROWS)
        families = [getattr(baselines, name) for name in baselines.__all__]
        free = [family for family in families if getattr(family, "search_space", None)]
        assert [family.__name__ for family in free if not issubclass(family, tuned)] == []
        assert len(set(tuned)) == len(self.ROWS)

    def test_what_was_tuned_is_run(self):
        assert set(shipped_entries()) <= set(load_protocol("full").compensators)

    @pytest.mark.parametrize("row", ROWS)
    def test_its_gains_are_taken_from_the_search(self, row, synthetic, tmp_path):
        """Three trials: the row's own gains first, then others that it accepts, all of them."""
        synthetic["quality"] = lambda gains: float(gains != default_gains(row))
        outcome = run_study(Case(row, STICTION, "randomized", 3, 1, 0), kept_in(tmp_path))
        assert synthetic["gains"][0] == pytest.approx(default_gains(row))
        assert set(outcome.gains) == set(search_space(row))
        for name, value in outcome.gains.items():
            assert getattr(make_compensator(row, **outcome.gains), name) == value
            assert value != default_gains(row)[name]


class TestRuns:
    def test_a_lost_episode_counts_as_lost_however_badly(self, monkeypatch, tmp_path):
        lost = {1.0: trial_of(0.5, -40.0), 2.0: trial_of(0.5, math.nan), 3.0: trial_of(0.5, 0.7)}
        monkeypatch.setattr(study_module, "references_of", lambda episodes: (SimpleNamespace(motions=()),) * 2)
        monkeypatch.setattr(study_module, "trials_together", lambda _, who, __: [lost[each.gains["L"]] for each in who])
        score = study_module._Scorer(CASE, (1, 2), kept_in(tmp_path))
        assert score([{"L": 2.0}]) == pytest.approx([-0.25])
        assert score([{"L": 1.0}, {"L": 2.0}, {"L": 3.0}]) == pytest.approx([-0.25, -0.25, 0.6])

    @pytest.mark.usefixtures("short_episodes")
    def test_trials_side_by_side_score_as_alone(self, tmp_path):
        sets = [{"L": 100.0, "Lp": 20.0, "Li": 100.0}, {"L": 50.0, "Lp": 5.0, "Li": 10.0}]
        together = study_module._Scorer(CASE, first(TUNING_SEEDS, 2), kept_in(tmp_path / "together"))(sets)
        alone = study_module._Scorer(CASE, first(TUNING_SEEDS, 2), kept_in(tmp_path / "alone"))
        assert together == [alone([gains])[0] for gains in sets]
        assert together[0] != together[1]

    def test_gains_that_it_fails_with_end_the_search(self, monkeypatch, tmp_path):
        monkeypatch.setattr(study_module, "references_of", lambda episodes: (SimpleNamespace(motions=()),) * 2)
        failed = lambda episodes, who, _: [failed_trial(episodes, each, "ZeroDivisionError: no") for each in who]  # noqa: E731
        monkeypatch.setattr(study_module, "trials_together", failed)
        with pytest.raises(CompensatorError, match=r"with gains \{'L': 100.0.*ZeroDivisionError: no"):
            run_study(CASE, kept_in(tmp_path))

    @pytest.mark.slow
    def test_the_command_writes_an_entry_that_protocols_take(self, tmp_path, monkeypatch):
        arguments = [
            "tune",
            "letien-high",
            "--env",
            SQUARE,
            "--trials",
            "2",
            "--episodes",
            "1",
            "--final-episodes",
            "1",
        ]
        outputs = []
        for jobs in ("1", "2"):
            out = tmp_path / jobs
            out.mkdir()
            monkeypatch.chdir(out)
            done = CliRunner().invoke(app, [*arguments, "--out", ".", "--jobs", jobs])
            assert done.exit_code == 0, done.output
            outputs.append({file.relative_to(out): file.read_bytes() for file in out.rglob("*.[ct][so][vm]*")})
        assert outputs[0] == outputs[1]
        assert len(outputs[0]) == 3
        entry = load_entry(tmp_path / "1" / "letien-tuned.toml")
        assert (entry.name, entry.spec, entry.authors) == ("letien-tuned", "letien-high", ("The fo-gym authors",))
        assert set(entry.sets) == {(SQUARE, variant) for variant in ("nominal", "randomized", "hardware")}
        assert entry.gains_on(SQUARE, "nominal") == entry.gains_on(SQUARE, "randomized")
        trials = pd.read_csv(tmp_path / "1" / "letien-tuned" / f"{SQUARE}-hardware.csv")
        chosen = trials.loc[trials["frr_validation"].idxmax(), "L"]
        assert entry.gains_on(SQUARE, "hardware")["L"] == pytest.approx(chosen, rel=1e-5)

    def test_progress_is_told(self, synthetic, tmp_path):
        told = []
        case, store = Case("pid-high", STICTION, "hardware", 2, 1, 0), kept_in(tmp_path)
        tune([case], "x", tmp_path, store=store, command="", on_case=told.append)
        assert told[0].startswith(f"{STICTION} hardware: ")
