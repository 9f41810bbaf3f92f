"""The joint kernel on its own: stiction, sliding, every parameter, independence of the batch."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from fo_gym.certificate.experiments import PAPER, Joint, full_triangle
from fo_gym.friction import LuGre
from fo_gym.friction.bristle import bristle_step
from fo_gym.friction.lugre import bristle_rate
from fo_gym.micro_steps import DEFAULT_PHYSICS_DT as H
from fo_gym.parameters import JOINT
from fo_gym.plant.kernel import _BLOCK, MOTION
from fo_gym.plant.kernels import kernel_of

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
    law = LuGre(**PAPER)
    a = bristle_rate(velocity, law)
    for _ in range(int(40.0 / min(a * H, 1.0))):
        z, tau_f = bristle_step(z, velocity, a, H, law)
    g = 1.0 + 0.5 * np.exp(-((velocity / 1e-3) ** 2))
    assert tau_f == pytest.approx(-np.sign(velocity) * g - 0.4 * velocity, rel=1e-12)


# --- Every parameter counts, every environment stands alone ---------------------------------------------------------

NOMINAL = {"stiffness": 3000.0, "damping": 1.0, "motor_inertia": 1.0, **PAPER}


def driven(**changed: float) -> np.ndarray:
    joint = Joint(**{**NOMINAL, **changed})
    motion = np.zeros(500)
    for k in range(len(motion)):
        joint.advance(3.0 * np.sin(0.02 * k), steps=5)
        motion[k] = joint.theta
    return motion


@pytest.mark.parametrize("name", NOMINAL)
def test_every_parameter_matters(name: str) -> None:
    """Ten per cent more of any of them bends half a second of motion by more than a part in 1e5."""
    base = driven()
    assert np.abs(driven(**{name: 1.1 * NOMINAL[name]}) - base).max() > 1e-5 * np.abs(base).max()


MANY = _BLOCK // 3 + 8
"""Environments of three joints that are more than a block of the kernel's."""


def random_batch(num_envs: int, dof: int) -> dict[str, np.ndarray]:
    """States, torques, inertias and parameters, all different."""
    generator = np.random.default_rng(3)
    scale = np.array([1e-2, 0.1, 1e-2, 0.1, 1e-6])[:, None, None]
    root = generator.normal(size=(num_envs, dof, dof))
    inertia = root @ root.transpose(0, 2, 1) + dof * np.eye(dof)
    spread = generator.uniform(0.5, 2.0, size=(num_envs, dof, len(NOMINAL)))
    values = dict(zip(NOMINAL, np.moveaxis(spread * list(NOMINAL.values()), -1, 0), strict=True))
    friction = np.empty((num_envs, dof), LuGre(**PAPER).dtype)
    for name in PAPER:
        friction[name] = values[name]
    return {
        "state": scale * generator.normal(size=(len(MOTION) + 1, num_envs, dof)),
        "tau_m": generator.normal(size=(num_envs, dof)),
        "tau_ext": generator.normal(size=(num_envs, dof)),
        "damping": generator.uniform(0.0, 2.0, size=(num_envs, dof)),
        "inertia": inertia[:, *np.tril_indices(dof)],
        "joints": np.stack([values[name] for name in JOINT], axis=-1),
        "friction": friction,
    }


def advance_batch(batch: dict[str, np.ndarray], h: float = H) -> tuple[np.ndarray, np.ndarray]:
    """State and mean friction after 10 ms."""
    state, tau_f = batch["state"].copy(), np.zeros_like(batch["tau_m"])
    nothing = np.zeros_like(tau_f)
    links = (nothing, nothing, batch["inertia"], batch["damping"], nothing[0]), full_triangle(tau_f.shape[1])
    parameters = batch["joints"], batch["friction"], h, round(1e-2 / h)
    torques = batch["tau_m"], nothing, batch["tau_ext"]
    kernel_of(LuGre(**PAPER))(state, torques, *links, *parameters, tau_f, 0, len(tau_f))
    return state, tau_f


def rows(batch: dict[str, np.ndarray], ids: list[int] | np.ndarray) -> dict[str, np.ndarray]:
    """The same environments, picked or reordered."""
    return {name: np.ascontiguousarray(v[:, ids] if name == "state" else v[ids]) for name, v in batch.items()}


