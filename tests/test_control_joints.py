"""Joint PD, nominal motor, push and reset, against formulas."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest

import fo_gym
from fo_gym.control.motor_pd import MotorPD
from fo_gym.control.nominal_motor import NominalMotor
from fo_gym.parameters import PDGains


def test_motor_pd_is_its_formula():
    rng = np.random.default_rng(0)
    theta, theta_dot, theta_d, gravity = rng.normal(size=(4, 5, 3))
    kp, kd = np.array([50.0, 30.0, 10.0]), 2.0
    torque = MotorPD(PDGains(kp, kd), 3).torque(theta, theta_dot, theta_d, gravity)
    np.testing.assert_allclose(torque, -kp * (theta - theta_d) - kd * theta_dot + gravity, rtol=0.0, atol=1e-13)


def test_nominal_motor_is_a_double_integrator():
    """Exact under constant torques but for rounding: 1e-12 of values up to 10, in 1000 steps."""
    rng = np.random.default_rng(0)
    start, rate, tau_c, tau_j = rng.normal(size=(4, 3, 2))
    inertia = rng.uniform(0.5, 2.0, (3, 2))
    motor = NominalMotor(*np.zeros((2, 3, 2)), dt=1e-3)
    motor.reset(np.arange(3), start, rate)
    for _ in range(1000):
        motor.step(tau_c, tau_j, inertia)
    a = (tau_c - tau_j) / inertia
    np.testing.assert_allclose(motor.theta, start + rate + 0.5 * a, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(motor.theta_dot, rate + a, rtol=0.0, atol=1e-12)
    motor.reset(np.array([1]), start[[2]], rate[[2]])
    np.testing.assert_array_equal(motor.theta[1], start[2])
    np.testing.assert_allclose(motor.theta[0], (start + rate + 0.5 * a)[0], rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("time", [0.1, 0.10037])
@pytest.mark.parametrize("env_id", fo_gym.ENVIRONMENTS)
def test_push_is_a_pulse_of_half_its_peak(env_id, time):
    """On the ticks or between them, tau_ext sums to torque x duration / 2 and is zero outside; it moves the links."""
    vector = gym.make_vec(env_id, num_envs=2, variant="randomized", friction=fo_gym.FRICTIONLESS)
    torque = np.linspace(1.0, 2.0, vector.simulation.dof)
    vector.reset(seed=0, options={"push": {"time": time, "duration": 0.2, "torque": torque}})
    applied = np.array([vector.step(np.zeros((2, len(torque))))[4]["tau_ext"] for _ in range(400)])
    np.testing.assert_allclose(1e-3 * applied.sum(axis=0), [0.1 * torque] * 2, rtol=1e-6)
    middle = (np.arange(400) + 0.5) * 1e-3
    assert not applied[(middle < time) | (middle > time + 0.2)].any()
    np.testing.assert_allclose(applied.max(axis=0), [torque] * 2, rtol=1e-3)


def test_push_acts_on_the_links():
    """A link of 1 kg takes up the pulse's integral; after 5 ms the spring has given back 1.4 % of it."""
    pushed, left = gym.make("FJRStiction-v0"), gym.make("FJRStiction-v0")
    pushed.reset(seed=0, options={"push": {"time": 0.0, "duration": 0.1, "torque": [1.0]}})
    left.reset(seed=0)
    for _ in range(5):
        gained = (pushed.step(np.zeros(1))[4]["q_dot"] - left.step(np.zeros(1))[4]["q_dot"]).item()
    share = 0.05
    assert gained == pytest.approx(0.05 * (share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi)), rel=0.02)


def test_reset_is_a_static_equilibrium():
    """Without friction the arm stands still until its target steps at 3 s: rounding leaves 3e-13 rad and rad/s."""
    env = gym.make("FJRRegulation-v0", friction=fo_gym.FRICTIONLESS)
    obs, _ = env.reset(seed=0)
    start = fo_gym.Signals.from_observation(obs, 7)
    drift = 0.0
    for _ in range(2999):
        obs = env.step(np.zeros(7))[0]
        drift = max(drift, np.abs(obs[:14] - np.concatenate([start.theta, start.theta_dot])).max())
    assert drift < 1e-11
    assert np.abs(env.step(np.zeros(7))[0][35:42] - start.theta_d).max() > 0.01
