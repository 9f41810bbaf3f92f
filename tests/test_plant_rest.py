"""Static equilibrium, masses per environment, and what the robot file itself holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest
from mujoco_arm import MujocoArm, dense_inertia
from pendulum import FRICTION, JOINTS, POSE, MakeRobot, drive, plant_of, varied, write_pendulum

from fo_gym.certificate.cases import WITHOUT_FRICTION
from fo_gym.certificate.oracle import Arm, Control, sampled
from fo_gym.friction import FRICTIONLESS, LuGre
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import LinkSide


def free_arm(robot: LinkSide) -> Arm:
    return MujocoArm(robot.file, JOINTS, WITHOUT_FRICTION)


@pytest.mark.parametrize("friction", [FRICTION, FRICTIONLESS], ids=["friction", "frictionless"])
def test_reset_is_static_equilibrium(pendulum: MakeRobot, friction: LuGre) -> None:
    """With tau_m = g(q), from the file by way of MuJoCo alone, nothing moves for a second: rounding, 1e-12 rad."""
    plant = plant_of(pendulum(), friction=friction)
    gravity = free_arm(pendulum()).gravity(POSE)
    assert np.abs(gravity).min() > 1.0
    np.testing.assert_array_equal(plant.q[0], POSE)
    assert plant.tau_j[0] == pytest.approx(gravity, rel=1e-9)
    start = plant.theta.copy()
    for _ in range(1000):
        plant.step(gravity[None], np.zeros((1, 2)))
    assert np.abs(plant.q - POSE).max() < 1e-12
    assert np.abs(plant.theta - start).max() < 1e-12
    assert np.abs(plant.tau_f).max() < 1e-9


def test_reset_touches_only_the_named_environments(pendulum: MakeRobot) -> None:
    plant = varied(pendulum())
    before, friction = plant.get_state(), plant.tau_f.copy()
    assert np.abs(friction[2]).min() > 0.0
    plant.reset(np.array([2]), POSE)
    after = plant.get_state()
    for name in ("q", "q_dot", "theta", "theta_dot", "z", "time"):
        np.testing.assert_array_equal(getattr(after, name)[[0, 1]], getattr(before, name)[[0, 1]])
    np.testing.assert_array_equal(plant.tau_f[[0, 1]], friction[[0, 1]])
    for moving in (after.q_dot[2], after.theta_dot[2], after.z[2], after.time[2], plant.tau_f[2]):
        np.testing.assert_array_equal(moving, 0.0)


def test_mass_scale_scales_inertia_and_gravity_per_environment(pendulum: MakeRobot) -> None:
    plant, arm = plant_of(pendulum(), num_envs=3), free_arm(pendulum())
    plant.configure(np.array([2]), joints=JOINTS, friction=FRICTION, mass_scale=0.5)
    plant.configure(np.array([0]), joints=JOINTS, friction=FRICTION, mass_scale=3.0)
    pose = np.tile(POSE, (3, 1))
    for i, scale in enumerate([3.0, 1.0, 0.5]):
        np.testing.assert_allclose(plant.body.dense_inertia(pose)[i], scale * dense_inertia(arm, POSE), rtol=1e-10)
        np.testing.assert_allclose(plant.body.gravity(pose)[i], scale * arm.gravity(POSE), rtol=1e-10)
    plant.configure(np.array([0]), joints=JOINTS, friction=FRICTION)
    np.testing.assert_allclose(plant.body.gravity(pose)[0], arm.gravity(POSE), rtol=1e-10)


def test_configure_and_read_back(pendulum: MakeRobot) -> None:
    plant = plant_of(pendulum(), num_envs=2)
    soft = replace(JOINTS, stiffness=np.array([1e3, 2e3]), motor_inertia=0.5)
    plant.configure(np.array([1]), joints=soft, friction=FRICTION)
    np.testing.assert_array_equal(plant.stiffness, [[3e3, 3e3], [1e3, 2e3]])
    np.testing.assert_array_equal(plant.motor_inertia, [[1.0, 1.0], [0.5, 0.5]])


class Free(Control):
    """No torque at all."""

    def __call__(self, theta: Any, v: Any, tau_j: Any) -> Any:
        return np.zeros_like(theta)


def error_of_free_motion(robot: LinkSide, control_dt: float = 1e-3) -> tuple[float, np.ndarray]:
    """Largest error of the links against the solver over 0.4 s without torques; the solver's links at the end."""
    plant = FlexibleJointPlant(robot, 1, joints=JOINTS, friction=FRICTIONLESS, control_dt=control_dt)
    plant.reset(np.array([0]), POSE)
    ticks = round(0.4 / control_dt)
    states = np.stack([plant.q[0], plant.q_dot[0], plant.theta[0], plant.theta_dot[0], plant.z[0]])
    theirs = sampled(free_arm(robot), Free(control_dt), states, np.zeros((ticks, 2)))[:, 0]
    worst = 0.0
    for q in theirs[1:]:
        plant.step(np.zeros((1, 2)), np.zeros((1, 2)))
        worst = max(worst, np.abs(plant.q[0] - q).max())
    return worst, theirs[-1]


