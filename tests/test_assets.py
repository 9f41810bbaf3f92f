"""The compiled robots: masses, names, absence of anything dissipative, and the numbers that the package relies on."""

import re
from itertools import pairwise
from pathlib import Path

import mujoco
import numpy as np
import pytest

from envs_assets import asset_path

ROBOTS = ("miro_like", "single_link")
JOINTS = [f"joint{i}" for i in range(1, 8)]
README = asset_path("miro_like").with_name("README.md")

# The flexible joints that the arm's inertia has to fit: assumed here, set in the package.
STIFFNESS = np.array([6000.0, 6000, 5000, 5000, 3000, 3000, 3000])  # K_j [N m/rad]
MOTOR_INERTIA = np.array([1.2, 1.2, 1.2, 1.2, 0.6, 0.6, 0.6])  # B [kg m^2]
KP = np.array([50.0, 50, 30, 30, 15, 10, 10])  # joint PD [N m/rad]
MICRO_STEP = 2e-4  # [s]

SIDE = 0.15  # [m]
X, Y, Z = np.eye(3)


class Robot:
    """A compiled model with the few quantities that the tests ask for."""

    def __init__(self, name: str) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(asset_path(name)))
        self.data = mujoco.MjData(self.model)
        self.home = self.model.key("home").qpos.copy()

    def at(self, q: np.ndarray) -> mujoco.MjData:
        self.data.qpos[:] = q
        self.data.qvel[:] = 0
        mujoco.mj_forward(self.model, self.data)
        return self.data

    def inertia(self, q: np.ndarray) -> np.ndarray:
        dense = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.at(q), dense)
        return dense

    def gravity(self, q: np.ndarray) -> np.ndarray:
        return self.at(q).qfrc_bias.copy()

    def gravity_stiffness(self, q: np.ndarray, step: float = 1e-5) -> np.ndarray:
        shifts = step * np.eye(self.model.nv)
        return np.array([self.gravity(q + s) - self.gravity(q - s) for s in shifts]).T / (2 * step)

    def tool(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position (3,), rotation (3, 3) and Jacobian (6, 7) of the tool."""
        site = self.at(q).site("tool")
        jacobian = np.zeros((6, 7))
        mujoco.mj_jacSite(self.model, self.data, jacobian[:3], jacobian[3:], site.id)
        return site.xpos.copy(), site.xmat.reshape(3, 3).copy(), jacobian

    def random_poses(self, count: int, seed: int) -> np.ndarray:
        low, high = self.model.jnt_range.T
        return np.random.default_rng(seed).uniform(low, high, (count, self.model.nq))


@pytest.fixture(scope="module")
def arm() -> Robot:
    return Robot("miro_like")


@pytest.fixture(scope="module")
def single() -> Robot:
    return Robot("single_link")


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


def section(robot: str) -> str:
    """The part of the README that is about one robot."""
    return README.read_text(encoding="utf-8").split(f"\n## {robot}\n")[1].split("\n## ")[0]


def rows(robot: str, first_column: str) -> dict[str, list[str]]:
    """Cells of a README table by the name in the first column; the table is found by that column's title."""
    table = re.search(rf"^\| {first_column} \|.*\n\|[-|]+\n((?:\|.*\n)+)", section(robot), re.MULTILINE)
    assert table, f"README has no table of {first_column}s for {robot}"
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in table[1].splitlines()]
    return {line[0].split("`")[1]: line[1:] for line in lines}


def numbers(cell: str) -> list[float]:
    return [float(n) for n in re.findall(r"-?\d+(?:\.\d+)?", cell)]


# --- the folder ---


@pytest.mark.parametrize("name", ROBOTS)
def test_asset_path_finds_the_file(name: str) -> None:
    path = asset_path(name)
    assert isinstance(path, Path)
    assert path.name == f"{name}.xml"
    assert path.is_file()


@pytest.mark.parametrize("name", ["", "nope", "../pyproject", "miro_like.xml"])
def test_asset_path_names_the_known_robots(name: str) -> None:
    with pytest.raises(ValueError, match="miro_like, single_link"):
        asset_path(name)


def test_every_file_is_tested() -> None:
    assert sorted(file.stem for file in README.parent.glob("*.xml")) == sorted(ROBOTS)


# --- both robots ---


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("kind", ["body", "jnt", "geom", "site", "cam", "light", "mat", "tex", "key"])
def test_every_element_is_named(name: str, kind: str) -> None:
    model = Robot(name).model
    count = getattr(model, {"jnt": "njnt", "cam": "ncam"}.get(kind, f"n{kind}"))
    addresses = getattr(model, f"name_{kind}adr")
    assert count > 0
    assert all(model.names[address] != 0 for address in addresses)


@pytest.mark.parametrize("name", ROBOTS)
def test_nothing_but_rigid_bodies(name: str) -> None:
    model = Robot(name).model
    assert not model.dof_damping.any()
    assert not model.dof_armature.any()
    assert not model.dof_frictionloss.any()
    assert not model.jnt_stiffness.any()
    assert not model.body_gravcomp.any()
    assert not model.geom_contype.any()
    assert not model.geom_conaffinity.any()
    assert model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT
    assert (model.nu, model.neq, model.ntendon, model.npair, model.nsensor) == (0, 0, 0, 0, 0)
    np.testing.assert_array_equal(model.opt.gravity, [0, 0, -9.81])


