"""The study of the usual algorithms: its hyperparameters here and in RL-Zoo, its runs, and what it makes of them."""

from __future__ import annotations

import importlib
import inspect
from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from baselines.rl.study.__main__ import app
from baselines.rl.study.plan import ENVIRONMENTS, Run, Study, runs_of
from baselines.rl.study.recipe import SOURCES, Recipe
from baselines.rl.study.run import mean_return, perform
from baselines.rl.study.summary import ALL, collect, curves, figure, page, table
from fo_gym.evaluation.results.statistics import bootstrap_interval, interquartile_mean
from fo_gym.evaluation.runs.seeds import TRAINING_SEEDS
from fo_gym.files import atomic, csv

ROOT = Path(__file__).parents[1]
ZOO = ROOT / "examples" / "rl_zoo"
STICTION_ID = ENVIRONMENTS[0]
BRIEF = ("--seeds", "1", "--steps", "64", "--checkpoints", "1", "--episodes", "1", "--jobs", "1")
every_algorithm = pytest.mark.parametrize("algo", SOURCES)


def recipe(algo="ppo", **settings):
    """A recipe for moments: short episodes, few of them."""
    whole = Recipe.load(ZOO, algo)
    return replace(whole, n_envs=2, settings={**whole.settings, "duration": 0.3, **settings}).with_steps(
        64, checkpoints=2
    )


class TestRecipes:
    def test_there_is_one_for_each(self):
        assert {path.stem for path in ZOO.glob("*.yml")} == set(SOURCES)

    @every_algorithm
    def test_every_key_is_an_argument(self, algo):
        module, _, name = SOURCES[algo].partition(":")
        taken = inspect.signature(getattr(importlib.import_module(module), name)).parameters
        given = set(Recipe.load(ZOO, algo).arguments) - {"noise_type", "noise_std"}
        assert given <= set(taken)

    def test_what_is_not_there_is_told(self, tmp_path):
        with pytest.raises(ValueError, match=r"there is no .*ppo\.yml"):
            Recipe.load(tmp_path, "ppo")
        (tmp_path / "ppo.yml").write_text("default: {n_envs: 1, n_timesteps: 1, policy: MlpPolicy}")
        with pytest.raises(ValueError, match="env_wrapper is None"):
            Recipe.load(tmp_path, "ppo")


