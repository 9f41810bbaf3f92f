"""The published competitors: against their equations solved otherwise, and for what their authors claim of them."""

from __future__ import annotations

import inspect
from dataclasses import fields

import gymnasium as gym
import numpy as np
import pytest
from scipy import integrate, optimize, signal

import baselines
import fo_gym
from baselines.feedforward import feedforward
from baselines.garofalo2019 import SuperTwistingObserver, supertwisting
from baselines.kaneko import kaneko
from baselines.kim2019 import pd_high, pd_low, pd_measured, pid_high, pid_low, pid_measured
from baselines.kimchung2015 import KimChungObserver, kimchung
from baselines.l1_observer import l1
from baselines.letien2008 import letien_high, letien_low
from baselines.lugre1995 import IDENTIFIED, MISIDENTIFIED, MISMATCH, lugre_nominal, lugre_off
from fo_gym.envs.arm import ARM_FRICTION
from fo_gym.envs.stiction import STICTION
from fo_gym.evaluation.evaluate import EpisodeSet

DT = 1e-3
NEW = (
    kimchung,
    lugre_nominal,
    lugre_off,
    kaneko,
    supertwisting,
    l1,
    pid_measured,
    pd_measured,
    feedforward,
)
OLD = (pid_high, pid_low, pd_high, pd_low, letien_high, letien_low)
every_new = pytest.mark.parametrize("make", [*NEW, lambda: kimchung(tau_k=True)], ids=lambda make: make.__name__)
GAINS = [
    (kimchung, ("L", "eps", "tie")),
    (kaneko, ("L",)),
    (supertwisting, ("S1", "T1", "S2", "T2")),
    (l1, ("G", "Gp", "K")),
    (pid_measured, ("L", "Lp", "Li")),
    (pd_measured, ("L", "Lp")),
    (feedforward, ("rate",)),
]


def joints(dof=7, control_dt=DT, inertia=1.3, limit=1e9):
    return fo_gym.JointInfo(dof, np.full(dof, inertia), np.full(dof, 3e3), np.full(dof, limit), control_dt)


def random_observations(ticks, num_envs, dof=7, seed=0):
    return np.random.default_rng(seed).normal(size=(ticks, num_envs, 8 * dof + 1))


def answers(observer, observations, info):
    """Estimates (ticks, num_envs, dof) over observations (ticks, num_envs, 8 dof + 1)."""
    observer.reset(info, observations.shape[1])
    return np.array([observer.estimate(fo_gym.Signals.from_observation(obs.copy(), info.dof)) for obs in observations])


def on_a_motor(observer, friction, tau_j, tau_c, dt=DT, inertia=1.3, limit=1e9):
    """Estimates while `observer` compensates a motor under these torques, each (ticks,) and held over its period."""
    observer.reset(joints(1, dt, inertia, limit), 1)
    theta = theta_dot = theta_n = theta_n_dot = tau_m = 0.0
    estimates = np.empty(len(friction))
    for k in range(len(friction)):
        row = np.array([[theta, theta_dot, tau_j[k], theta_n, theta_n_dot, 0.0, tau_c[k], tau_m, k * dt]])
        estimates[k] = observer.estimate(fo_gym.Signals.from_observation(row, 1))[0, 0]
        tau_m = tau_c[k] - np.clip(estimates[k], -limit, limit)
        a = (tau_m - tau_j[k] + friction[k]) / inertia
        a_n = (tau_c[k] - tau_j[k]) / inertia
        theta, theta_dot = theta + dt * theta_dot + 0.5 * dt**2 * a, theta_dot + dt * a
        theta_n, theta_n_dot = theta_n + dt * theta_n_dot + 0.5 * dt**2 * a_n, theta_n_dot + dt * a_n
    return estimates


# What holds for every one of them.


@every_new
def test_one_row_of_a_batch_is_a_batch_of_one(make):
    """To the bit; and neither another episode before nor another inertia's shape changes anything."""
    observations = random_observations(20, 3)
    batch = answers(make(), observations, joints())
    observer = make()
    answers(observer, random_observations(5, 2, seed=1), joints())
    np.testing.assert_array_equal(answers(observer, observations, joints()), batch)
    for i in range(3):
        np.testing.assert_array_equal(answers(make(), observations[:, [i]], joints())[:, 0], batch[:, i])
    info = joints()
    per_row = (np.tile(values, (3, 1)) for values in (info.motor_inertia, info.stiffness, info.torque_limit))
    wide = fo_gym.JointInfo(7, *per_row, DT)
    np.testing.assert_array_equal(answers(make(), observations, wide), batch)


