"""The learned compensator's parts: inputs, action, network and files."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

import fo_gym
from baselines import PIDObserver
from baselines.rl import Design, LearnedCompensator, rl_direct, rl_residual
from baselines.rl.compensator import SHIPPED
from baselines.rl.course import COURSES
from baselines.rl.loop import FEATURES, PolicyLoop
from baselines.rl.network import Network
from baselines.rl.storage import load_policy, save_policy
from fo_gym import Signals
from fo_gym.envs.stiction import STICTION
from fo_gym.evaluation.evaluate import EpisodeSet
from fo_gym.reproduction.reference import SingleLink, sampled

DT, DOF, ENVS = 1e-3, 3, 4
RESIDUAL, DIRECT = Design(), Design(residual=False, bound=2.0)
LAYERS = (len(FEATURES), 5, 1)


def joints(limit=1e-3, control_dt=DT):
    """Joints whose torque limit is so low that the floor of the friction scale does not matter."""
    inertia = np.linspace(0.5, 1.5, ENVS * DOF).reshape(ENVS, DOF)
    return fo_gym.JointInfo(DOF, inertia, np.full((ENVS, DOF), 3e3), np.full((ENVS, DOF), limit), control_dt)


def history(ticks=20, seed=0, factor=1.0):
    rng = np.random.default_rng(seed)
    return [Signals.from_observation(factor * rng.normal(size=(ENVS, 8 * DOF + 1)), DOF) for _ in range(ticks)]


def network(seed=0, squash="clip", scale=1.0):
    rng = np.random.default_rng(seed)
    shapes = pairwise(LAYERS)
    return Network(tuple(scale * rng.normal(size=shape).astype(np.float32).astype(float) for shape in shapes), squash)


def run(compensator, signals, info=None):
    compensator.reset(info or joints(), ENVS)
    return np.array([compensator.estimate(each).copy() for each in signals])


class TestLoop:
    def test_without_action_it_is_the_observer(self):
        silent = LearnedCompensator(RESIDUAL, network(scale=0.0))
        np.testing.assert_allclose(run(silent, history()), run(PIDObserver(100.0, 20.0, 100.0), history()), rtol=1e-13)

    def test_without_observer_and_action_it_is_nothing(self):
        assert not run(LearnedCompensator(DIRECT, network(scale=0.0)), history()).any()

    def test_inputs_are_their_formulas(self):
        """Over random signals, from the history alone: the class's docstring, written out."""
        signals, loop, info = history(7), PolicyLoop(RESIDUAL), joints()
        loop.reset(info, ENVS)
        action = np.full((ENVS, DOF), 0.3)
        lag = np.array([each.theta_n - each.theta for each in signals])
        rate = np.array([each.theta_n_dot - each.theta_dot for each in signals])
        pd = -info.motor_inertia * 100.0 * (rate + 20.0 * lag)
        estimates = []
        for k, each in enumerate(signals):
            if k == 4:
                loop.act(action, each)
            if k < 6:
                estimates.append(loop.estimate(each))
        last, scale = signals[6], np.abs(pd[:6]).max(axis=0)
        at_action = np.abs(pd[:4]).max(axis=0)
        integral = DT * lag[:6].sum(axis=0)
        applied = pd[5] - info.motor_inertia * 100.0 * 100.0 * DT * lag[:5].sum(axis=0) + 0.3 * at_action
        np.testing.assert_allclose(estimates[5], applied, rtol=1e-12)
        unit = info.motor_inertia / scale
        expected = {
            "rate": np.arcsinh(unit * 100.0 * rate[6]),
            "lag": np.arcsinh(unit * 2000.0 * lag[6]),
            "integral": np.arcsinh(unit * 1e4 * integral),
            "imbalance": np.arcsinh(unit * (rate[6] - rate[4]) / RESIDUAL.period),
            "velocity": np.arcsinh(unit * 100.0 * last.theta_dot),
            "distance": np.arcsinh(unit * 2000.0 * (last.theta - last.theta_d)),
            "drive": np.arcsinh((last.tau_c - last.tau_j) / scale),
            "estimate": np.arcsinh(applied / scale),
            "action": action,
        }
        assert tuple(expected) == FEATURES
        np.testing.assert_allclose(loop.features(last), np.stack(list(expected.values()), axis=-1), rtol=1e-12)

    @pytest.mark.parametrize("design", [RESIDUAL, DIRECT])
    def test_asking_for_inputs_changes_nothing(self, design):
        loop, signals = PolicyLoop(design), history(2)
        loop.reset(joints(), ENVS)
        loop.estimate(signals[0])
        np.testing.assert_array_equal(loop.features(signals[1]), loop.features(signals[1]))

    @pytest.mark.parametrize("design", [RESIDUAL, DIRECT])
    @pytest.mark.parametrize("factor", [-1.0, 7.0])
    def test_friction_of_any_size_and_direction_is_treated_alike(self, design, factor):
        """Signals and torque limits times c give estimates times c: no scale of friction is built in."""
        policy, info = LearnedCompensator(design, network()), joints(limit=1e-3 * abs(factor))
        scaled = run(policy, history(factor=factor), info)
        np.testing.assert_allclose(scaled, factor * run(policy, history()), rtol=1e-9)

    def test_the_residual_is_bounded_by_the_observers_own_peak(self):
        """The share `bound` of the largest |B L (e' + L_p e)| so far, whatever the weights."""
        signals, info = history(60), joints()
        wild = run(LearnedCompensator(RESIDUAL, network(scale=1e3)), signals)
        plain = run(PIDObserver(100.0, 20.0, 100.0), signals)
        pd = [-info.motor_inertia * 100 * (s.theta_n_dot - s.theta_dot + 20 * (s.theta_n - s.theta)) for s in signals]
        peak = np.maximum.accumulate(np.abs(pd), axis=0)
        assert (np.abs(wild - plain) <= peak * (1 + 1e-12)).all()
        assert (np.abs(wild - plain)[10:] > 0.01 * peak[10:]).any()

    def test_the_policy_acts_at_its_own_rate(self):
        """With e constant in time and no integral to speak of, the estimate changes at every second tick at most."""
        policy = LearnedCompensator(replace(DIRECT, period=5 * DT), network())
        changes = np.abs(np.diff(run(policy, history(50)), axis=0)).max(axis=(1, 2)) > 0
        assert set(np.flatnonzero(changes) % 5) == {4}

    def test_a_reset_forgets(self):
        policy = LearnedCompensator(RESIDUAL, network())
        once = run(policy, history())
        np.testing.assert_array_equal(run(policy, history()), once)

    def test_restart_is_a_reset_of_some(self):
        loop, signals = PolicyLoop(RESIDUAL), history(3)
        loop.reset(joints(), ENVS)
        fresh = loop.features(signals[2])
        loop.act(np.full((ENVS, DOF), 0.5), signals[0])
        for each in signals[:2]:
            loop.estimate(each)
        used = loop.features(signals[2])
        loop.restart(np.array([1, 3]), joints())
        mixed = loop.features(signals[2])
        np.testing.assert_array_equal(mixed[[1, 3]], fresh[[1, 3]])
        np.testing.assert_array_equal(mixed[[0, 2]], used[[0, 2]])

    def test_a_rate_that_does_not_fit(self):
        with pytest.raises(ValueError, match=r"every 0\.002 s cannot run at control_dt = 0\.003 s"):
            PolicyLoop(RESIDUAL).reset(joints(control_dt=3e-3), ENVS)
        with pytest.raises(ValueError, match="too fast"):
            PolicyLoop(replace(RESIDUAL, period=0.01)).reset(joints(control_dt=0.01), ENVS)

    @pytest.mark.parametrize(("name", "value"), [("L", 0.0), ("bound", np.nan), ("period", "2e-3"), ("residual", 1)])
    def test_a_design_out_of_range(self, name, value):
        with pytest.raises(ValueError, match=f"Design.{name} is"):
            replace(RESIDUAL, **{name: value})


