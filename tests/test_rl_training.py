"""Training: the three algorithms, what a run leaves, and runs that were killed."""

from __future__ import annotations

import importlib.metadata
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import torch
from typer.testing import CliRunner

import fo_gym
from baselines.rl import Design, LearnedCompensator
from baselines.rl import training as training_module
from baselines.rl.algorithms import ALGORITHMS, export, make_model
from baselines.rl.checkpoint import load_checkpoint
from baselines.rl.environment import TrainingEnv
from baselines.rl.plan import ALGOS, Plan
from baselines.rl.storage import load_policy
from baselines.rl.training import train
from fo_gym.cli import app
from fo_gym.evaluation.runs.seeds import TRAINING_SEEDS
from fo_gym.extras import install_command
from fo_gym.sb3 import VecEnvAdapter

pytestmark = pytest.mark.usefixtures("one_torch_thread")
STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"
SMALL = Plan(STICTION, "ppo", 3, Design(), robots=4, steps=64, segments=3, validation_seeds=2)


@pytest.fixture(autouse=True, scope="module")
def small_training():
    """Validation on episodes of 0.2 s and one thread: what is tested here is the machinery."""
    evaluate = fo_gym.evaluate
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(training_module, "evaluate", lambda *a, **k: evaluate(*a, **k, duration=0.2))
        patch.setattr(training_module, "_THREADS", 1)
        yield


@pytest.mark.parametrize(
    "algo", ["ppo", *(pytest.param(algo, marks=pytest.mark.slow) for algo in ALGOS if algo != "ppo")]
)
class TestAlgorithms:
    def test_the_exported_network_is_the_actor(self, algo):
        """In deterministic mode, before and after training; it stays odd."""
        env = TrainingEnv(STICTION, 2, Design())
        model = make_model(algo, VecEnvAdapter(env), 32, 0)
        inputs = np.random.default_rng(0).normal(size=(50, 9)).astype(np.float32)
        for _ in range(2):
            network = export(model)
            expected, _ = model.predict(inputs, deterministic=True)
            np.testing.assert_allclose(network(inputs.astype(float)), expected[:, 0], atol=1e-6)
            np.testing.assert_array_equal(network(-inputs.astype(float)), -network(inputs.astype(float)))
            model.learning_starts = 8
            model.learn(64)
        assert (np.abs(export(model).weights[0] - network.weights[0]) > 0).any()

    @pytest.mark.slow
    def test_a_killed_run_goes_on_as_if_it_had_not_been(self, algo, tmp_path):
        """Killed in the second segment and started again: the same files, byte for byte."""
        plan = replace(SMALL, algo=algo)

        def kill(label: str, steps: int) -> None:
            if label.startswith("segment 2") and steps:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            train(plan, tmp_path / "killed", on_steps=kill)
        assert len(pd.read_csv(tmp_path / "killed" / "curve.csv")) == 1
        train(plan, tmp_path / "killed")
        train(plan, tmp_path / "whole")
        for name in ("policy.safetensors", "policy.json", "curve.csv", "card.md"):
            one, other = ((tmp_path / run / name).read_bytes() for run in ("killed", "whole"))
            assert one == other, name
        assert len(pd.read_csv(tmp_path / "killed" / "timing.csv")) == 3


def test_every_algorithm_has_its_settings():
    assert tuple(ALGORITHMS) == ALGOS


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """The folder of a small finished training."""
    folder = tmp_path_factory.mktemp("train") / "run"
    train(SMALL, folder)
    return folder


