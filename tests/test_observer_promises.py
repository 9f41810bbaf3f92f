"""The published observers do what their authors claim of them."""

from __future__ import annotations

from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest
from observers import DT, IDENTIFIED, answers, joints, on_a_motor
from scipy import signal

import fo_gym
from baselines.eso import eso
from baselines.feedforward import feedforward
from baselines.garofalo2019 import supertwisting
from baselines.kaneko import kaneko
from baselines.kim2019 import pd_high, pd_low, pd_measured, pid_high, pid_measured
from baselines.kimchung2015 import kimchung
from baselines.l1_observer import l1
from baselines.letien2008 import letien_high
from baselines.lugre1995 import lugre_nominal, lugre_off
from baselines.lugre_adaptive import lugre_adaptive
from fo_gym.evaluation.episode.recorder import record
from fo_gym.evaluation.runs.episodes import EpisodeSet


def theta_at_the_end(make, seconds=20.0):
    """Motor positions of the nominal single link, over the last half of the episode [m]."""
    recording = EpisodeSet("FJRStiction-v0", "nominal", (0,), {"duration": seconds}).record(make(), "it")
    return recording, recording.ticks["theta"][-round(seconds * 500) :, 0, 0]


def test_kimchung_rests_where_its_stiffness_holds_friction():
    """Nominal feedback and no integral: no limit cycle, and e = -3 tau_f / (B L^2)."""
    recording, theta = theta_at_the_end(kimchung)
    assert np.ptp(theta) < 1e-7
    e = recording.ticks["theta_n"][-1, 0, 0] - theta[-1]
    assert e == pytest.approx(-3.0 * recording.periods["tau_f"][-1, 0, 0] / 100.0**2, rel=1e-3)


@pytest.mark.slow
def test_kimchung_with_tau_k_reaches_the_same_rest():
    """tau_k takes energy only while the joint moves: the end is a rest, near the target."""
    _, theta = theta_at_the_end(lambda: kimchung(tau_k=True))
    assert np.ptp(theta) < 1e-7
    assert abs(theta[-1] - 0.01) < 3e-4


@pytest.mark.slow
@pytest.mark.parametrize(("nominal", "measured"), [(pid_high, pid_measured), (pd_high, pd_measured)])
def test_measured_feedback_hunts_where_nominal_feedback_does_not(nominal, measured):
    assert (nominal().feedback, measured().feedback) == ("nominal", "measured")
    assert isinstance(measured(), type(nominal()))
    assert np.ptp(theta_at_the_end(nominal)[1]) < 1e-5
    assert np.ptp(theta_at_the_end(measured)[1]) > 5e-4


@pytest.mark.slow
def test_lugre_with_the_true_parameters_cancels_friction_and_with_wrong_ones_does_not():
    """The estimate follows friction to 1 %, theta stays within 0.01 mm of the target; with 20 to 30 % off, neither."""
    errors, rests = [], []
    for make in (lugre_nominal, lugre_off):
        recording, theta = theta_at_the_end(make)
        errors.append(np.std(recording.periods["tau_f_hat"] - recording.periods["tau_f"]))
        rests.append(np.abs(theta - 0.01).max())
    assert errors[0] < 0.01
    assert errors[1] > 0.1
    assert rests[0] < 1e-5
    assert rests[1] > 1e-3


def test_supertwisting_converges_in_finite_time():
    """To a constant, and to a disturbance whose rate stays below S1: exact but for rounding, one period late."""
    time = np.arange(2000) * DT
    zero = np.zeros_like(time)
    for friction in (np.full_like(time, 2.0), 2.0 + 100.0 * time, 5.0 * np.sin(30.0 * time)):
        late = on_a_motor(supertwisting(), friction, np.sin(9.0 * time), zero)[1:] - friction[:-1]
        assert np.abs(late[200:]).max() < 1e-9
    too_fast = 5.0 * np.sin(80.0 * time)
    assert np.abs(on_a_motor(supertwisting(), too_fast, zero, zero)[201:] - too_fast[200:-1]).max() > 0.01
    slow = on_a_motor(letien_high(), 5.0 * np.sin(30.0 * time), zero, zero)[1:] - 5.0 * np.sin(30.0 * time)[:-1]
    assert np.abs(slow[200:]).max() > 0.5


def test_supertwisting_does_not_chatter_at_rest():
    zero = np.zeros(500)
    assert np.ptp(on_a_motor(supertwisting(), zero - 1.5, zero, zero)[300:]) < 1e-12


def test_l1_bandwidth_is_that_of_its_low_pass_whatever_the_adaptation_gain():
    time = np.arange(3000) * DT
    friction, zero = np.sign(np.sin(6.0 * time)), np.zeros_like(time)
    _, expected, _ = signal.lsim(([150.0], [1.0, 150.0]), friction, time, interp=False)
    errors = [np.abs(on_a_motor(l1(G=G), friction, zero, zero) - expected).mean() for G in (1e3, 1e4, 1e5)]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.02


@pytest.mark.slow
def test_l1_hunts_on_the_single_link():
    """As in a study of its code, which ran at the same 1 kHz: between 9.74 and 10.26 mm."""
    _, theta = theta_at_the_end(l1)
    assert (1e3 * theta.min(), 1e3 * theta.max()) == pytest.approx((9.74, 10.26), abs=0.01)