class TestNetwork:
    @pytest.mark.parametrize("squash", ["clip", "tanh"])
    def test_it_is_its_formula_and_odd(self, squash):
        net = network(squash=squash)
        x = np.random.default_rng(1).normal(size=(2, 3, len(FEATURES)))
        first, second = net.weights
        raw = np.einsum("...h,h->...", np.tanh(np.einsum("...i,ih->...h", x, first)), second[:, 0])
        expected = np.tanh(raw) if squash == "tanh" else np.clip(raw, -1, 1)
        np.testing.assert_allclose(net(x), expected, rtol=1e-12)
        np.testing.assert_array_equal(net(-x), -net(x))

    def test_neighbours_do_not_matter(self):
        net, x = network(), np.random.default_rng(1).normal(size=(64, DOF, len(FEATURES)))
        together = net(x)
        for i in (0, 17, 63):
            np.testing.assert_array_equal(net(x[i : i + 1])[0], together[i])

    @pytest.mark.parametrize(
        ("weights", "message"),
        [
            ((), "at least one layer"),
            ((np.ones((3, 2)),), "gives 1"),
            ((np.ones((3, 2)), np.ones((3, 1))), "what the one before gives"),
            ((np.ones(3),), "shapes"),
            ((np.full((3, 1), np.nan),), "not finite"),
        ],
    )
    def test_what_is_no_network(self, weights, message):
        with pytest.raises(ValueError, match=message):
            Network(weights, "clip")

    def test_an_unknown_squash(self):
        with pytest.raises(ValueError, match="allowed are 'clip', 'tanh'"):
            Network((np.ones((3, 1)),), "relu")