@every_new
def test_signals_are_read_only_to_it_and_copied(make):
    """It writes nothing into what it sees, and does not rely on it staying as it was."""
    observations = random_observations(10, 2)
    expected = answers(make(), observations, joints())
    observer, buffer = make(), np.empty_like(observations[0])
    observer.reset(joints(), 2)
    for obs, estimate in zip(observations, expected, strict=True):
        buffer[:] = obs
        np.testing.assert_array_equal(observer.estimate(fo_gym.Signals.from_observation(buffer, 7)), estimate)
        np.testing.assert_array_equal(buffer, obs)


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
@pytest.mark.parametrize(("make", "gains"), GAINS, ids=lambda x: getattr(x, "__name__", ""))
def test_bad_gains_are_refused_by_name(make, gains, bad):
    for gain in gains:
        with pytest.raises(ValueError, match=rf"\w+: {gain} is {bad}; it must be finite and above 0"):
            make(**{gain: bad})


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_what_k_of_lugre_must_satisfy(bad):
    with pytest.raises(ValueError, match=rf"LuGreObserver: k is {bad}; it must be finite and at least 0"):
        lugre_nominal(k=bad)
    assert lugre_nominal(k=0.0).k == 0.0


@pytest.mark.parametrize("make", [kimchung, kaneko, pid_measured, pd_measured])
def test_bandwidth_beyond_the_sampling_is_refused(make):
    with pytest.raises(ValueError, match=r"L = 100.0 1/s is too fast .* keep L below 100 1/s"):
        make().reset(joints(1, control_dt=0.01), 1)


def test_position_weight_of_l1_beyond_the_sampling_is_refused():
    with pytest.raises(ValueError, match=r"Gp = 100.0 1/s is too fast .* keep Gp at most 50 1/s"):
        l1().reset(joints(1, control_dt=0.01), 1)
    for gains in ({"G": 1e9, "Gp": 500.0}, {"G": 10.0, "Gp": 500.0}):
        friction = np.ones(3000)
        assert on_a_motor(l1(**gains), friction, 0 * friction, 0 * friction)[-1] == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("make", [*NEW, *OLD])
def test_search_space_names_gains_of_the_constructor(make):
    """Ranges are positive, so that they can be searched in their logarithm, and the published gains lie inside."""
    observer = make()
    assert type(observer).__name__ in baselines.__all__
    assert observer.search_space
    for gain, (low, high) in observer.search_space.items():
        assert 0.0 < low <= getattr(observer, gain) <= high
        assert gain in inspect.signature(type(observer)).parameters
        assert gain in vars(make(**{gain: high if gain != "Li" else low}))


# Their equations, solved another way.

