"""The compiled arm: its mass, its home, its inertia, and the square that the task draws."""

import re
from itertools import pairwise

import mujoco
import numpy as np
import pytest
from robots import Robot, Y, Z, section

JOINTS = [f"joint{i}" for i in range(1, 8)]

# The flexible joints that the arm's inertia has to fit: assumed here, set in the package.
STIFFNESS = np.array([6000.0, 6000, 5000, 5000, 3000, 3000, 3000])  # K_j [N m/rad]
MOTOR_INERTIA = np.array([1.2, 1.2, 1.2, 1.2, 0.6, 0.6, 0.6])  # B [kg m^2]
KP = np.array([50.0, 50, 30, 30, 15, 10, 10])  # joint PD [N m/rad]
MICRO_STEP = 2e-4  # [s]

SIDE = 0.15  # [m]


@pytest.fixture(scope="module")
def arm() -> Robot:
    return Robot("miro_like")


def augmented(jacobian: np.ndarray) -> np.ndarray:
    """The tool Jacobian with the row of joint 3 below it, (7, 7)."""
    return np.vstack([jacobian, np.eye(7)[2]])


def follow(arm: Robot, corners: list[np.ndarray], points_per_side: int = 10) -> np.ndarray:
    """Joint angles (points, 7) along straight lines between corners, with orientation and joint 3 as at home."""
    rotation_home = arm.tool(arm.home)[1]
    q, path = arm.home.copy(), []
    for start, end in pairwise(corners):
        for s in np.linspace(0, 1, points_per_side + 1)[1:]:
            target = start + s * (end - start)
            for _ in range(20):
                position, rotation, jacobian = arm.tool(q)
                turn = np.zeros(4)
                mujoco.mju_mat2Quat(turn, (rotation_home @ rotation.T).ravel())
                error = np.concatenate([target - position, 2 * turn[1:] * np.sign(turn[0]), [arm.home[2] - q[2]]])
                if np.abs(error).max() < 1e-12:
                    break
                q = q + np.linalg.solve(augmented(jacobian), error)
            assert np.abs(error).max() < 1e-9
            path.append(q)
    return np.array(path)


@pytest.fixture(scope="module")
def square(arm: Robot) -> np.ndarray:
    """The square that the task draws: from home first along -y, then along -z."""
    first, second = -SIDE * Y, -SIDE * Z
    start = arm.tool(arm.home)[0]
    return follow(arm, [start, start + first, start + first + second, start + second, start])


def test_arm_weighs_ten_kilograms(arm: Robot) -> None:
    assert arm.model.body_mass.sum() == pytest.approx(10.0, abs=1e-12)
    assert arm.model.body("base").mass[0] == 0


def test_arm_joints_in_order(arm: Robot) -> None:
    model = arm.model
    assert [model.joint(i).name for i in range(model.njnt)] == JOINTS
    assert [model.body(i).name for i in range(1, model.nbody)] == ["base"] + [f"link{i}" for i in range(1, 8)]
    assert (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE).all()
    np.testing.assert_array_equal(model.jnt_axis, [Z, Y, Z, Y, Z, Y, Z])
    assert model.jnt_limited.all()


def test_arm_stands_straight_up_at_zero(arm: Robot) -> None:
    position, rotation, _ = arm.tool(np.zeros(7))
    np.testing.assert_allclose(position - arm.data.body("link1").xpos, [0, 0, 0.83], atol=1e-12)
    np.testing.assert_allclose(rotation, np.eye(3), atol=1e-12)


def test_pitch_joints_tip_forward(arm: Robot) -> None:
    for joint in (1, 3, 5):
        q = np.zeros(7)
        q[joint] = 0.3
        assert arm.tool(q)[0][0] > 0


def test_home_tool_pose(arm: Robot) -> None:
    position, rotation, _ = arm.tool(arm.home)
    np.testing.assert_allclose(position, [0.403, -0.029, 0.425], atol=6e-4)
    np.testing.assert_allclose(rotation[:, 2], [0.988, -0.153, -0.038], atol=6e-4)


def test_elbow_is_strongly_bent_at_home(arm: Robot) -> None:
    arm.at(arm.home)
    shoulder, elbow, wrist = (arm.data.body(body).xpos for body in ("link2", "link4", "link6"))
    upper_arm, forearm = elbow - shoulder, wrist - elbow
    cosine = upper_arm @ forearm / (np.linalg.norm(upper_arm) * np.linalg.norm(forearm))
    assert np.rad2deg(np.arccos(cosine)) == pytest.approx(133, abs=0.5)


def test_gravity_at_home_is_that_of_such_an_arm(arm: Robot) -> None:
    gravity = arm.gravity(arm.home)
    assert gravity[0] == pytest.approx(0, abs=1e-12)
    assert 10 < abs(gravity[1]) < 25


def test_links_are_not_too_light(arm: Robot) -> None:
    assert np.diag(arm.inertia(arm.home)).min() >= 0.004