class TestFiles:
    @pytest.fixture
    def path(self, tmp_path):
        save_policy(tmp_path / "p.safetensors", DIRECT, network(squash="tanh"), {"note": 1})
        return tmp_path / "p.safetensors"

    def rewrite(self, path, tensors=None, metadata=None):
        """Change what the file holds, and have the card vouch for it."""
        design, net = load_policy(path)
        description = {"design": vars(design), "squash": net.squash, "features": FEATURES} | (metadata or {})
        save_file(tensors or net.tensors(), path, metadata={"fo-gym policy": json.dumps(description)})
        card = {"sha256": hashlib.sha256(path.read_bytes()).hexdigest()}
        path.with_suffix(".json").write_text(json.dumps(card))

    def test_back_as_it_was(self, path):
        design, net = load_policy(path)
        assert design == DIRECT
        assert net.squash == "tanh"
        for mine, theirs in zip(net.weights, network().weights, strict=True):
            np.testing.assert_array_equal(mine, theirs)
        assert json.loads(path.with_suffix(".json").read_text())["note"] == 1

    def test_the_memory_layout_does_not_matter(self, tmp_path):
        transposed = Network(tuple(np.asfortranarray(weight) for weight in network().weights), "clip")
        save_policy(tmp_path / "p.safetensors", DIRECT, transposed, {})
        for mine, theirs in zip(load_policy(tmp_path / "p.safetensors")[1].weights, network().weights, strict=True):
            np.testing.assert_array_equal(mine, theirs)

    def test_the_same_bytes_for_the_same_policy(self, path, tmp_path):
        for name in "qrs":
            save_policy(tmp_path / f"{name}.safetensors", DIRECT, network(squash="tanh"), {"note": 1})
            assert (tmp_path / f"{name}.safetensors").read_bytes() == path.read_bytes()

    def test_weights_that_were_changed(self, path):
        content = bytearray(path.read_bytes())
        content[-1] ^= 1
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r"hash .* its card says"):
            load_policy(path)

    def test_a_missing_file(self, path):
        path.with_suffix(".json").unlink()
        with pytest.raises(ValueError, match="the model card of these weights"):
            load_policy(path)
        with pytest.raises(ValueError, match=r"no .*nowhere\.safetensors"):
            fo_gym.make_compensator("rl-residual", weights="nowhere.safetensors")

    @pytest.mark.parametrize("text", ["", "[]", "{}", "\xff"])
    def test_a_card_that_is_none(self, path, text):
        path.with_suffix(".json").write_bytes(text.encode("latin-1"))
        with pytest.raises(ValueError, match="is no model card"):
            load_policy(path)

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            (lambda t: {**t, "layer0": t["layer0"][:-1].copy()}, "this policy has 9 inputs"),
            (lambda t: {**t, "layer1": t["layer1"][:-1].copy()}, "what the one before gives"),
            (lambda t: {**t, "layer0": np.full_like(t["layer0"], np.nan)}, "layer0 has weights that are not finite"),
            (lambda t: {**t, "layer0": t["layer0"].astype(np.float64)}, "expected float32"),
            (lambda t: {"layer0": t["layer0"], "head": t["layer1"]}, "expected layer0, layer1"),
        ],
    )
    def test_tensors_of_something_else(self, path, change, message):
        self.rewrite(path, tensors=change(load_file(path)))
        with pytest.raises(ValueError, match=message):
            load_policy(path)

    @pytest.mark.parametrize(
        ("metadata", "message"),
        [
            ({"features": ["rate"]}, "this version computes"),
            ({"squash": "relu"}, "allowed are"),
            ({"design": {"gain": 1.0}}, "gain"),
            ({"design": {"bound": -1.0}}, "Design.bound is -1"),
        ],
    )
    def test_a_description_of_something_else(self, path, metadata, message):
        self.rewrite(path, metadata=metadata)
        with pytest.raises(ValueError, match=message):
            load_policy(path)

    def test_a_file_that_is_no_safetensors(self, path):
        path.write_bytes(b"PK nonsense")
        path.with_suffix(".json").write_text(json.dumps({"sha256": hashlib.sha256(b"PK nonsense").hexdigest()}))
        with pytest.raises(ValueError, match="no policy that can be used"):
            load_policy(path)


class TestShipped:
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
        """Trained on the single link alone, as the documented command does; the card's course is the code's."""
        design = make().design
        assert design.residual is residual
        card = json.loads((SHIPPED / f"rl-{'residual' if residual else 'direct'}" / "policy.json").read_text())
        assert card["plan"]["env_id"] == "FJRStiction-v0"
        assert card["plan"]["design"] == vars(design)
        drawn = COURSES["FJRStiction-v0"].randomization
        assert card["course"]["randomization"] == json.loads(json.dumps(vars(drawn)))

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
    link = SingleLink(joint=STICTION.joints, friction=STICTION.friction)
    theirs = sampled(link, OnTheSolver(), np.zeros((5, 1)), np.zeros((periods, 1)))[:, 2, 0]
    ours = EpisodeSet("FJRStiction-v0", "nominal", (0,), {"duration": 1e-3 * periods}).record(rl_residual(), "rl")
    assert np.abs(ours.motions.theta[:, 0, 0] - theirs).max() < 2e-6
