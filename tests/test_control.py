"""Impedance and references, against formulas, SciPy and a plain MuJoCo model."""

from __future__ import annotations

from dataclasses import replace

import gymnasium as gym
import mujoco
import numpy as np
import pytest
from scipy.optimize import root
from scipy.spatial.transform import Rotation

import fo_gym
from envs_assets import asset_path
from fo_gym.control.impedance import Impedance, TaskSetpoint, impedance_torques
from fo_gym.parameters import ImpedanceGains
from fo_gym.plant.links import Links
from fo_gym.robots import LinkSide
from fo_gym.tasks.kinematics import path_table
from fo_gym.tasks.tool_path import ToolPath

REGULATION_ID, SQUARE_ID = "FJRRegulation-v0", "FJRSquare-v0"
ROBOT = LinkSide(asset_path("miro_like"), tuple(f"joint{i}" for i in range(1, 8)), tool="tool")
STIFFNESS = np.array([6000.0, 6000.0, 5000.0, 5000.0, 3000.0, 3000.0, 3000.0])
GAINS = ImpedanceGains(1000.0, 200.0, 10.0, 2.0, 15.0, 3.0)
ELBOW = 2


class Plain:
    """The arm in MuJoCo alone."""

    def __init__(self, mass_scale: float = 1.0) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(asset_path("miro_like")))
        self.model.body_mass *= mass_scale
        self.model.body_inertia *= mass_scale
        self.data = mujoco.MjData(self.model)
        self.home = np.array(self.model.key("home").qpos)

    def at(self, q):
        self.data.qpos[:] = q
        self.data.qvel[:] = 0.0
        mujoco.mj_forward(self.model, self.data)
        return self.data

    def gravity(self, q):
        return self.at(q).qfrc_bias.copy()

    def tool(self, q):
        """Position, rotation and Jacobian (6, 7) of the tool."""
        site = self.at(q).site("tool")
        jacobian = np.zeros((6, 7))
        mujoco.mj_jacSite(self.model, self.data, jacobian[:3], jacobian[3:], site.id)
        return site.xpos.copy(), site.xmat.reshape(3, 3).copy(), jacobian

    def held(self, theta, stiffness):
        """g(q_bar) with K_j (theta - q_bar) = g(q_bar), solved by SciPy, N m."""
        solution = root(lambda q: stiffness * (theta - q) - self.gravity(q), theta, tol=1e-13)
        assert np.abs(solution.fun).max() < 1e-9
        return self.gravity(solution.x)


@pytest.fixture(scope="module")
def plain():
    return Plain()


class Cases:
    """Poses around home, and setpoints around home's tool."""

    def __init__(self, plain: Plain, spread: float, count: int = 20) -> None:
        rng = np.random.default_rng(1)
        self.theta = plain.home + rng.uniform(-spread, spread, (count, 7))
        self.theta_dot = rng.normal(size=(count, 7))
        self.stiffness = STIFFNESS * rng.uniform(0.7, 1.4, (count, 7))
        position, rotation, _ = plain.tool(plain.home)
        position = position + rng.normal(0.0, 0.1, (count, 3))
        self.setpoint = TaskSetpoint(position, rng.normal(size=(count, 3)), rotation, np.array([0.1]))

    def torque(self, gains=GAINS, rows=slice(None)):
        """What the controller answers to these rows in one batch."""
        position, velocity, *constant = self.setpoint
        theta = self.theta[rows]
        law = Impedance(gains, Links(ROBOT), [ELBOW])
        setpoint = TaskSetpoint(position[rows], velocity[rows], *constant)
        tau_c = np.empty(theta.shape)
        known, motor = (self.stiffness[rows], np.ones(len(theta))), (theta, self.theta_dot[rows])
        impedance_torques(law.compiled, *known, *motor, setpoint, tau_c, 0, len(theta))
        return tau_c


def test_statics_of_the_impedance(plain):
    """Three passes leave (K_j^-1 dg/dq)^3 of g: measured 4.4e-7 N m, where g(theta) itself is 0.04 off."""
    cases = Cases(plain, spread=0.5)
    found = cases.torque(ImpedanceGains(1e-20, 0.0, 1e-20, 0.0, 1e-20, 0.0))
    exact = [plain.held(theta, stiffness) for theta, stiffness in zip(cases.theta, cases.stiffness, strict=True)]
    rigid = [plain.gravity(theta) for theta in cases.theta]
    assert np.abs(np.subtract(rigid, exact)).max() > 0.01
    assert np.abs(found - exact).max() < 1e-6


