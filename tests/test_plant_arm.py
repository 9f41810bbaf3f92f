"""The plant on the seven-joint arm against SciPy: link accelerations from Pinocchio."""

from __future__ import annotations

import numpy as np
import pytest

from envs_assets import asset_path
from fo_gym.certificate.oracle import Arm, Control, sampled
from fo_gym.friction import FRICTIONLESS, LuGre
from fo_gym.parameters import FlexibleJoint
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import LinkSide, robot_of

ROBOT = LinkSide(asset_path("miro_like"), tuple(f"joint{i}" for i in range(1, 8)))

INERTIA = np.array([1.0, 1.0, 0.6, 0.6, 0.3, 0.2, 0.2])
COULOMB = np.array([3.0, 3.0, 2.0, 2.0, 1.0, 0.8, 0.8])
SIGMA_0 = 1e4 / 3.0 * COULOMB
JOINTS = FlexibleJoint(
    stiffness=np.array([6e3, 6e3, 5e3, 5e3, 3e3, 3e3, 3e3]), damping=0.0, motor_inertia=INERTIA, torque_limit=200.0
)
FRICTION = LuGre(
    sigma_0=SIGMA_0,
    sigma_1=np.sqrt(SIGMA_0 * INERTIA),
    sigma_2=np.array([5.0, 5.0, 3.0, 3.0, 1.0, 0.6, 0.6]),
    f_c=COULOMB,
    f_s=1.4 * COULOMB,
    v_s=0.01,
)
TICKS = 1000


def control(arm: Arm, home: np.ndarray) -> Control:
    """Joint PD with nominal feedback and the PD-type observer at low gains, stepping every joint by -5 degrees."""
    target = home - np.deg2rad(5.0)
    gravity, start = arm.gravity(target), home + arm.gravity(home) / JOINTS.stiffness
    return Control(
        1e-3,
        motor_inertia=INERTIA,
        k_p=np.array([50.0, 50.0, 30.0, 30.0, 15.0, 10.0, 10.0]),
        k_d=np.array([2.0, 2.0, 1.2, 1.2, 0.6, 0.4, 0.4]),
        theta_d=target + gravity / JOINTS.stiffness,
        feedforward=gravity,
        L=50.0,
        L_p=10.0,
        nominal=True,
        theta_n=start,
    )


def rest(arm: Arm, home: np.ndarray) -> np.ndarray:
    """Static equilibrium at home, bristles relaxed: (5, 7)."""
    still = np.zeros(7)
    return np.stack([home, still, home + arm.gravity(home) / JOINTS.stiffness, still, still])


@pytest.fixture(scope="module")
def arm() -> Arm:
    return Arm(ROBOT.model, JOINTS, FRICTION)


@pytest.fixture(scope="module")
def home() -> np.ndarray:
    return robot_of("miro_like").home


def pushes() -> np.ndarray:
    """A torque on joints 2 and 6 from 0.5 to 0.8 s, (ticks, 7), N m: above the friction there."""
    torque = np.zeros((TICKS, 7))
    torque[500:800, [1, 5]] = [10.0, 1.0]
    return torque


def run(plant: FlexibleJointPlant, law: Control, tau_ext: np.ndarray) -> np.ndarray:
    """Links and motors of every environment at the ticks, (ticks + 1, 2, num_envs, 7)."""
    history = [np.stack([plant.q, plant.theta])]
    for push in tau_ext:
        plant.step(law(plant.theta, plant.theta_dot, plant.tau_j), np.broadcast_to(push, plant.q.shape))
        history.append(np.stack([plant.q, plant.theta]))
    return np.array(history)


def plant_at(home: np.ndarray, num_envs: int = 1) -> FlexibleJointPlant:
    plant = FlexibleJointPlant(ROBOT, num_envs, joints=JOINTS, friction=FRICTION)
    plant.reset(np.arange(num_envs), home)
    return plant


@pytest.mark.slow
def test_reference_is_converged(arm: Arm, home: np.ndarray) -> None:
    """Two other families of solvers agree to a hundredth of what the plant is allowed."""
    start, still = rest(arm, home), np.zeros((TICKS, 7))
    lsoda = sampled(arm, control(arm, home), start, still)[:, [0, 2]]
    explicit = sampled(arm, control(arm, home), start, still, method="DOP853", rtol=1e-11)[:, [0, 2]]
    implicit = sampled(arm, control(arm, home), start, still[:100], method="Radau", rtol=1e-8, atol=1e-11)[:, [0, 2]]
    assert np.abs(lsoda - explicit).max() < 1e-7
    assert np.abs(lsoda[:101] - implicit).max() < 1e-7


@pytest.mark.parametrize("tau_ext", [np.zeros((TICKS, 7)), pushes()], ids=["step", "step-and-push"])
def test_one_second_follows_the_solver(arm: Arm, home: np.ndarray, tau_ext: np.ndarray) -> None:
    """5e-5 rad, on moves of 0.12 rad and more: what is left when inertia and bias are held over a period of 1 ms."""
    theirs = sampled(arm, control(arm, home), rest(arm, home), tau_ext)[:, [0, 2]]
    ours = run(plant_at(home), control(arm, home), tau_ext)[:, :, 0]
    assert np.ptp(theirs, axis=0).min() > 0.1
    assert np.abs(ours - theirs).max() < 5e-5


def test_push_is_felt(arm: Arm, home: np.ndarray) -> None:
    """Guards the case above: the push moves the arm a hundred times farther than the bound."""
    still = run(plant_at(home), control(arm, home), 0.0 * pushes())
    assert np.abs(run(plant_at(home), control(arm, home), pushes()) - still).max() > 5e-3


def test_arm_does_not_depend_on_its_neighbours(arm: Arm, home: np.ndarray) -> None:
    """To the bit, between a heavier arm and a frictionless one that starts elsewhere."""
    alone = run(plant_at(home), control(arm, home), pushes())[:, :, 0]
    plant = plant_at(home, num_envs=3)
    plant.configure(np.array([0]), joints=JOINTS, friction=FRICTION, mass_scale=1.3)
    plant.configure(np.array([2]), joints=JOINTS, friction=FRICTIONLESS)
    plant.reset(np.array([0, 2]), 0.5 * home)
    np.testing.assert_array_equal(run(plant, control(arm, home), pushes())[:, :, 1], alone)