@pytest.mark.parametrize("name", ROBOTS)
def test_no_constraint_at_home(name: str) -> None:
    robot = Robot(name)
    assert robot.at(robot.home).nefc == 0


@pytest.mark.parametrize("name", ROBOTS)
def test_files_compile_through_specs_too(name: str) -> None:
    direct, spec = Robot(name).model, mujoco.MjSpec.from_file(str(asset_path(name)))
    compiled = spec.compile()
    np.testing.assert_array_equal(compiled.body_inertia, direct.body_inertia)
    np.testing.assert_array_equal(compiled.jnt_range, direct.jnt_range)


@pytest.mark.parametrize("name", ROBOTS)
def test_readme_lists_every_body_joint_and_range(name: str) -> None:
    model = Robot(name).model
    bodies, joints = rows(name, "body"), rows(name, "joint")
    assert set(bodies) == {model.body(i).name for i in range(1, model.nbody)} - {"base"}
    assert all(f"`{model.body(i).name}`" in section(name) for i in range(1, model.nbody))
    for body, cells in bodies.items():
        assert model.body(body).mass[0] == numbers(cells[0])[0]
    assert list(joints) == [model.joint(i).name for i in range(model.njnt)]
    for joint, cells in joints.items():
        low_high = next(match for cell in cells if (match := re.fullmatch(r"(-[\d.]+) to ([\d.]+)", cell)))
        np.testing.assert_array_equal(model.joint(joint).range, [float(limit) for limit in low_high.groups()])


# --- single_link ---


def test_single_link_is_one_kilogram_on_a_rail(single: Robot) -> None:
    model = single.model
    assert (model.nq, model.nv) == (1, 1)
    assert model.body_mass.sum() == 1
    assert model.joint("joint").type[0] == mujoco.mjtJoint.mjJNT_SLIDE
    np.testing.assert_array_equal(model.joint("joint").axis, X)
    for q in (-0.3, 0.0, 0.01):
        assert single.inertia(np.array([q])) == np.ones((1, 1))


def test_single_link_has_no_bias_force(single: Robot) -> None:
    data = single.data
    data.qpos[:], data.qvel[:] = 0.2, 3.0
    mujoco.mj_forward(single.model, data)
    assert data.qfrc_bias[0] == 0


def test_single_link_starts_in_the_middle_of_its_range(single: Robot) -> None:
    assert single.home == 0
    np.testing.assert_array_equal(single.model.joint("joint").range, [-0.5, 0.5])
    assert single.model.jnt_limited.all()


def test_motor_block_is_scenery(single: Robot) -> None:
    motor = single.model.body("motor")
    assert motor.mocapid[0] == 0
    assert motor.mass[0] == 0
    data = single.at(np.zeros(1))
    np.testing.assert_allclose(data.site("spring_link").xpos - data.site("spring_motor").xpos, 0.08 * X, atol=1e-15)
    data.mocap_pos[0] += 0.01 * X
    mujoco.mj_forward(single.model, data)
    np.testing.assert_allclose(data.site("spring_link").xpos - data.site("spring_motor").xpos, 0.07 * X, atol=1e-15)


def test_a_centimetre_is_plainly_visible(single: Robot) -> None:
    camera = single.data.camera("view")
    single.at(np.zeros(1))
    distance = np.linalg.norm(camera.xpos - single.data.body("link").xpos)
    height = 2 * distance * np.tan(np.deg2rad(single.model.camera("view").fovy[0]) / 2)
    assert 0.01 / height > 1 / 30


# --- miro_like ---


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


def test_readme_inertias_are_those_of_the_cylinders(arm: Robot) -> None:
    for body, (mass, axis, radius, length, centre, inertia) in rows("miro_like", "body").items():
        m, r, h = float(mass), float(radius), float(length)
        cylinder = np.full(3, m * (3 * r**2 + h**2) / 12)
        cylinder["xyz".index(axis)] = m * r**2 / 2
        compiled = arm.model.body(body)
        np.testing.assert_allclose(compiled.inertia, cylinder, atol=6e-8)
        np.testing.assert_allclose(compiled.inertia, 1e-3 * np.array(numbers(inertia)), atol=6e-8)
        np.testing.assert_array_equal(compiled.ipos, numbers(centre))
        np.testing.assert_array_equal(compiled.iquat, [1, 0, 0, 0])


def test_readme_frames_and_home(arm: Robot) -> None:
    for index, (moves, axis, _, origin, _, home) in enumerate(rows("miro_like", "joint").values()):
        body = arm.model.body(moves.strip("`"))
        assert body.jntadr[0] == index
        np.testing.assert_array_equal(body.pos, numbers(origin))
        np.testing.assert_array_equal(arm.model.jnt_axis[index], {"+y": Y, "+z": Z}[axis])
        assert arm.home[index] == float(home)


def test_readme_numbers_at_home(arm: Robot) -> None:
    table = {
        line.split("|")[1].split()[0]: [float(x) for x in line.split("|")[2:-1]]
        for line in section("miro_like").split("| at home |")[1].splitlines()[2:5]
    }
    inertia = arm.inertia(arm.home)
    np.testing.assert_allclose(np.diag(inertia), table["M_jj"], atol=6e-4)
    np.testing.assert_allclose(1 / np.diag(np.linalg.inv(inertia)), table["1/(M⁻¹)_jj"], atol=6e-4)
    np.testing.assert_allclose(arm.gravity(arm.home), table["gravity"], atol=6e-3)


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