class TestTrain:
    def test_what_it_leaves(self, out):
        assert {file.name for file in out.iterdir()} == {
            "card.md",
            "checkpoint.pt",
            "compensator.py",
            "curve.csv",
            "curve.png",
            "plan.json",
            "policy.json",
            "policy.safetensors",
            "timing.csv",
        }
        curve = pd.read_csv(out / "curve.csv")
        assert curve["actions"].tolist() == [256, 512, 768]
        assert curve["frr_worst"].le(curve["frr_mean"]).all()
        timing = pd.read_csv(out / "timing.csv")
        assert timing["environment_seconds"].between(0, timing["seconds"]).all()

    def test_the_best_segment_is_kept(self, out):
        curve = pd.read_csv(out / "curve.csv")
        card = json.loads((out / "policy.json").read_text())
        best = curve.loc[curve["frr_mean"].idxmax()]
        assert card["segment"] == best["segment"]
        assert card["validation"]["frr_mean"] == pytest.approx(best["frr_mean"], rel=1e-5)
        assert card["versions"]["torch"] == importlib.metadata.version("torch")
        compensator = LearnedCompensator(*load_policy(out / "policy.safetensors"))
        seeds = fo_gym.evaluate(compensator, STICTION, variant="randomized", seeds=2, duration=0.2)["frr"]
        assert seeds.mean() == pytest.approx(best["frr_mean"], rel=1e-5)

    def test_the_file_it_writes_is_a_compensator(self, out):
        rows = fo_gym.evaluate(f"{out / 'compensator.py'}:Trained", REGULATION, duration=0.05)
        assert rows["status"][0] == "ok"

    def test_the_card_as_a_page(self, out):
        page = (out / "card.md").read_text()
        card = json.loads((out / "policy.json").read_text())
        assert card["sha256"] in page
        assert "| friction | 0.4 to 2.5 |" in page

    def test_a_finished_run_does_nothing_more(self, out):
        before = {file: file.read_bytes() for file in out.iterdir()}
        train(SMALL, out)
        assert {file: file.read_bytes() for file in out.iterdir()} == before

    def test_other_settings_in_the_same_folder(self, out):
        with pytest.raises(ValueError, match=r"holds a training with other settings.*choose another --out"):
            train(replace(SMALL, seed=4), out)

    def test_a_checkpoint_that_is_none(self, tmp_path):
        model = make_model("ppo", VecEnvAdapter(TrainingEnv(STICTION, 1, Design())), 8, 0)
        (tmp_path / "c.pt").write_bytes(b"nonsense")
        with pytest.raises(ValueError, match="no checkpoint that can be used"):
            load_checkpoint(tmp_path / "c.pt", model)

    def test_nothing_is_unpickled(self, tmp_path):
        """A checkpoint with code inside is refused before it runs."""
        marker = tmp_path / "ran"

        class Evil:
            def __reduce__(self):
                return (Path.touch, (marker,))

        torch.save({"segments": 1, "parameters": Evil()}, tmp_path / "c.pt")
        model = make_model("ppo", VecEnvAdapter(TrainingEnv(STICTION, 1, Design())), 8, 0)
        with pytest.raises(ValueError, match="no checkpoint that can be used"):
            load_checkpoint(tmp_path / "c.pt", model)
        assert not marker.exists()

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"algo": "dqn"}, "allowed are ppo, sac, tqc"),
            ({"seed": -1}, "from 0 to 999"),
            ({"steps": 0}, "at least 1"),
            ({"env_id": "FJRSquare-v1"}, "no training course"),
            ({"robots": 0}, "from 1 to 999"),
        ],
    )
    def test_a_plan_out_of_range(self, change, message, tmp_path):
        with pytest.raises(ValueError, match=message):
            train(replace(SMALL, **change), tmp_path)

    def test_episodes_come_from_training_seeds_and_differ_between_segments_and_runs(self):
        used = [
            set(range(plan.episode_seed(segment), plan.episode_seed(segment) + 999))
            for plan in (replace(SMALL, seed=0), replace(SMALL, seed=1), replace(SMALL, seed=999))
            for segment in range(9)
        ]
        assert all(seed in TRAINING_SEEDS for seed in set().union(*used))
        assert sum(map(len, used)) == len(set().union(*used))


class TestCommand:
    def test_it_trains(self, tmp_path, monkeypatch):
        small = {"ppo": replace(ALGORITHMS["ppo"], agents=2, steps=16)}
        monkeypatch.setattr("baselines.rl.algorithms.ALGORITHMS", small | {"sac": None})
        arguments = ["train", "--out", str(tmp_path / "run"), "--segments", "1", "--direct"]
        done = CliRunner().invoke(app, arguments)
        assert done.exit_code == 0, done.output
        assert "segment 1 of 1: validation FRR" in done.output
        assert "compensator.py" in done.output
        assert load_policy(tmp_path / "run" / "policy.safetensors")[0].residual is False

    def test_it_writes_tensorboards_logs(self, tmp_path):
        plan = replace(SMALL, segments=1)
        train(plan, tmp_path / "out", tensorboard=tmp_path / "logs")
        (log,) = (tmp_path / "logs").rglob("events*")
        assert b"segment/frr_mean" in log.read_bytes()

    def test_it_says_what_is_wrong(self, tmp_path):
        done = CliRunner().invoke(app, ["train", "--out", str(tmp_path), "--env", "CartPole-v1"])
        assert done.exit_code == 2
        assert "no training course" in done.output

    def test_without_the_extra(self, tmp_path, monkeypatch):
        monkeypatch.setitem(__import__("sys").modules, "baselines.rl.training", None)
        done = CliRunner().invoke(app, ["train", "--out", str(tmp_path)])
        assert done.exit_code == 2
        assert install_command("rl") in done.output