@pytest.fixture(scope="module")
def plain_end(tmp_path_factory: pytest.TempPathFactory) -> np.ndarray:
    """Where the links of the pendulum without springs and dampers end: by the solver, which the plant follows."""
    worst, end = error_of_free_motion(write_pendulum(tmp_path_factory.mktemp("plain")))
    assert worst < 1e-5
    return end


@pytest.mark.parametrize(
    "attributes",
    ['stiffness="40" springref="0.8"', 'damping="2"', 'stiffness="40" damping="2"'],
)
def test_passive_joints_of_the_file_are_honoured(pendulum: MakeRobot, plain_end: np.ndarray, attributes: str) -> None:
    """A falling double pendulum whose shoulder has the file's spring or damper, against the solver.

    1e-5 rad on a fall of 0.5 rad, although inertia and all that depends on velocity are held over a control period.
    """
    worst, end = error_of_free_motion(pendulum(shoulder=attributes))
    assert worst < 1e-5
    assert np.abs(end - plain_end).max() > 0.05


def test_limits_and_contacts_stay_out_of_the_loop(pendulum: MakeRobot) -> None:
    """A range that the fall leaves at once, and a floor in its way: neither changes the motion by a bit."""
    expected = drive(plant_of(pendulum()), 300)
    limited = pendulum(
        shoulder='limited="true" range="-0.1 0.31"',
        world='<geom name="floor" type="plane" pos="0 0 -0.2" size="1 1 0.1"/>',
    )
    np.testing.assert_array_equal(drive(plant_of(limited), 300), expected)
    # MuJoCo itself, asked about the last pose, sees both.
    model = mujoco.MjModel.from_xml_path(str(limited.file))
    data = mujoco.MjData(model)
    data.qpos[:] = expected[-1, 0, 0]
    mujoco.mj_forward(model, data)
    assert data.ncon > 0
    assert data.nefc > data.ncon
    assert mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT in data.efc_type


@pytest.mark.parametrize(
    "attributes", ['stiffness="20" springref="0.3"', 'stiffness="40" springref="-0.2" damping="2"']
)
def test_rest_holds_the_springs_of_the_file_too(pendulum: MakeRobot, attributes: str) -> None:
    plant = plant_of(pendulum(elbow=f'axis="0 1 0" {attributes}'), friction=FRICTIONLESS)
    hold = plant.tau_j.copy()
    for _ in range(300):
        plant.step(hold, np.zeros_like(hold))
    # Equilibrium up to rounding, which this pose does not amplify in 0.3 s.
    np.testing.assert_allclose(plant.q[0], POSE, atol=1e-9)