TRANSFER = {
    "kimchung": (kimchung, [3 * 100**2, 100**3], np.poly([-100, -100, -100])),
    "pid": (pid_measured, [100, 2000, 10_000], [1, 100, 2000, 10_000]),
    "pd": (pd_measured, [100, 2000], [1, 100, 2000]),
    "kaneko": (kaneko, [100], [1, 100]),
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
    theta, theta_dot, _, theta_n, theta_n_dot, _, _ = observations[:, 0].T
    share = 1.0 - np.exp(-0.3)
    filtered = signal.lfilter([share], [1.0, share - 1.0], theta_n_dot - theta_dot + 100.0 / 3.0 * (theta_n - theta))
    np.testing.assert_allclose(answers(kimchung(), observations, joints(1))[:, 0, 0], -130.0 * filtered, rtol=1e-12)


def test_kimchung_tau_k():
    """Joint by joint: tau_k takes the power (theta_k' - q')^T K_j e, all of it for a small eps, out of theta_k."""
    observations, info, tie = 1e-3 * random_observations(30, 1, 3), joints(3), 7.0
    with_it = answers(KimChungObserver(100.0, tau_k=True, eps=1e-30, tie=tie), observations, info)[:, 0]
    share, d, d_dot, q_dot, filtered = 1.0 - np.exp(-0.3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    for k, row in enumerate(observations[:, 0].reshape(-1, 7, 3)):
        theta, theta_dot, tau_j, theta_n, theta_n_dot = row[:5]
        previous = observations[max(k - 1, 0), 0].reshape(7, 3)
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
    inputs = observations[:, 0, [0, 1, 2, 6]]  # theta, theta', tau_j, tau_c
    gain, share = b * 1e4 / (1.0 + 1e4 * dt), 1.0 - np.exp(-0.15)
    sigma_x = -gain * np.array([100.0, 1.0 + 100.0 * dt, 0.0])
    sigma_u = -np.array([*sigma_x[:2], 0.0, 0.0])
    f_x, f_u = share * sigma_x + [0.0, 0.0, 1.0 - share], share * sigma_u
    a_x, a_u = (sigma_x - f_x) / b, (sigma_u - f_u + [0.0, 0.0, -1.0, 1.0]) / b
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
            free = p_hat + DT * (before[6] - s - before[2] + s) - b * row[1]

            def residual(x, free=free):
                slow = T1 * np.sqrt(abs(x)) * np.sign(x) + T2 * x + DT * (S1 * np.sign(x) + S2 * x)
                return x + DT * slow - free

            x = optimize.brentq(residual, -10.0, 10.0, xtol=1e-15)
            slope = (free - x - DT * (T1 * np.sqrt(abs(x)) * np.sign(x) + T2 * x)) / DT**2
            s, p_hat = s - DT * slope, b * row[1] + x
        assert estimate == pytest.approx(s, rel=1e-6, abs=1e-7)
        before = row


def test_lugre_against_a_stiff_solver():
    """Through presliding, break-away and reversals; 0.1 ms of implicit Euler makes 1 % of the largest friction."""
    p, dt, k = IDENTIFIED[1], 1e-4, 0.05
    time = np.arange(20_000) * dt
    observations = np.zeros((len(time), 1, 7))
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


# The robots that the model-based ones know.


@pytest.mark.parametrize(("dof", "friction"), [(1, STICTION.friction), (7, ARM_FRICTION)])
def test_identified_parameters_are_the_environments(dof, friction):
    for field, factor in zip(fields(friction), MISMATCH, strict=True):
        true = getattr(friction, field.name)
        np.testing.assert_allclose(getattr(IDENTIFIED[dof], field.name), true, rtol=1e-15)
        np.testing.assert_allclose(getattr(MISIDENTIFIED[dof], field.name), factor * np.asarray(true), rtol=1e-15)


def test_mismatch_is_what_its_docstring_says():
    np.testing.assert_array_equal(np.sign(MISMATCH - 1.0), [1, -1, 1, -1, 1, -1])
    assert np.all((np.abs(MISMATCH - 1.0) >= 0.2) & (np.abs(MISMATCH - 1.0) <= 0.3))


@pytest.mark.parametrize("make", [lugre_nominal, lugre_off, feedforward])
def test_an_unknown_robot_asks_for_its_parameters(make):
    with pytest.raises(ValueError, match=r"no friction was identified .* with 3 joints, only for \[1, 7\]; give"):
        make().reset(joints(3), 1)
    make(friction=IDENTIFIED[1]).reset(joints(3), 1)
    with pytest.raises(ValueError, match=r"friction\.sigma_0 has shape \(7,\); .* one for each of the 3"):
        make(friction=IDENTIFIED[7]).reset(joints(3), 1)


# What their authors claim.


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


def test_kimchung_with_tau_k_reaches_the_same_rest():
    """tau_k takes energy only while the joint moves: the end is a rest, near the target."""
    _, theta = theta_at_the_end(lambda: kimchung(tau_k=True))
    assert np.ptp(theta) < 1e-7
    assert abs(theta[-1] - 0.01) < 3e-4


@pytest.mark.parametrize(("nominal", "measured"), [(pid_high, pid_measured), (pd_high, pd_measured)])
def test_measured_feedback_hunts_where_nominal_feedback_does_not(nominal, measured):
    assert (nominal().feedback, measured().feedback) == ("nominal", "measured")
    assert isinstance(measured(), type(nominal()))
    assert np.ptp(theta_at_the_end(nominal)[1]) < 1e-5
    assert np.ptp(theta_at_the_end(measured)[1]) > 5e-4


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


@pytest.mark.parametrize("make", [kaneko, supertwisting, l1])
def test_a_clipped_estimate_does_not_wind_up(make):
    """Friction beyond the torque limit is still estimated as it is, and the next value is found as fast as ever."""
    friction = np.repeat([3.0, 0.5], 2000)
    zero = np.zeros_like(friction)
    estimates = on_a_motor(make(), friction, zero, zero, limit=1.0)
    np.testing.assert_allclose(estimates[[1900, 2300]], [3.0, 0.5], atol=0.01)


def test_feedforward_is_the_friction_of_a_slide_and_pushes_towards_the_target_at_rest():
    rows = np.zeros((2, 1, 7))
    rows[:, 0, 1] = 0.05  # theta'
    rows[1, 0, [0, 5]] = 0.05 * DT  # theta follows theta_d
    slide = answers(feedforward(), rows, joints(1))[1, 0, 0]
    assert slide == pytest.approx(float(IDENTIFIED[1].steady(0.05)), rel=1e-6)
    rows[:] = 0.0
    rows[:, 0, 5] = 0.01  # at rest, before the target: tau_m rises by f_c
    assert answers(feedforward(), rows, joints(1))[0, 0, 0] == pytest.approx(-1.0)