def test_batch_is_single_to_the_bit() -> None:
    batch = random_batch(num_envs=MANY, dof=3)
    state, tau_f = advance_batch(batch)
    for i in range(MANY):
        alone, friction = advance_batch(rows(batch, [i]))
        np.testing.assert_array_equal(alone[:, 0], state[:, i])
        np.testing.assert_array_equal(friction[0], tau_f[i])


def test_order_of_the_batch_does_not_matter() -> None:
    batch, order = random_batch(num_envs=MANY, dof=3), np.random.default_rng(0).permutation(MANY)
    state, tau_f = advance_batch(batch)
    shuffled, friction = advance_batch(rows(batch, order))
    np.testing.assert_array_equal(shuffled, state[:, order])
    np.testing.assert_array_equal(friction, tau_f[order])


@pytest.mark.parametrize("broken", ["state", "tau_m", "tau_ext", "damping", "inertia", "joints", "friction"])
def test_lost_neighbours_do_not_matter(broken: str) -> None:
    """NaN anywhere in some environments of two blocks stays there."""
    batch, ill = random_batch(num_envs=MANY, dof=3), [0, 4, MANY - 2]
    state, tau_f = advance_batch(batch)
    lost = {name: value.copy() for name, value in batch.items()}
    environments = lost["state"].swapaxes(0, 1) if broken == "state" else lost[broken]
    if broken == "friction":
        environments = environments.view("f8").reshape(*environments.shape, -1)
    environments[ill] = np.nan
    after, friction = advance_batch(lost)
    well = np.delete(np.arange(MANY), ill)
    np.testing.assert_array_equal(after[:, well], state[:, well])
    np.testing.assert_array_equal(friction[well], tau_f[well])
    assert np.isnan(after[:, ill]).any(axis=(0, 2)).all()
    if broken == "inertia":
        assert np.isnan(friction[ill]).all()


def test_coupled_links_follow_the_exact_solution() -> None:
    """Three frictionless joints on links that share a full inertia matrix, with dampers to the world: linear, exact."""
    batch = random_batch(num_envs=4, dof=3)
    for name in set(PAPER) - {"v_s"}:
        batch["friction"][name] = 0.0
    state, tau_f = advance_batch(batch, h=2e-5)
    zero, one = np.zeros((3, 3)), np.eye(3)
    for i in range(4):
        stiffness, damping, motor = batch["joints"][i].T
        inertia = np.zeros((3, 3))
        inertia[np.tril_indices(3)] = batch["inertia"][i]
        inverse = np.linalg.inv(inertia + np.tril(inertia, -1).T)
        K, D, B, W = np.diag(stiffness), np.diag(damping), np.diag(1.0 / motor), np.diag(batch["damping"][i])
        A = np.block(
            [
                [zero, one, zero, zero],
                [-inverse @ K, -inverse @ (D + W), inverse @ K, inverse @ D],
                [zero, zero, zero, one],
                [B @ K, B @ D, -B @ K, -B @ D],
            ]
        )
        constant = np.concatenate([np.zeros(3), inverse @ batch["tau_ext"][i], np.zeros(3), B @ batch["tau_m"][i]])
        augmented = np.zeros((13, 13))
        augmented[:12, :12], augmented[:12, 12] = A, constant
        exact = expm(augmented * 1e-2) @ np.append(batch["state"][:4, i].ravel(), 1.0)
        # Second order: (h omega)^2 / 12 of speeds of 0.3 over a few radians, omega = 200 rad/s.
        assert np.abs(state[:4, i].ravel() - exact[:12]).max() < 2e-6
    np.testing.assert_array_equal(tau_f, 0.0)


def test_a_damper_of_any_strength_only_takes() -> None:
    """A free link that it brings to rest within a micro-step is not thrown back any faster than it came."""
    batch = random_batch(num_envs=4, dof=1)
    batch["damping"] *= 1e6
    batch["joints"][..., :2] = 0.0  # no springs
    batch["tau_ext"][:] = 0.0
    speed = np.abs(batch["state"][1])
    for _ in range(5):
        state, _ = advance_batch(batch)
        assert np.all(np.abs(state[1]) < speed)
        batch["state"], speed = state, np.abs(state[1])


def test_lost_inertia_loses_the_environment() -> None:
    """An M that is not positive definite has no motion: the state says so, and the neighbour goes on."""
    batch = random_batch(num_envs=2, dof=3)
    expected = advance_batch(batch)[0][:, 1]
    batch["inertia"][0] *= -1.0
    state, _ = advance_batch(batch)
    assert np.isnan(state[:, 0]).all()
    np.testing.assert_array_equal(state[:, 1], expected)
