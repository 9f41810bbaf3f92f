"""The published observers against their equations, solved another way."""

from __future__ import annotations

import numpy as np
import pytest
from observers import DT, IDENTIFIED, answers, joints, on_a_motor, random_observations
from scipy import integrate, optimize, signal

from baselines.eso import ExtendedStateObserver, eso
from baselines.feedforward import feedforward
from baselines.garofalo2019 import SuperTwistingObserver
from baselines.kaneko import kaneko
from baselines.kim2019 import pd_measured, pid_measured
from baselines.kimchung2015 import KimChungObserver, kimchung
from baselines.l1_observer import l1
from baselines.letien2008 import letien_high
from baselines.lugre1995 import lugre_nominal
from baselines.lugre_adaptive import BOUNDS, AdaptiveLuGreObserver, lugre_adaptive
from fo_gym import Signals

TRANSFER = {
    "kimchung": (kimchung, [3 * 100**2, 100**3], np.poly([-100, -100, -100])),
    "pid": (pid_measured, [100, 2000, 10_000], [1, 100, 2000, 10_000]),
    "pd": (pd_measured, [100, 2000], [1, 100, 2000]),
    "kaneko": (kaneko, [100], [1, 100]),
    "eso": (eso, [300**3], np.poly([-300, -300, -300])),
    "l1": (l1, np.polymul([1e4, 1e6], [150]), np.polymul([1, 1e4, 1e6], [1, 150])),
}


@pytest.mark.parametrize("name", TRANSFER)
def test_the_estimate_is_its_low_pass_of_friction(name):
    """Against SciPy's linear simulation, over random torques; half a period of delay and the hold make 1 %.

    Of tau_f for those with a torque sensor, of tau_f - (tau_j - its first value) for the one without.
    """
    make, numerator, denominator = TRANSFER[name]
    dt, time = 1e-4, np.arange(20_000) * 1e-4
    rng = np.random.default_rng(3)
    waves = np.sin(rng.uniform(5.0, 60.0, (3, 8, 1)) * time + rng.uniform(0.0, 6.0, (3, 8, 1))).sum(axis=1)
    friction, tau_j, tau_c = waves
    target = friction - (tau_j - tau_j[0]) if name == "kaneko" else friction
    estimates = on_a_motor(make(), friction, tau_j, tau_c, dt)
    if name == "kaneko":  # it takes the start for an equilibrium; here it is none
        tau_c = tau_c - tau_c[0]
    _, expected, _ = signal.lsim((numerator, denominator), target, time)
    assert np.abs(estimates[1:] - expected[:-1]).max() < 0.02 * np.abs(expected).max()


def test_kimchung_is_a_filtered_pd():
    observations = random_observations(50, 1, 1)
    theta, theta_dot, _, theta_n, theta_n_dot, *_ = observations[:, 0].T
    share = 1.0 - np.exp(-0.3)
    filtered = signal.lfilter([share], [1.0, share - 1.0], theta_n_dot - theta_dot + 100.0 / 3.0 * (theta_n - theta))
    np.testing.assert_allclose(answers(kimchung(), observations, joints(1))[:, 0, 0], -130.0 * filtered, rtol=1e-12)