def test_kaneko_holds_the_motor_against_a_push_that_a_torque_sensor_lets_through():
    """The link's torque is cancelled as if it were friction: the joint is stiff where it should yield."""
    push = {"time": 5.0, "duration": 1.0, "torque": np.array([3.0])}
    moved = {}
    for name, observer in (("kaneko", kaneko()), ("letien", letien_high())):
        env = gym.make_vec("FJRStiction-v0", num_envs=1, feedback=observer.feedback)
        obs, _ = env.reset(seed=0, options={"push": push, "target": np.zeros(1)})
        observer.reset(env.joint_info, 1)
        trace = []
        for _ in range(6000):
            obs, *_ = env.step(observer.estimate(fo_gym.Signals.from_observation(obs, 1)))
            trace.append(obs[0, 0])
        moved[name] = np.abs(trace[5000:]).max()
    assert moved["letien"] > 0.02
    assert moved["kaneko"] < 0.2 * moved["letien"]


def test_with_the_torque_sensor_kaneko_is_le_tien():
    """A momentum observer, r = L (p - p_0 - int (tau_m - tau_j + r)), is Le Tien's with L = K_O, to rounding."""
    rng = np.random.default_rng(5)
    friction, tau_j, tau_c = np.cumsum(rng.normal(size=(3, 3000)), axis=1) * 0.01
    without_spring = on_a_motor(kaneko(), friction, 0.0 * tau_j, tau_c - tau_j)
    np.testing.assert_allclose(without_spring, on_a_motor(letien_high(), friction, tau_j, tau_c), atol=1e-10)


@pytest.mark.parametrize("make", [kaneko, supertwisting, l1, eso])
def test_a_clipped_estimate_does_not_wind_up(make):
    """Friction beyond the torque limit is still estimated as it is, and the next value is found as fast as ever."""
    friction = np.repeat([3.0, 0.5], 2000)
    zero = np.zeros_like(friction)
    estimates = on_a_motor(make(), friction, zero, zero, limit=1.0)
    np.testing.assert_allclose(estimates[[1900, 2300]], [3.0, 0.5], atol=0.01)


def test_feedforward_is_the_friction_of_a_slide_and_pushes_towards_the_target_at_rest():
    rows = np.zeros((2, 1, 9))
    rows[:, 0, 1] = 0.05  # theta'
    rows[1, 0, [0, 5]] = 0.05 * DT  # theta follows theta_d
    slide = answers(feedforward(), rows, joints(1))[1, 0, 0]
    assert slide == pytest.approx(float(IDENTIFIED[1].steady(0.05)), rel=1e-6)
    rows[:] = 0.0
    rows[:, 0, 5] = 0.01  # at rest, before the target: tau_m rises by f_c
    assert answers(feedforward(), rows, joints(1))[0, 0, 0] == pytest.approx(-1.0)


def strange_arm(observer, seconds):
    """The swinging arm with dry friction 1.4 times the identified one, viscous friction 0.6 times."""
    p = IDENTIFIED[7]
    factors = {"sigma_0": 1.4, "sigma_1": 1.4, "f_c": 1.4, "f_s": 1.4, "sigma_2": 0.6}
    friction = replace(p, **{name: factor * getattr(p, name) for name, factor in factors.items()})
    arguments = {"duration": seconds, "friction": friction, "physics_dt": "auto"}
    return record(observer, "it", "FJRTracking-v0", "nominal", (0,), arguments)


@pytest.mark.slow
def test_lugre_adaptive_finds_the_friction_of_an_arm_that_is_not_as_identified():
    """Dry friction of every joint to 15 %, in four seconds, from 0; what viscous friction does is learned later."""
    observer = lugre_adaptive()
    strange_arm(observer, 4.0)
    np.testing.assert_allclose(observer.level[0, 0], 1.4, rtol=0.15)


@pytest.mark.parametrize("make", [lugre_adaptive, eso])
@pytest.mark.parametrize("variant", ["randomized", "hardware"])
def test_slow_sampling_loses_no_joint(make, variant):
    """An estimate every 5 ms: further from the target, as for everybody, and not unstable."""
    recording = record(make(), "it", "FJRStiction-v0", variant, (0, 1), {"duration": 3.0, "decimation": 5})
    assert list(recording.terminations) == ["", ""]
    assert np.abs(recording.ticks["theta"] - recording.ticks["theta_d"]).max() < 0.03


@pytest.mark.slow
def test_lugre_adaptive_rests_nearer_to_the_target_than_its_feedback_alone():
    errors = []
    for make in (pd_low, lambda: lugre_adaptive(L=50.0, Lp=10.0)):
        _, theta = theta_at_the_end(make)
        assert np.ptp(theta) < 1e-6
        errors.append(abs(theta[-1] - 0.01))
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.slow
def test_a_model_that_is_too_strong_drives_the_arm_away_and_a_share_of_it_does_not():
    """Negative damping: viscous friction is over-compensated by more than the controller damps."""
    p = IDENTIFIED[7]
    weak = {"friction": replace(p, sigma_2=0.5 * p.sigma_2), "duration": 8.0, "physics_dt": "auto"}
    ends = [
        record(lugre_nominal(viscous=share), "it", "FJRRegulation-v0", "nominal", (0,), weak).terminations[0]
        for share in (1.0, 0.5)
    ]
    assert ends == ["joint_limit", ""]