def test_impedance_is_its_formula(plain):
    """To the order claimed: the rotation vector is off by angle^3 / 6 at most, and every joint turns the tool by 1."""
    cases = Cases(plain, spread=0.05)
    found = cases.torque()
    for i, (theta, theta_dot) in enumerate(zip(cases.theta, cases.theta_dot, strict=True)):
        position, rotation, jacobian = plain.tool(theta)
        turn = Rotation.from_matrix(rotation @ cases.setpoint.rotation.T).as_rotvec()
        velocity = jacobian @ theta_dot
        force = -1000.0 * (position - cases.setpoint.position[i]) - 200.0 * (velocity[:3] - cases.setpoint.velocity[i])
        moment = -10.0 * turn - 2.0 * velocity[3:]
        expected = jacobian.T @ np.concatenate([force, moment]) + plain.held(theta, cases.stiffness[i])
        expected[ELBOW] -= 15.0 * (theta[ELBOW] - 0.1) + 3.0 * theta_dot[ELBOW]
        angle = np.linalg.norm(turn)
        assert 0.02 < angle < 0.2
        np.testing.assert_allclose(found[i], expected, rtol=0.0, atol=10.0 * angle**3 / 6.0 + 1e-6)


def test_impedance_of_the_position_alone_holds_four_joints(plain):
    """Without orientation the moment is missing, and every redundant joint has its own spring and damper."""
    cases = Cases(plain, spread=0.05)
    held, kp, kd = [1, 2, 4, 6], np.array([5.0, 15.0, 7.0, 9.0]), np.array([1.0, 3.0, 2.0, 4.0])
    angles = np.array([0.5, 0.1, -0.2, 0.3])
    law = Impedance(replace(GAINS, kp_elbow=kp, kd_elbow=kd), Links(ROBOT), held, oriented=False)
    setpoint = cases.setpoint._replace(held=angles)
    found = np.empty(cases.theta.shape)
    known, motor = (cases.stiffness, np.ones(len(found))), (cases.theta, cases.theta_dot)
    impedance_torques(law.compiled, *known, *motor, setpoint, found, 0, len(found))
    for i, (theta, theta_dot) in enumerate(zip(cases.theta, cases.theta_dot, strict=True)):
        position, _, jacobian = plain.tool(theta)
        rate = jacobian[:3] @ theta_dot - setpoint.velocity[i]
        expected = jacobian[:3].T @ (-1000.0 * (position - setpoint.position[i]) - 200.0 * rate)
        expected += plain.held(theta, cases.stiffness[i])
        expected[held] -= kp * (theta[held] - angles) + kd * theta_dot[held]
        np.testing.assert_allclose(found[i], expected, rtol=0.0, atol=1e-6)
    with pytest.raises(ValueError, match=r"kp_elbow has shape \(4,\)"):
        Impedance(law.gains, law.links, [2])


def test_impedance_row_by_row(plain):
    cases = Cases(plain, spread=0.3)
    rows = [cases.torque(rows=slice(i, i + 1)) for i in range(len(cases.theta))]
    np.testing.assert_array_equal(cases.torque(), np.concatenate(rows))


SQUARE = ToolPath(side=0.15, duration=5.0, first=(0.0, -1.0, 0.0), second=(0.0, 0.0, -1.0))