def test_kimchung_tau_k():
    """Joint by joint: tau_k takes the power (theta_k' - q')^T K_j e, all of it for a small eps, out of theta_k."""
    observations, info, tie = 1e-3 * random_observations(30, 1, 3), joints(3), 7.0
    with_it = answers(KimChungObserver(100.0, tau_k=True, eps=1e-30, tie=tie), observations, info)[:, 0]
    share, d, d_dot, q_dot, filtered = 1.0 - np.exp(-0.3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    blocks = observations[:, 0, :-1].reshape(-1, 8, 3)
    for k, row in enumerate(blocks):
        theta, theta_dot, tau_j, theta_n, theta_n_dot = row[:5]
        previous = blocks[max(k - 1, 0)]
        q_dot = (1 - share) * q_dot + share * ((theta - previous[0]) - (tau_j - previous[2]) / 3e3) / DT
        e, velocity = theta_n + d - theta, theta_n_dot + d_dot
        filtered = (1 - share) * filtered + share * (velocity - theta_dot + 100.0 / 3.0 * e)
        tau_k = -130.0 * filtered + 1.3 * (2 * tie * d_dot + tie**2 * d) - with_it[k]
        assert velocity @ tau_k == pytest.approx(-(velocity - q_dot) @ (3e3 * e), rel=1e-9)
        assert np.linalg.norm(np.cross(velocity, tau_k)) < 1e-9 * np.linalg.norm(velocity) * np.linalg.norm(tau_k)
        a = tau_k / 1.3 - 2 * tie * d_dot - tie**2 * d
        d, d_dot = d + DT * d_dot + 0.5 * DT**2 * a, d_dot + DT * a


def test_l1_is_its_state_space_form():
    """Predictor and low-pass as one linear system in discrete time, by SciPy."""
    observations, dt, b = random_observations(60, 1, 1), DT, 1.3
    inputs = observations[:, 0, [0, 1, 2, 7]]  # theta, theta', tau_j, tau_m
    inputs[:, 3] = np.roll(inputs[:, 3], -1)  # of the coming period; the last is not looked at
    gain, share = b * 1e4 / (1.0 + 1e4 * dt), 1.0 - np.exp(-0.15)
    sigma_x = -gain * np.array([100.0, 1.0 + 100.0 * dt, 0.0])
    sigma_u = -np.array([*sigma_x[:2], 0.0, 0.0])
    f_x, f_u = share * sigma_x + [0.0, 0.0, 1.0 - share], share * sigma_u
    a_x, a_u = sigma_x / b, np.add(sigma_u, [0.0, 0.0, -1.0, 1.0]) / b
    v_x, v_u = dt * a_x + [0.0, 1.0, 0.0], dt * a_u
    A = np.array([dt * v_x + [1.0, 0.0, 0.0], v_x, f_x])
    system = (A, np.array([dt * v_u, v_u, f_u]), f_x[None], f_u[None], dt)
    _, expected, _ = signal.dlsim(system, inputs, x0=[*inputs[0, :2], 0.0])
    np.testing.assert_allclose(answers(l1(), observations, joints(1))[:, 0], expected, rtol=1e-9, atol=1e-9)


def test_supertwisting_solves_its_implicit_equations():
    """p~ of every tick by bracketing, the sign filled in at 0; small momenta, so that the sign matters."""
    observations, b = 0.02 * random_observations(200, 1, 1), 1.3
    S1, T1, S2, T2 = gains = (20.0, 9.0, 400.0, 40.0)
    estimates = answers(SuperTwistingObserver(*gains), observations, joints(1))[:, 0, 0]
    s, p_hat, before = 0.0, b * observations[0, 0, 1], None
    for row, estimate in zip(observations[:, 0], estimates, strict=True):
        if before is not None:
            free = p_hat + DT * (row[7] - before[2] + s) - b * row[1]

            def residual(x, free=free):
                slow = T1 * np.sqrt(abs(x)) * np.sign(x) + T2 * x + DT * (S1 * np.sign(x) + S2 * x)
                return x + DT * slow - free

            x = optimize.brentq(residual, -10.0, 10.0, xtol=1e-20)
            slope = (free - x - DT * (T1 * np.sqrt(abs(x)) * np.sign(x) + T2 * x)) / DT**2
            s, p_hat = s - DT * slope, b * row[1] + x
        assert estimate == pytest.approx(s, rel=1e-6, abs=1e-7)
        before = row


def test_lugre_against_a_stiff_solver():
    """Through presliding, break-away and reversals; 0.1 ms of implicit Euler makes 1 % of the largest friction."""
    p, dt, k = IDENTIFIED[1], 1e-4, 0.05
    time = np.arange(20_000) * dt
    observations = np.zeros((len(time), 1, 9))
    observations[:, 0, 0] = 1e-4 * np.cos(3.0 * time)  # theta - theta_d
    observations[:, 0, 1] = 5e-3 * np.sin(7.0 * time)

    def z_dot(t, z):
        v = 5e-3 * np.sin(7.0 * t)
        g = p.f_c + (p.f_s - p.f_c) * np.exp(-((v / p.v_s) ** 2))
        return v - p.sigma_0 * abs(v) / g * z - k * 1e-4 * np.cos(3.0 * t)

    z = integrate.solve_ivp(z_dot, (0.0, 2.0), [0.0], "LSODA", time, rtol=1e-9, atol=1e-14).y[0]
    expected = -(p.sigma_0 * z + p.sigma_1 * np.array(list(map(z_dot, time, z))) + p.sigma_2 * observations[:, 0, 1])
    estimates = answers(lugre_nominal(k=k), observations, joints(1, dt))[:, 0, 0]
    assert np.abs(expected).max() > 1.2
    assert np.abs(estimates - expected).max() < 0.02


@pytest.mark.parametrize("speed", [1e-9, 1e-3, 1.0, 1e6])
def test_lugre_holds_at_any_speed(speed):
    """At constant velocity it is the steady friction."""
    observations = np.zeros((30_000, 1, 9))
    observations[:, :, 1] = speed
    final = answers(lugre_nominal(k=0.0), observations, joints(1))[-1, 0, 0]
    steady = float(IDENTIFIED[1].steady(speed)) if speed > 1e-8 else -1e5 * 30_000 * DT * speed
    assert final == pytest.approx(steady, rel=1e-3)


def test_feedforward_is_its_formula():
    observations = 1e-3 * random_observations(20, 2)
    p = IDENTIFIED[7]
    theta, theta_dot, theta_d = (observations[..., 7 * i : 7 * i + 7] for i in (0, 1, 5))
    v_r = np.diff(theta_d, axis=0, prepend=theta_d[:1]) / DT + 10.0 * (theta_d - theta)
    expected = -p.f_c * np.tanh(v_r / p.v_s) - p.sigma_2 * theta_dot
    np.testing.assert_allclose(answers(feedforward(), observations, joints()), expected, rtol=1e-12)


@pytest.mark.parametrize("bandwidth", [30.0, 300.0, 5000.0])
def test_eso_has_its_three_poles_where_the_bandwidth_says(bandwidth):
    """exp(-w dt), from the characteristic polynomial of its answer to a jump of theta, at any w dt."""
    observations = np.zeros((12, 1, 9))
    observations[1:, 0, 0] = 1.0
    answer = answers(ExtendedStateObserver(bandwidth), observations, joints(1))[1:, 0, 0]
    b = np.exp(-bandwidth * DT)
    # One over the poles, times the second difference of the jump, times the last gain: nothing else comes out.
    expected = signal.lfilter(1.3 * (1 - b) ** 3 / DT**2 * np.array([1.0, -2.0, 1.0]), np.poly([b, b, b]), np.ones(11))
    np.testing.assert_allclose(answer, expected, rtol=1e-7, atol=1e-9 * np.abs(expected).max())


def test_eso_is_le_tien_behind_two_low_passes():
    """w^3 / (s + w)^3 = L / (s + L) w^2 / (s + w)^2 for L = w: the price of not measuring the velocity."""
    dt, time = 1e-4, np.arange(10_000) * 1e-4
    friction, tau_j, tau_c = (np.sin(w * time) + 0.3 for w in (9.0, 31.0, 17.0))
    le_tien = on_a_motor(letien_high(), friction, tau_j, tau_c, dt)
    _, expected, _ = signal.lsim(([1e4], [1.0, 200.0, 1e4]), le_tien, time)
    estimates = on_a_motor(eso(100.0), friction, tau_j, tau_c, dt)
    assert np.abs(estimates - expected).max() < 0.01 * np.abs(expected).max()


def phi_along(theta, p, dt):
    """Dry and viscous friction at level 1 along theta (ticks,), as means over the periods, (2, ticks - 1)."""
    z, phi = 0.0, np.empty((2, len(theta) - 1))
    for k, moved in enumerate(np.diff(theta)):
        g = p.f_c + (p.f_s - p.f_c) * np.exp(-((moved / dt / p.v_s) ** 2))
        before, z = z, (z + moved) / (1.0 + p.sigma_0 * abs(moved) / g)
        phi[:, k] = p.sigma_0 * z + p.sigma_1 * (z - before) / dt, p.sigma_2 * moved / dt
    return phi


def learned(theta, true, offset=0.0, rate=20.0):
    """Levels (ticks, 2) and phi, along theta with friction of these levels and an offset that no model knows."""
    p, dt, b = IDENTIFIED[1], DT, 1.3
    phi = phi_along(theta, p, dt)
    velocity = np.diff(theta, prepend=theta[0]) / dt
    tau_f = -np.asarray(true) @ phi - offset
    observer = lugre_adaptive(rate=rate)
    observer.reset(joints(1), 1)
    levels = np.empty((len(theta), 2))
    for k in range(len(theta)):
        row = np.zeros((1, 9))
        row[0, [0, 1]] = theta[k], velocity[k]
        row[0, 7] = b * (velocity[k] - velocity[k - 1]) / dt - tau_f[k - 1] if k else 0.0
        observer.estimate(Signals.from_observation(row, 1))
        levels[k] = observer.level[:, 0, 0]
    return levels, phi


def test_what_lugre_adaptive_learns_comes_nearer_to_the_truth_all_the_time():
    """Its Lyapunov function, over random motions: it never grows, and both levels are found."""
    time, rng = np.arange(30_000) * DT, np.random.default_rng(4)
    theta = sum(rng.uniform(1.0, 2.0) / w * np.sin(w * time + rng.uniform(0, 6)) for w in (1.3, 2.9, 4.1))
    true = np.array([1.4, 0.6])
    levels, _ = learned(theta, true)
    distance = np.square(levels - true).sum(axis=1)
    assert np.diff(distance).max() < 1e-12
    assert distance[-1] < 1e-4 * distance[0]


def test_lugre_adaptive_learns_nothing_at_standstill_and_stays_within_its_bounds():
    """Neither from an offset, which an integral would follow without end, nor from creep; a slide ends at the bound."""
    creep = 1e-3 * IDENTIFIED[1].v_s * np.arange(5000) * DT
    for still in (np.zeros(5000), creep):
        assert not learned(still, (1.0, 1.0), offset=5.0)[0].any()
    slide = 0.1 * np.arange(5000) * DT
    for friction, bound in ((9.0, BOUNDS[1]), (-9.0, BOUNDS[0])):
        assert learned(slide, (friction, friction))[0][-1, 0] == bound


def test_lugre_adaptive_begins_as_the_pd_type_observer():
    """Before it has learned; its feedback stays that, with the levels in front of it."""
    observations = random_observations(1, 3, 7)
    np.testing.assert_allclose(
        answers(lugre_adaptive(), observations, joints()), answers(pd_measured(), observations, joints()), rtol=1e-12
    )
    still = np.repeat(observations, 5, axis=0)
    still[..., 7:14] = 0.0
    observer = AdaptiveLuGreObserver(100.0, 20.0, 20.0, 0.8)
    without = answers(pd_measured(), still, joints())
    np.testing.assert_allclose(answers(observer, still, joints()), without, rtol=1e-12)


@pytest.mark.parametrize("make", [feedforward, lugre_nominal])
def test_a_share_of_a_model_is_that_share_of_its_dry_or_of_its_viscous_friction(make):
    observations, p = 1e-3 * random_observations(20, 2), IDENTIFIED[7]
    whole, less_dry, less_viscous = (
        answers(make(**gains), observations, joints()) for gains in ({}, {"dry": 0.5}, {"viscous": 0.25})
    )
    viscous = -p.sigma_2 * observations[..., 7:14]
    np.testing.assert_allclose(whole - less_viscous, 0.75 * viscous, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(less_dry, viscous + 0.5 * (whole - viscous), rtol=1e-9, atol=1e-9)