def test_inertia_suits_the_micro_step_everywhere(arm: Robot) -> None:
    """M is positive definite and h omega < 1 with a factor of two to spare, singular poses included."""
    poses = arm.random_poses(1500, seed=1)
    for joint, stretched in ((1, poses[:300]), (3, poses[300:600]), (5, poses[600:900])):
        stretched[:, joint] = 0
    poses[:100, [1, 3, 5]] = 0
    root = np.sqrt(STIFFNESS)
    inertias = np.array([arm.inertia(q) for q in np.vstack([arm.home, poses])])
    assert np.linalg.eigvalsh(inertias).min() > 1e-4
    compliance = np.linalg.inv(inertias) + np.diag(1 / MOTOR_INERTIA)
    per_joint = STIFFNESS * np.diagonal(compliance, axis1=1, axis2=2)
    coupled = np.linalg.eigvalsh(root[:, None] * compliance * root)
    assert MICRO_STEP * np.sqrt(per_joint.max()) < 0.5
    assert MICRO_STEP * np.sqrt(coupled.max()) < 0.5


def test_gravity_never_beats_the_joint_pd(arm: Robot) -> None:
    """K_p + dg/dq keeps at least half of K_p, in every direction, at home and up to 5 degrees around it."""
    root = 1 / np.sqrt(KP)
    around = np.deg2rad(5) * np.random.default_rng(2).uniform(-1, 1, (40, 7))
    for q in arm.home + np.vstack([np.zeros(7), np.full(7, -np.deg2rad(5)), around]):
        stiffness = arm.gravity_stiffness(q)
        np.testing.assert_allclose(stiffness, stiffness.T, atol=1e-6)
        assert np.linalg.eigvalsh(np.eye(7) + root[:, None] * stiffness * root).min() > 0.5


def test_square_stays_away_from_singularities(arm: Robot, square: np.ndarray) -> None:
    jacobians = [arm.tool(q)[2] for q in square]
    smallest = np.array([np.linalg.svd(jacobian, compute_uv=False)[-1] for jacobian in jacobians])
    assert smallest.min() > 0.1
    assert max(np.linalg.cond(augmented(jacobian)) for jacobian in jacobians) < 12
    stated = re.search(r"Jacobian \(m and rad mixed\)\s+is\s+between ([\d.]+) and ([\d.]+)", section("miro_like"))
    assert stated, "README does not state the singular values"
    np.testing.assert_allclose([smallest.min(), smallest.max()], [float(x) for x in stated.groups()], atol=6e-4)


def test_square_closes_and_keeps_clear_of_the_limits(arm: Robot, square: np.ndarray) -> None:
    np.testing.assert_allclose(square[-1], arm.home, atol=1e-9)
    low, high = arm.model.jnt_range.T
    assert np.minimum(square - low, high - square).min() > 0.3


def test_home_keeps_clear_of_the_limits(arm: Robot) -> None:
    low, high = arm.model.jnt_range.T
    assert np.minimum(arm.home - low, high - arm.home).min() > 0.4


def test_drawn_shells_do_not_meet_on_the_square(arm: Robot, square: np.ndarray) -> None:
    """Links with two others or more between them, and the base, keep two centimetres apart."""
    model = arm.model
    shells = [i for i in range(model.ngeom) if model.geom_type[i] != mujoco.mjtGeom.mjGEOM_PLANE]
    pairs = [(i, j) for i in shells for j in shells if model.geom_bodyid[j] - model.geom_bodyid[i] > 2]
    for q in square:
        arm.at(q)
        assert min(mujoco.mj_geomDistance(model, arm.data, *pair, 0.5, None) for pair in pairs) > 0.02


def test_camera_sees_the_arm_and_the_square(arm: Robot, square: np.ndarray) -> None:
    """All of both within a 4:3 picture, and beyond 3 cm from the tool no part of the square hidden by the arm."""
    model, data = arm.model, arm.data
    half_size = np.tan(np.deg2rad(model.camera("view").fovy[0]) / 2) * np.array([4 / 3, 1])
    shells = model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE
    drawn = np.array([arm.tool(q)[0] for q in square])
    for q in square:
        tool = arm.tool(q)[0]
        camera = data.camera("view")
        eye, axes = camera.xpos.copy(), camera.xmat.reshape(3, 3)
        seen = (np.vstack([data.geom_xpos[shells], drawn]) - eye) @ axes
        radius = np.append(model.geom_rbound[shells], np.zeros(len(drawn)))
        assert (np.abs(seen[:, :2]) + radius[:, None] < -seen[:, 2:] * half_size).all()
        for point in drawn[np.linalg.norm(drawn - tool, axis=1) > 0.03]:
            hit = mujoco.mj_ray(model, data, eye, point - eye, None, 1, -1, np.zeros(1, dtype=np.int32))
            assert hit < 0 or hit > 1
