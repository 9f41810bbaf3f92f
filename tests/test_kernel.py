"""The joint kernel on its own: stiction, sliding, dissipation, the LuGre experiments, independence of the batch."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference import lugre
from scipy.integrate import odeint
from scipy.linalg import expm

from fo_gym.parameters import LuGre
from fo_gym.plant.kernel import PARAMETERS, STATE, advance, bristle_mean, bristle_rate, bristle_step

PAPER = {"sigma_0": 1e5, "sigma_1": 1e5**0.5, "sigma_2": 0.4, "f_c": 1.0, "f_s": 1.5, "v_s": 1e-3}
NO_FRICTION = {"sigma_0": 0.0, "sigma_1": 0.0, "sigma_2": 0.0, "f_c": 0.0, "f_s": 0.0, "v_s": 1.0}
H = 2e-4
"""The plant's default micro-step, s."""

# Hypothesis looks for counterexamples from a fixed seed, so that a red run stays red.
PROPERTY = settings(max_examples=300, deadline=None, derandomize=True)


def full_triangle(dof: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Layout of a lower triangle without structural zeros, row by row."""
    count = np.arange(1, dof + 1, dtype=np.int32)
    columns = np.concatenate([np.arange(n, dtype=np.int32) for n in count])
    return count, np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.int32), columns


class Joint:
    """One motor on the kernel, with a link of `mass` behind a spring (by default there is no spring)."""

    def __init__(self, mass: float = 1.0, **parameters: float) -> None:
        values = {"stiffness": 0.0, "damping": 0.0, "motor_inertia": 1.0, **PAPER, **parameters}
        self.parameters = np.array([[[values[name] for name in PARAMETERS]]])
        self.inertia = np.array([[mass]])
        self.state = np.zeros((len(STATE), 1, 1))
        self._layout, self._tau_f = full_triangle(1), np.zeros((1, 1))

    def __getattr__(self, name: str) -> float:
        return self.state[STATE.index(name)].item()

    def put(self, **values: float) -> Joint:
        for name, value in values.items():
            self.state[STATE.index(name)] = value
        return self

    def advance(self, tau_m: float = 0.0, steps: int = 1, h: float = H, tau_ext: float = 0.0) -> float:
        """Mean friction torque over the steps."""
        drive, load = np.array([[tau_m]]), np.array([[tau_ext]])
        advance(self.state, drive, load, self.inertia, *self._layout, self.parameters, h, steps, self._tau_f)
        return self._tau_f.item()


# --- Stiction --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("load", [0.3, 0.9, 1.2])
def test_load_below_break_away_is_held(load: float) -> None:
    """Raised over 1 s, then held for 9 s: the motor comes to rest to 1e-15 m/s, and a second moves it by no more."""
    motor = Joint()
    for k in range(1000):
        motor.advance(load * k / 1000, steps=5)
    motor.advance(load, steps=40_000)
    before = motor.theta
    friction = motor.advance(load, steps=5_000)
    assert abs(motor.theta_dot) < 1e-15
    assert abs(motor.theta - before) < 1e-15
    assert friction == pytest.approx(-load, rel=1e-12)
    # Held by the bristle, not by a clamp. LuGre slides a little under way, and its bristle is not pulled any farther.
    assert motor.z == pytest.approx(load / PAPER["sigma_0"], rel=1e-9)
    assert motor.theta > motor.z


def presliding_force(t: float) -> float:
    """Up to 1.425 N at 0.1425 N/s, 5 s held, down to the opposite, 5 s held."""
    return float(np.interp(t, [0.0, 10.0, 15.0, 35.0, 40.0], [0.0, 1.425, 1.425, -1.425, -1.425]))


@pytest.fixture(scope="module")
def presliding() -> np.ndarray:
    """Displacement every millisecond of the kernel's unit mass, (40001,)."""
    motor, history = Joint(), [0.0]
    for k in range(40_000):
        motor.advance(presliding_force((k + 0.5) * 1e-3), steps=5)
        history.append(motor.theta)
    return np.array(history)


def test_presliding_follows_the_solver(presliding: np.ndarray) -> None:
    """0.02 % of the largest displacement, over the whole hysteresis loop."""

    def rates(t: float, x: np.ndarray) -> list[float]:
        z_rate, tau_f = lugre(x[1].item(), x[2].item(), LuGre(**PAPER))
        return [x[1], presliding_force(t) + tau_f, z_rate]

    times = np.arange(40_001) * 1e-3
    options = {"rtol": 1e-9, "atol": 1e-13, "tcrit": [10.0, 15.0, 35.0, 40.0], "mxstep": 10_000}
    theirs = odeint(rates, np.zeros(3), times, tfirst=True, **options)[:, 0]
    assert np.abs(presliding - theirs).max() < 2e-4 * np.abs(theirs).max()


# --- Sliding ---------------------------------------------------------------------------------------------------------


def test_fast_sliding_keeps_to_the_steady_curve() -> None:
    """80 m/s, sigma_0 |v| h / g = 1600: from the second period on friction is steady, and moves only as v does."""
    motor = Joint().put(theta_dot=80.0)
    drive, friction, bristle = 1.0 + 0.4 * 80.0, [], []
    for _ in range(200):
        velocity = motor.theta_dot
        friction.append(motor.advance(drive, steps=5) + 0.4 * 0.5 * (velocity + motor.theta_dot))
        bristle.append(motor.z)
    assert np.abs(np.array(friction[1:]) + 1.0).max() < 1e-6
    assert np.abs(np.diff(friction[1:])).max() < 1e-9, "friction rings from period to period"
    assert bristle == pytest.approx([1e-5] * 200, rel=1e-12), "the bristle rings from period to period"
    # The first period bends the bristle: sigma_1 takes the momentum sigma_1 f_c / sigma_0, however fast it happens.
    assert 1e-3 * (friction[0] + 1.0) == pytest.approx(-PAPER["sigma_1"] / PAPER["sigma_0"], rel=1e-3)


@pytest.mark.parametrize("velocity", [1e-5, 1e-3, 2e-3, 0.1, -0.1, 80.0])
def test_prescribed_velocity_reaches_the_steady_curve(velocity: float) -> None:
    z = 0.0
    a = bristle_rate(velocity, PAPER["sigma_0"], PAPER["f_c"], PAPER["f_s"], PAPER["v_s"])
    for _ in range(int(40.0 / min(a * H, 1.0))):
        z, tau_f = bristle_step(z, velocity, a, H, PAPER["sigma_0"], PAPER["sigma_1"], PAPER["sigma_2"])
    g = 1.0 + 0.5 * np.exp(-((velocity / 1e-3) ** 2))
    assert tau_f == pytest.approx(-np.sign(velocity) * g - 0.4 * velocity, rel=1e-12)


# --- Properties of the bristle step, for any parameters ------------------------------------------------------------

signed = st.floats(-1.0, 1.0)


def magnitude(low: float, high: float) -> st.SearchStrategy[float]:
    """Powers of ten from 10^low to 10^high."""
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


velocities = st.tuples(st.sampled_from([-1.0, 1.0]), magnitude(-9, 3)).map(lambda pair: pair[0] * pair[1])
bristles = {
    "sigma_0": magnitude(1, 7),
    "f_c": magnitude(-2, 2),
    "ratio": st.floats(1.0, 3.0),
    "v_s": magnitude(-4, 0),
    "v": velocities,
    "part": signed,
    "h": magnitude(-6, -1),
}


@PROPERTY
@given(**bristles)
def test_bristle_relaxes_without_overshoot(sigma_0, f_c, ratio, v_s, v, part, h) -> None:
    """The exact bristle nears v/a from one side; so does the step at any sigma_0 |v| h; |z| stays in f_s/sigma_0."""
    z = part * ratio * f_c / sigma_0
    a = bristle_rate(v, sigma_0, f_c, ratio * f_c, v_s)
    after, _ = bristle_step(z, v, a, h, sigma_0, 0.0, 0.0)
    rounding = 1e-12 * ratio * f_c / sigma_0 + 1e-15 * h * abs(v)
    low, high = sorted([z, v / a])
    assert low - rounding <= after <= high + rounding
    assert abs(after) <= ratio * f_c / sigma_0 + rounding


@PROPERTY
@given(**bristles)
def test_bristle_stores_no_more_than_it_is_given(sigma_0, f_c, ratio, v_s, v, part, h) -> None:
    """Passivity of the bristle spring, step by step: d(sigma_0 z^2 / 2) <= -tau_f v h, from any deflection."""
    z = 10.0 * part * ratio * f_c / sigma_0
    a = bristle_rate(v, sigma_0, f_c, ratio * f_c, v_s)
    after, tau_f = bristle_step(z, v, a, h, sigma_0, 0.0, 0.0)
    stored, given_ = 0.5 * sigma_0 * (after**2 - z**2), -tau_f * v * h
    assert stored <= given_ + 1e-12 * (sigma_0 * z**2 + abs(given_))


@PROPERTY
@given(a=magnitude(-6, 6), h=magnitude(-6, -1), z=signed, v=signed)
def test_bristle_mean_is_the_mean(a, h, z, v) -> None:
    """The weights give the mean of the exact solution but for terms of second order, z (a h)^2 and v a h^2."""
    x = a * h
    w_z, w_v = bristle_mean(a, h)
    decay = -np.expm1(-x) / x
    exact = z * decay + v / a * (1.0 - decay)
    assert abs(w_z * z + w_v * v - exact) <= (x * x * abs(z) + x * h * abs(v)) / 5 + 1e-15 * (abs(z) + abs(v / a))
    assert w_z + a * w_v == pytest.approx(1.0, rel=1e-12), "z = v/a must stay where it is"


@PROPERTY
@given(
    inertia=magnitude(-1, 1),
    sigma_0=magnitude(3, 5),
    damping=st.floats(0.0, 2.0),
    f_c=magnitude(-1, 1.5),
    ratio=st.floats(1.0, 2.0),
    v_s=magnitude(-4, -1),
    part=signed,
    v=velocities,
    drive=st.floats(-100.0, 100.0),
    stiffness=st.sampled_from([0.0, 3e3]),
)
def test_motor_is_stable(inertia, sigma_0, damping, f_c, ratio, v_s, part, v, drive, stiffness) -> None:
    """Any start, 1000 m/s included, and any drive: finite; bristle near its bounds; no more speed than was put in.

    Torn off within a single micro-step, the motor takes the bristle a little too far, because the rate a lags by a
    fixed-point pass (up to 17 % at sigma_0 h^2 / B = 0.04). That lasts no longer than the jerk.
    """
    f_s, sigma_1 = ratio * f_c, damping * (sigma_0 * inertia) ** 0.5
    friction = {"sigma_0": sigma_0, "sigma_1": sigma_1, "f_c": f_c, "f_s": f_s, "v_s": v_s}
    motor = Joint(motor_inertia=inertia, stiffness=stiffness, **friction).put(theta_dot=v, z=part * f_s / sigma_0)
    deflection = []
    for _ in range(50):
        motor.advance(drive)
        deflection.append(abs(motor.z) * sigma_0 / f_s)
    assert np.isfinite(motor.state).all()
    assert max(deflection) <= 1.25
    assert deflection[-1] <= 1.01
    # 50 steps of the drive, and what the bristle's own spring and damper may hand out.
    gain = 50 * H * abs(drive) / inertia + 2.0 * f_s / (sigma_0 * inertia) ** 0.5 * (1.0 + damping)
    assert abs(motor.theta_dot) <= abs(v) + 1.05 * gain


# --- Energy ----------------------------------------------------------------------------------------------------------


def energy(joint: Joint) -> float:
    """Kinetic, spring and bristle energy of two unit masses."""
    spring, bristle = joint.parameters[0, 0, PARAMETERS.index("stiffness")], joint.parameters[0, 0, 3]
    kinetic = 0.5 * joint.q_dot**2 + 0.5 * joint.theta_dot**2
    return kinetic + 0.5 * spring * (joint.theta - joint.q) ** 2 + 0.5 * bristle * joint.z**2


@pytest.mark.parametrize("sigma_2", [0.4, 200.0], ids=["paper", "passive"])
def test_friction_only_takes_energy(sigma_2: float) -> None:
    """Free motion of motor and link for 4 s, D_j = 0: through slips, reversals and stiction energy never grows.

    sigma_2 = 200 meets LuGre's sufficient condition for passivity, the paper's 0.4 does not. Either way 1e-6 of the
    start is left to the step, whose own energy swings by (h omega)^2 / 8 = 3e-5 of the spring's.
    """
    generator = np.random.default_rng(7)
    for _ in range(5):
        q, w, theta, v = generator.normal(size=4) * [1e-2, 0.3, 1e-2, 0.3]
        joint = Joint(stiffness=3000.0, sigma_2=sigma_2).put(q=q, q_dot=w, theta=theta, theta_dot=v)
        start = lowest = energy(joint)
        for _ in range(20_000):
            joint.advance()
            now = energy(joint)
            assert now < lowest + 1e-6 * start
            lowest = min(lowest, now)
        assert lowest < 1e-2 * start, "friction took nothing"


def test_frictionless_joint_conserves_energy() -> None:
    """10 s: the symmetric step's energy swings by up to (h omega)^2 / 4 = 6e-5 and does not drift (1e-9)."""
    joint = Joint(stiffness=3000.0, **NO_FRICTION).put(theta=1e-2, q_dot=0.2)
    start, history = energy(joint), []
    for _ in range(50_000):
        joint.advance()
        history.append(energy(joint) / start - 1.0)
    assert np.abs(history).max() < (H**2 * 6000.0) / 4
    assert abs(max(history[-5000:]) - max(history[:5000])) < 1e-9


def test_internal_forces_keep_momentum() -> None:
    """Spring forces cancel: only tau_m, tau_f and tau_ext move the two masses together."""
    joint = Joint(stiffness=3000.0, mass=2.0)
    momentum, total = 0.0, 0.0
    for k in range(500):
        drive, push = 3.0 * np.sin(0.03 * k), np.cos(0.05 * k)
        momentum += 1e-3 * (drive + push + joint.advance(drive, steps=5, tau_ext=push))
        total = max(total, abs(momentum))
        assert joint.theta_dot + 2.0 * joint.q_dot == pytest.approx(momentum, abs=1e-13)
    assert total > 0.1


@pytest.mark.parametrize(("damping", "bound"), [(2.0, 5e-6), (77.0, 5e-7), (200.0, 4e-6)])
def test_damped_spring_follows_the_exact_solution(damping: float, bound: float) -> None:
    """Without friction the joint is linear: 1 s against the matrix exponential, on 1e-2; critical damping is 95."""
    mass, inertia, stiffness = 0.5, 1.0, 3000.0
    springs = np.array([[-1.0, 1.0], [1.0, -1.0]]) / np.array([[mass], [inertia]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [stiffness * springs, damping * springs]])
    joint = Joint(mass=mass, stiffness=stiffness, damping=damping, **NO_FRICTION).put(theta=1e-2, q_dot=0.3)
    worst = 0.0
    for k in range(1, 1001):
        joint.advance(steps=5)
        q, theta, *_ = expm(A * k * 1e-3) @ [0.0, 1e-2, 0.3, 0.0]
        worst = max(worst, abs(joint.theta - theta), abs(joint.q - q))
    assert worst < bound


# --- The LuGre experiments of Canudas de Wit et al. (1995), unit mass, parameters above: 2 % -----------------------


def test_experiment_presliding(presliding: np.ndarray) -> None:
    assert presliding[15_000] == pytest.approx(45.3e-6, rel=0.02)
    assert presliding[40_000] == pytest.approx(-10.0e-6, rel=0.02)


def lag_loop(omega: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and friction force over the last of four periods of v = 1e-3 (1.5 + cos(omega t))."""
    per_period = round(2 * np.pi / omega / H)
    velocity = 1e-3 * (1.5 + np.cos(2 * np.pi * (np.arange(4 * per_period) + 0.5) / per_period))
    z, force = 0.0, np.zeros_like(velocity)
    for k, v in enumerate(velocity):
        a = bristle_rate(v, PAPER["sigma_0"], PAPER["f_c"], PAPER["f_s"], PAPER["v_s"])
        z, tau_f = bristle_step(z, v, a, H, PAPER["sigma_0"], PAPER["sigma_1"], PAPER["sigma_2"])
        force[k] = -tau_f
    return velocity[-per_period:], force[-per_period:]


@pytest.mark.parametrize(("omega", "largest"), [(1.0, 1.389), (10.0, 1.378), (25.0, 1.344)])
def test_experiment_frictional_lag(omega: float, largest: float) -> None:
    assert lag_loop(omega)[1].max() == pytest.approx(largest, rel=0.02)


def test_experiment_frictional_lag_widens_with_frequency() -> None:
    """Friction is larger while the velocity rises; the area between the branches grows with the frequency."""
    loops = [lag_loop(omega) for omega in (1.0, 10.0, 25.0)]
    areas = [float(np.sum(force * np.gradient(velocity))) for velocity, force in loops]
    assert 0 < areas[0] < areas[1] < areas[2]


@pytest.mark.parametrize(
    ("rate", "force"),
    [(1, 1.432), (2, 1.394), (5, 1.313), (10, 1.220), (20, 1.099), (30, 1.024), (40, 0.989), (50, 0.968)],
)
def test_experiment_break_away(rate: float, force: float) -> None:
    """Largest friction before |v| passes 2 v_s, under a force ramp in N/s: the faster, the lower."""
    motor, largest, k = Joint(), 0.0, 0
    while abs(motor.theta_dot) < 2e-3:
        largest = max(largest, -motor.advance(rate * (k + 0.5) * H))
        k += 1
    assert largest == pytest.approx(force, rel=0.02)


def test_experiment_stick_slip() -> None:
    """A mass pulled over a spring of 2 N/m whose end, here a link too heavy to notice, moves at 0.1 m/s."""
    motor = Joint(stiffness=2.0, mass=1e15).put(q_dot=0.1)
    position, velocity = np.zeros(34_000), np.zeros(34_000)
    for k in range(len(position)):
        motor.advance(steps=5)
        position[k], velocity[k] = motor.theta, motor.theta_dot
    onsets = np.flatnonzero((velocity[1:] > 1e-2) & (velocity[:-1] <= 1e-2))
    assert 1e-3 * onsets[0] == pytest.approx(7.46, rel=0.02)
    assert 1e-3 * np.diff(onsets) == pytest.approx([6.36] * 4, rel=0.02)
    assert np.diff(position[onsets - 1000]) == pytest.approx([0.636] * 4, rel=0.02)
    assert velocity.max() == pytest.approx(0.37, rel=0.02)


def test_experiment_hunting() -> None:
    """PID position control of the mass, K_v = 6, K_p = 3, K_i = 4, to x = 1 m."""
    motor, integral, position = Joint(), 0.0, np.zeros(120_000)
    for k in range(len(position)):
        error = motor.theta - 1.0
        motor.advance(-6.0 * motor.theta_dot - 3.0 * error - 4.0 * integral, steps=5)
        integral += 1e-3 * error
        position[k] = motor.theta
    error, late = position - 1.0, position[60_000:] - 1.0
    rises = np.flatnonzero((error[1:] > 0) & (error[:-1] <= 0)) * 1e-3
    assert position.max() == pytest.approx(1.50, rel=0.02)
    assert (late.max(), late.min()) == pytest.approx((0.0645, -0.0645), rel=0.02)
    assert rises[-1] - rises[-2] == pytest.approx(24.4, rel=0.02)


# --- Every parameter counts, every environment stands alone ---------------------------------------------------------

NOMINAL = {"stiffness": 3000.0, "damping": 1.0, "motor_inertia": 1.0, **PAPER}


def driven(**changed: float) -> np.ndarray:
    joint = Joint(**{**NOMINAL, **changed})
    motion = np.zeros(500)
    for k in range(len(motion)):
        joint.advance(3.0 * np.sin(0.02 * k), steps=5)
        motion[k] = joint.theta
    return motion


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_parameter_matters(name: str) -> None:
    """Ten per cent more of any of them bends half a second of motion by more than a part in 1e5."""
    base = driven()
    assert np.abs(driven(**{name: 1.1 * NOMINAL[name]}) - base).max() > 1e-5 * np.abs(base).max()


def random_batch(num_envs: int, dof: int) -> dict[str, np.ndarray]:
    """States, torques, inertias and parameters, all different."""
    generator = np.random.default_rng(3)
    scale = np.array([1e-2, 0.1, 1e-2, 0.1, 1e-6])[:, None, None]
    root = generator.normal(size=(num_envs, dof, dof))
    inertia = root @ root.transpose(0, 2, 1) + dof * np.eye(dof)
    spread = generator.uniform(0.5, 2.0, size=(num_envs, dof, len(PARAMETERS)))
    return {
        "state": scale * generator.normal(size=(len(STATE), num_envs, dof)),
        "tau_m": generator.normal(size=(num_envs, dof)),
        "load": generator.normal(size=(num_envs, dof)),
        "inertia": inertia[:, *np.tril_indices(dof)],
        "parameters": spread * [NOMINAL[name] for name in PARAMETERS],
    }


def advance_batch(batch: dict[str, np.ndarray], h: float = H) -> tuple[np.ndarray, np.ndarray]:
    """State and mean friction after 10 ms."""
    state, tau_f = batch["state"].copy(), np.zeros_like(batch["tau_m"])
    layout, steps = full_triangle(tau_f.shape[1]), round(1e-2 / h)
    advance(state, batch["tau_m"], batch["load"], batch["inertia"], *layout, batch["parameters"], h, steps, tau_f)
    return state, tau_f


def rows(batch: dict[str, np.ndarray], ids: list[int] | np.ndarray) -> dict[str, np.ndarray]:
    """The same environments, picked or reordered."""
    return {name: np.ascontiguousarray(v[:, ids] if name == "state" else v[ids]) for name, v in batch.items()}


def test_batch_is_single_to_the_bit() -> None:
    batch = random_batch(num_envs=5, dof=3)
    state, tau_f = advance_batch(batch)
    for i in range(5):
        alone, friction = advance_batch(rows(batch, [i]))
        np.testing.assert_array_equal(alone[:, 0], state[:, i])
        np.testing.assert_array_equal(friction[0], tau_f[i])


def test_order_of_the_batch_does_not_matter() -> None:
    batch, order = random_batch(num_envs=5, dof=3), np.array([3, 0, 4, 1, 2])
    state, tau_f = advance_batch(batch)
    shuffled, friction = advance_batch(rows(batch, order))
    np.testing.assert_array_equal(shuffled, state[:, order])
    np.testing.assert_array_equal(friction, tau_f[order])


@pytest.mark.parametrize("broken", ["state", "tau_m", "load", "inertia", "parameters"])
def test_lost_neighbours_do_not_matter(broken: str) -> None:
    """NaN anywhere in environments 0 and 4 stays there."""
    batch = random_batch(num_envs=5, dof=3)
    state, tau_f = advance_batch(batch)
    lost = {name: value.copy() for name, value in batch.items()}
    environments = lost["state"].swapaxes(0, 1) if broken == "state" else lost[broken]
    environments[[0, 4]] = np.nan
    after, friction = advance_batch(lost)
    np.testing.assert_array_equal(after[:, 1:4], state[:, 1:4])
    np.testing.assert_array_equal(friction[1:4], tau_f[1:4])
    assert np.isnan(after[:, [0, 4]]).any(axis=(0, 2)).all()


def test_coupled_links_follow_the_exact_solution() -> None:
    """Three frictionless joints on links that share a full inertia matrix: linear, so again exact."""
    batch = random_batch(num_envs=4, dof=3)
    batch["parameters"][..., 3:8] = 0.0
    state, tau_f = advance_batch(batch, h=2e-5)
    zero, one = np.zeros((3, 3)), np.eye(3)
    for i in range(4):
        stiffness, damping, motor = batch["parameters"][i, :, :3].T
        inertia = np.zeros((3, 3))
        inertia[np.tril_indices(3)] = batch["inertia"][i]
        inverse = np.linalg.inv(inertia + np.tril(inertia, -1).T)
        K, D, B = np.diag(stiffness), np.diag(damping), np.diag(1.0 / motor)
        A = np.block(
            [
                [zero, one, zero, zero],
                [-inverse @ K, -inverse @ D, inverse @ K, inverse @ D],
                [zero, zero, zero, one],
                [B @ K, B @ D, -B @ K, -B @ D],
            ]
        )
        constant = np.concatenate([np.zeros(3), inverse @ batch["load"][i], np.zeros(3), B @ batch["tau_m"][i]])
        augmented = np.zeros((13, 13))
        augmented[:12, :12], augmented[:12, 12] = A, constant
        exact = expm(augmented * 1e-2) @ np.append(batch["state"][:4, i].ravel(), 1.0)
        # Second order: (h omega)^2 / 12 of speeds of 0.3 over a few radians, omega = 200 rad/s.
        assert np.abs(state[:4, i].ravel() - exact[:12]).max() < 2e-6
    np.testing.assert_array_equal(tau_f, 0.0)


def test_lost_inertia_loses_the_environment() -> None:
    """An M that is not positive definite has no motion: the state says so, and the neighbour goes on."""
    batch = random_batch(num_envs=2, dof=3)
    expected = advance_batch(batch)[0][:, 1]
    batch["inertia"][0] *= -1.0
    state, _ = advance_batch(batch)
    assert np.isnan(state[:, 0]).all()
    np.testing.assert_array_equal(state[:, 1], expected)