class TestRuns:
    def test_what_is_run(self):
        recipes = [Recipe.load(ZOO, algo) for algo in SOURCES]
        runs = runs_of(recipes, ENVIRONMENTS, 5)
        assert len({run.file(Path()) for run in runs}) == len(runs) == 5 * 3 * 7
        assert [run.recipe.algo for run in runs if run.action_mode == "torque"] == ["ppo"] * 15
        assert {run.seed for run in runs[:21]} == {0}
        assert all(run.episode_seed + run.recipe.n_envs - 1 in TRAINING_SEEDS for run in runs)

    def test_the_return_is_that_of_the_episodes(self):
        """Of an agent that does nothing, beside the sum of rewards of single environments."""

        class Nothing:
            def predict(self, observation, state, start, deterministic):
                return np.zeros((len(observation), 1)), None

        run = Run(recipe(), STICTION_ID, "compensation", 0)
        returns = []
        for seed in (1_000_000_000, 1_000_000_001):
            env = gym.make(STICTION_ID, **run.recipe.settings)
            env.reset(seed=seed)
            rewards = [env.step(np.zeros(1))[1] for _ in range(30)]
            returns.append(sum(rewards))
        assert mean_return(Nothing(), run, [1_000_000_000, 1_000_000_001]) == pytest.approx(np.mean(returns))

    @pytest.mark.slow
    @pytest.mark.usefixtures("one_torch_thread")
    @every_algorithm
    def test_every_algorithm_leaves_its_rows(self, algo, tmp_path):
        run = Run(recipe(algo), STICTION_ID, "compensation", 1)
        perform(run, Study((run.recipe,), 2, 2), tmp_path, tmp_path / "logs")
        rows = collect(tmp_path)
        assert rows["steps"].tolist() == [32, 64]
        assert set(rows["agent"]) == {algo}
        assert np.isfinite(rows[["return", "frr"]].to_numpy()).all()
        assert list((tmp_path / "logs").glob(f"{STICTION_ID}-{algo}-compensation-1_*/events*"))

    @pytest.mark.usefixtures("one_torch_thread", "short_episodes")
    def test_a_study_goes_on_where_it_was_killed(self, tmp_path):
        """What is there stays, what is missing comes again, the same to the byte."""
        asked = ["--out", str(tmp_path), "--zoo", str(ZOO), "--algo", "ppo", "--env", STICTION_ID, *BRIEF]
        assert CliRunner().invoke(app, asked).exit_code == 0
        kept, lost = sorted((tmp_path / "runs").iterdir())
        before = lost.read_bytes()
        lost.unlink()
        changed = kept.stat().st_mtime_ns
        assert CliRunner().invoke(app, asked).exit_code == 0
        assert kept.stat().st_mtime_ns == changed
        assert lost.read_bytes() == before
        for name in ("curves.csv", "table.csv", "table.md", "curves.png"):
            assert (tmp_path / name).stat().st_size > 0
        refused = CliRunner().invoke(app, [*asked, "--steps", "128"])
        assert refused.exit_code == 2

    @pytest.mark.parametrize(
        ("option", "name", "allowed"), [("--algo", "dqn", SOURCES), ("--env", "FJRTracking-v0", ENVIRONMENTS)]
    )
    def test_what_is_not_studied_is_refused_before_anything_is_trained(self, tmp_path, option, name, allowed):
        asked = ["--out", str(tmp_path), "--zoo", str(ZOO), "--algo", "ppo", *BRIEF]
        refused = CliRunner().invoke(app, [*asked, option, name])
        assert refused.exit_code == 2
        assert f"{option} is {name}; allowed are {', '.join(allowed)}" in " ".join(refused.output.split())
        assert not list(tmp_path.iterdir())


class TestSummary:
    @pytest.fixture
    def rows(self, tmp_path):
        rng = np.random.default_rng(0)
        for env in ENVIRONMENTS[:2]:
            for agent in ("ppo", "sac"):
                for run in range(5):
                    who = {"env": env, "agent": agent, "run": run}
                    lines = [{**who, "steps": s, "return": 100 * rng.random(), "frr": rng.random()} for s in (10, 20)]
                    atomic(tmp_path / "runs" / f"{env}-{agent}-{run}.csv", csv(pd.DataFrame(lines)))
        return collect(tmp_path)

    def test_the_table_is_of_the_last_checkpoint(self, rows):
        lines = table(rows).set_index(["env", "agent"])
        final = rows[(rows["env"] == STICTION_ID) & (rows["agent"] == "sac") & (rows["steps"] == 20)]["frr"]
        line = lines.loc[(STICTION_ID, "sac")]
        assert line["frr"] == interquartile_mean(final)
        assert (line["frr_low"], line["frr_high"]) == bootstrap_interval(final, np.random.default_rng(0))
        assert line["runs"] == 5
        together = lines.loc[(ALL, "sac")]
        assert together["frr"] == pytest.approx(lines.loc[[(env, "sac") for env in ENVIRONMENTS[:2]], "frr"].mean())
        assert np.isnan(together["return"])
        assert page(table(rows)).count("\n") == 2 + 6

    def test_the_curves_are_of_all(self, rows):
        points = curves(rows)
        assert len(points) == 2 * 2 * 2
        assert (points["frr_low"] <= points["frr"]).all()
        drawing = figure(points)
        assert [len(axis.lines) for axis in drawing.axes] == [2, 2, 2, 2]

    def test_nothing_is_no_study(self, tmp_path):
        with pytest.raises(ValueError, match="no finished run"):
            collect(tmp_path)
