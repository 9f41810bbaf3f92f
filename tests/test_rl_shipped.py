"""The learned compensators as they are shipped: their cards, their scores, and their motion by a stiff solver."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

import fo_gym
from baselines.rl import rl_direct, rl_residual
from baselines.rl.compensator import SHIPPED
from baselines.rl.course import COURSES
from fo_gym import Signals
from fo_gym.certificate.cases import FRICTION, JOINT
from fo_gym.certificate.oracle import SingleLink, sampled
from fo_gym.evaluation.runs.episodes import EpisodeSet


class TestShipped:
    @pytest.mark.slow
    def test_scoring_needs_no_torch(self):
        program = (
            "import sys, fo_gym\n"
            "rows = fo_gym.evaluate('rl-residual', 'FJRStiction-v0', duration=0.1)\n"
            "assert rows['status'][0] == 'ok'\n"
            "print([name for name in ('torch', 'stable_baselines3') if name in sys.modules])"
        )
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
        assert done.stdout.strip() == "[]"

    @pytest.mark.parametrize(("make", "residual"), [(rl_residual, True), (rl_direct, False)])
    def test_what_the_cards_say(self, make, residual):
        """Trained on the single link alone, as the documented command does; the card's course is the code's.

        Ranges that came since, of the hand, say nothing of a task without one.
        """
        design = make().design
        assert design.residual is residual
        card = json.loads((SHIPPED / f"rl-{'residual' if residual else 'direct'}" / "policy.json").read_text())
        assert card["plan"]["env_id"] == "FJRStiction-v0"
        assert card["plan"]["design"] == vars(design)
        drawn = COURSES["FJRStiction-v0"].randomization
        ranges = {name: value for name, value in vars(drawn).items() if not name.startswith("hand_")}
        assert card["course"]["randomization"] == json.loads(json.dumps(ranges))

    @pytest.mark.slow
    def test_it_beats_the_observer_it_is_added_to(self):
        """On unseen validation episodes, the paired mean of 1 - FRR: at most half; measured a third."""
        seeds = range(1_000_000_500, 1_000_000_505)
        learned, observer = (
            fo_gym.evaluate(name, "FJRStiction-v0", variant="randomized", seeds=seeds)["frr"]
            for name in ("rl-residual", "pid-high")
        )
        assert (1 - learned).mean() <= 0.5 * (1 - observer).mean()

    def test_any_number_of_joints(self):
        rows = fo_gym.evaluate("rl-residual", "FJRRegulation-v0", duration=5.0)
        assert rows["frr"][0] > 0.95


class OnTheSolver:
    """The shipped policy as the sampled controller of the reference solver: motor PD, nominal motor, estimate."""

    def __init__(self, dt=1e-3):
        self.dt, self.theta_d = dt, 0.01
        self.theta_n = self.theta_n_dot = self.tau_m = self.time = 0.0
        self.policy = rl_residual()
        self.policy.reset(fo_gym.JointInfo(1, np.ones(1), np.full(1, 3e3), np.full(1, 10.0), dt), 1)

    def __call__(self, theta, v, tau_j):
        tau_c = -50.0 * (self.theta_n - self.theta_d) - 5.0 * self.theta_n_dot
        values = (theta[0], v[0], tau_j[0], self.theta_n, self.theta_n_dot, self.theta_d, tau_c, self.tau_m, self.time)
        estimate = self.policy.estimate(Signals.from_observation(np.array([values]), 1))[0]
        acceleration = tau_c - tau_j[0]
        self.theta_n += self.dt * self.theta_n_dot + 0.5 * self.dt**2 * acceleration
        self.theta_n_dot += self.dt * acceleration
        self.tau_m, self.time = (tau_c - estimate).item(), self.time + self.dt
        return tau_c - estimate


def test_the_learned_motion_is_the_solvers():
    """The same policy on LSODA instead of the plant: a result this good must not be the simulator's doing.

    2 s of the nominal step, 10 mm long; measured 1.2e-7 m at most, bound 2e-6 m.
    """
    periods = 2000
    link = SingleLink(joint=JOINT, friction=FRICTION)
    theirs = sampled(link, OnTheSolver(), np.zeros((5, 1)), np.zeros((periods, 1)))[:, 2, 0]
    ours = EpisodeSet("FJRStiction-v0", "nominal", (0,), {"duration": 1e-3 * periods}).record(rl_residual(), "rl")
    assert np.abs(ours.motions.theta[:, 0, 0] - theirs).max() < 2e-6