def test_square_is_a_square():
    """Four sides of 15 cm at right angles, back to the start, then rest for ever."""
    offset, velocity = SQUARE.at(np.array([0.0, 1.25, 2.5, 3.75, 5.0, 9.0]))
    corners = 0.15 * np.array([[0, 0, 0], [0, -1, 0], [0, -1, -1], [0, 0, -1], [0, 0, 0], [0, 0, 0]])
    np.testing.assert_allclose(offset, corners, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(velocity, 0.0, rtol=0.0, atol=1e-15)
    along, _ = SQUARE.at(np.linspace(0.0, 5.0, 5001))
    np.testing.assert_allclose(np.linalg.norm(np.diff(along, axis=0), axis=1).sum(), 0.6, rtol=1e-12)


def test_square_is_smooth():
    """Velocity is the derivative, and acceleration is continuous, inside the sides and across the corners.

    With h = 0.1 ms and a jerk of at most 60 side / T^3 = 4.6 m/s^3, a central difference is good to h^2 jerk / 6 =
    8e-9 m/s (and rounding of 1e-12), and acceleration changes by at most h jerk per step, along each side.
    """
    h, jerk = 1e-4, 60.0 * 0.15 / 1.25**3
    offset, velocity = SQUARE.at(np.arange(-1, 55_000) * h)
    central = (offset[2:] - offset[:-2]) / (2.0 * h)
    assert np.abs(central[1:] - velocity[2:-1]).max() < 1e-8
    acceleration = np.diff(velocity[1:], axis=0) / h
    assert np.abs(np.diff(acceleration, axis=0)).max() < 1.001 * h * jerk
    assert np.abs(acceleration).max() == pytest.approx(10.0 / np.sqrt(3.0) * 0.15 / 1.25**2, rel=1e-3)


@pytest.fixture(scope="module")
def table(plain):
    return path_table(ROBOT, SQUARE, plain.home, 1e-3, ["joint3"])


def test_inverse_kinematics_of_the_square(plain, table):
    """Position, orientation and joint 3 to 1e-9, without jumps, away from singularities; and its gravity torque."""
    home_position, home_rotation, _ = plain.tool(plain.home)
    offset, velocity = SQUARE.at(np.arange(5001) * 1e-3)
    np.testing.assert_allclose(table.position, home_position + offset, rtol=0.0, atol=1e-12)
    np.testing.assert_array_equal(table.velocity, velocity)
    np.testing.assert_allclose(table.rotation, home_rotation, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(table.q_d[[0, -1]], [plain.home, plain.home], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(table.q_d[:, ELBOW], plain.home[ELBOW], rtol=0.0, atol=1e-9)
    assert table.held == plain.home[[ELBOW]]
    smallest = np.inf
    for i in range(0, 5001, 10):
        position, rotation, jacobian = plain.tool(table.q_d[i])
        assert np.abs(position - table.position[i]).max() < 1e-9
        assert Rotation.from_matrix(rotation @ home_rotation.T).magnitude() < 1e-9
        smallest = min(smallest, np.linalg.svd(jacobian, compute_uv=False)[-1])
    assert smallest > 0.1  # 0.183
    # The tool's top speed is 30/16 of a side per 1.25 s; a joint turns at most 1 / smallest times as fast.
    assert np.abs(np.diff(table.q_d, axis=0)).max() < 1e-3 * 30.0 / 16.0 * 0.15 / 1.25 / 0.1


def test_paths_out_of_reach_are_refused(plain):
    far = ToolPath(side=3.0, duration=5.0, first=(1.0, 0.0, 0.0), second=(0.0, 0.0, -1.0))
    with pytest.raises(ValueError, match="out of reach"):
        path_table(ROBOT, far, plain.home, 0.05, ["joint3"])
    rail = LinkSide(asset_path("single_link"), ("joint",))
    with pytest.raises(ValueError, match="needs a robot with a tool"):
        path_table(rail, SQUARE, np.zeros(1), 1e-3, [])
    with pytest.raises(ValueError, match=r"7 joints needs 1 of \('joint1'"):
        path_table(ROBOT, SQUARE, plain.home, 1e-3, [])


def test_friction_free_motion_stays_near_the_reference():
    env = gym.make(SQUARE_ID, friction=fo_gym.FRICTIONLESS)
    obs, _ = env.reset(seed=0)
    truncated, farthest = False, 0.0
    while not truncated:
        signals = fo_gym.Signals.from_observation(obs, 7)
        farthest = max(farthest, np.abs(signals.theta - signals.theta_d).max())
        obs, _, terminated, truncated, _ = env.step(np.zeros(7))
        assert not terminated
    assert farthest < 0.6  # 0.350 rad


@pytest.mark.parametrize("variant", ["nominal", "randomized"])
@pytest.mark.parametrize("env_id", [REGULATION_ID, SQUARE_ID])
def test_theta_d_holds_the_links_at_q_d(env_id, variant, table):
    """theta_d = q_d + K_j^-1 g(q_d), with the episode's own stiffness and masses; before, at and after a step."""
    env = gym.make(env_id, variant=variant, duration=3.5).unwrapped
    target = env.simulation.robot.home + np.linspace(-0.1, 0.1, 7)
    obs, _ = env.reset(seed=3, options=None if env_id == SQUARE_ID else {"target": target})
    (episode,) = env.simulation.scenarios
    plain = Plain(episode.mass_scale)
    assert (episode.mass_scale == 1.0) == (variant == "nominal")
    for tick in range(3050):
        if tick in (0, 1000, 2999, 3000, 3049):
            q_d = table.q_d[tick] if env_id == SQUARE_ID else target if tick >= 3000 else episode.q_start
            theta_d = q_d + plain.gravity(q_d) / env.joint_info.stiffness
            found = fo_gym.Signals.from_observation(obs, 7).theta_d
            np.testing.assert_allclose(found, theta_d, rtol=0.0, atol=1e-12)
        obs = env.step(np.zeros(7))[0]
