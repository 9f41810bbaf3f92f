"""Training of the adaptive compensator: its robots, its rollouts, and runs that were killed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import fo_gym
from baselines.rl.adaptive import AdaptiveDesign
from baselines.rl.adaptive import rollouts as rollouts_module
from baselines.rl.adaptive import training as training_module
from baselines.rl.adaptive.course import Shares, random_chain, training_batch
from baselines.rl.adaptive.rollouts import Noting, rollout
from baselines.rl.adaptive.training import AdaptivePlan, train_adaptive
from fo_gym.cli import app
from fo_gym.evaluation.runs.seeds import TRAINING_SEEDS

pytestmark = pytest.mark.usefixtures("one_torch_thread")
SMALL = AdaptivePlan(seed=3, segments=2, batches=1, steps=3, validation_seeds=2)


@pytest.fixture
def _small(monkeypatch):
    """Few robots and short validations: what is tested here is the machinery."""
    evaluate = fo_gym.evaluate
    monkeypatch.setattr(training_module, "evaluate", lambda *a, **k: evaluate(*a, **k, duration=0.2))
    monkeypatch.setattr(rollouts_module, "ROBOTS", 2)


class TestCourse:
    def test_chains_differ_and_are_drawn_again_alike(self, tmp_path):
        first, again, other = (random_chain(np.random.default_rng(seed), tmp_path) for seed in (1, 1, 2))
        assert first.fingerprint == again.fingerprint != other.fingerprint
        assert all(2 <= robot.dof <= 5 for robot in (first, other))

    def test_a_batch_is_of_one_robot_with_measured_feedback(self, tmp_path):
        for seed in range(4):
            env = training_batch(np.random.default_rng(seed), tmp_path, 2, Shares())
            simulation = env.unwrapped.simulation
            assert simulation.robot.name in ("single_link", "chain")
            assert simulation.settings.feedback == "measured"
            env.close()

    def test_seeds_are_training_seeds_and_no_two_episodes_share_one(self):
        plan = AdaptivePlan(seed=999, segments=99, batches=99)
        firsts = [plan.episode_seed(segment, batch) for segment in range(99) for batch in range(99)]
        assert min(np.diff(firsts)) >= 32
        assert firsts[-1] + 32 in TRAINING_SEEDS

    @pytest.mark.parametrize(
        ("shares", "names"), [(Shares(links=1.0), {"single_link"}), (Shares(links=0.0), {"chain"})]
    )
    def test_shares_say_what_is_drawn(self, tmp_path, shares, names):
        robots = set()
        for seed in range(3):
            env = training_batch(np.random.default_rng(seed), tmp_path, 1, shares)
            robots.add(env.unwrapped.simulation.robot.name)
            env.close()
        assert robots == names
        with pytest.raises(ValueError, match=r"Shares\.laws is 1\.5"):
            Shares(laws=1.5)

    @pytest.mark.parametrize("change", [{"seed": -1}, {"segments": 0}, {"batches": 100}, {"steps": 0}])
    def test_plans_that_are_none(self, change):
        with pytest.raises(ValueError, match=f"{next(iter(change))} is"):
            replace(SMALL, **change)


@pytest.mark.slow
@pytest.mark.usefixtures("_small")
class TestTraining:
    def test_the_truth_is_what_the_blocks_hold(self):
        """Where nothing moves, r is what the zero, and what holds the joint, make of it; the truth is in its units."""
        made = rollout(Noting(AdaptiveDesign(), None), (0, 0, 1), 100, Shares())
        assert made["blocks"].shape[1:] == (890, 4)
        assert made["truth"].shape == (len(made["blocks"]), 2)
        assert np.isfinite(made["blocks"]).all()
        assert (np.abs(made["truth"][:, 1]) <= 0.16 / 0.05).all()

    def test_a_killed_run_goes_on_as_if_it_had_not_been(self, tmp_path):
        """Killed in the second segment and started again: the same files, byte for byte."""

        def kill(label: str, steps: int) -> None:
            if label.startswith("segment 2") and "learning" in label:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            train_adaptive(SMALL, tmp_path / "killed", on_steps=kill)
        assert len(pd.read_csv(tmp_path / "killed" / "curve.csv")) == 1
        train_adaptive(SMALL, tmp_path / "killed")
        train_adaptive(SMALL, tmp_path / "whole")
        for name in ("policy.safetensors", "policy.json", "curve.csv", "card.md"):
            one, other = ((tmp_path / run / name).read_bytes() for run in ("killed", "whole"))
            assert one == other, name
        assert "compensator.py" in {path.name for path in (tmp_path / "whole").iterdir()}
        rows = fo_gym.evaluate(f"{tmp_path / 'whole' / 'compensator.py'}:Trained", "FJRStiction-v0", duration=0.1)
        assert rows["status"][0] == "ok"

    def test_another_training_is_not_overwritten(self, tmp_path):
        train_adaptive(SMALL, tmp_path)
        with pytest.raises(ValueError, match="holds a training with other settings"):
            train_adaptive(replace(SMALL, seed=4), tmp_path)

    def test_a_checkpoint_that_is_none(self, tmp_path):
        (tmp_path / "checkpoint.pt").write_bytes(b"nonsense")
        with pytest.raises(ValueError, match=r"checkpoint\.pt is no checkpoint that can be used"):
            train_adaptive(SMALL, tmp_path)


class TestCommand:
    def test_what_it_does_not_take(self, tmp_path: Path):
        done = CliRunner().invoke(app, ["train", "--adaptive", "--direct", "--out", str(tmp_path)])
        assert done.exit_code == 2
        assert "leave --env, --algo, --direct and --tensorboard out" in " ".join(done.output.split())
