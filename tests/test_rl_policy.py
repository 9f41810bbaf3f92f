"""The learned compensator's parts: inputs, action, and network."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from policies import DIRECT, DOF, DT, ENVS, RESIDUAL, history, joints, network, run

from baselines import PIDObserver
from baselines.rl import LearnedCompensator
from baselines.rl.loop import FEATURES, PolicyLoop
from baselines.rl.network import Network


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
        with pytest.raises(ValueError, match=r"every 0\.002 s, which does not suit control_dt = 0\.003 s"):
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
