"""What becomes of a file: which joints move, what is taken, dropped and assumed, and what there is to see."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from robot_files import CRANE, PUSHER, URDF, ur5e

from envs_assets import asset_path
from fo_gym.robots import LinkSide, Robot


def written(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def lines(robot: Robot, kind: str, what: str) -> list[str]:
    return [line.text for line in robot.report.lines if (line.kind, line.what) == (kind, what)]


def test_a_crane_with_everything(tmp_path: Path) -> None:
    robot = Robot.from_file(written(tmp_path / "crane.xml", CRANE))
    assert robot.joints == ("rail", "turn", "bend", "twist", "grip")
    assert robot.units == ("m", "rad", "rad", "rad", "m")
    assert robot.tool == "tip"
    np.testing.assert_allclose(robot.flexible.motor_inertia, [0.05 + 100 * 0.01, 0.05, 0.05, 0.05, 0.05])
    np.testing.assert_allclose(robot.flexible.torque_limit[:2], [20.0, 30.0])
    assert lines(robot, "dropped", "joint grip2") == ["follows joint grip; welded at 0 m"]
    assert lines(robot, "dropped", "joint target_x") == [
        "belongs to a thing apart, which no actuator moves; welded at 0 m"
    ]
    assert lines(robot, "dropped", "joint loose") == ["free: body puck is fixed where it stands"]
    assert lines(robot, "dropped", "joint socket") == ["ball: body ball is welded as it is drawn"]
    assert lines(robot, "taken", "frictionloss") == [
        "[N m | N] rail 0.3: dry friction of the motors, but for placeholders"
    ]
    assert lines(robot, "taken", "damping") == ["rail 2.3, turn 0.2: dampers between the links"]
    for what in ("actuators", "tendons", "equalities", "excludes", "keys", "contacts"):
        assert lines(robot, "dropped", what), what
    assert str(robot.report).count("\n") == len(robot.report.lines) - 1
    model = robot.link_side.model
    assert (model.nq, model.nu, model.neq, model.ntendon, model.nsensor, model.nkey, model.ngeom) == (
        5,
        0,
        0,
        0,
        0,
        0,
        0,
    )
    assert not model.dof_armature.any()
    assert not model.dof_frictionloss.any()
    assert robot.link_side.scene.ngeom == 7


def test_a_keyframe_is_a_home_and_holds_the_others(tmp_path: Path) -> None:
    robot = Robot.from_file(written(tmp_path / "crane.xml", CRANE), joints=("rail", "bend"), home="parked")
    np.testing.assert_array_equal(robot.home, [0.2, 0.4])
    frozen = {"turn": 0.5, "twist": -0.3, "grip": 0.02, "grip2": 0.02, "target_x": 0.1}
    assert dict(robot.link_side.frozen) == frozen
    named = written(tmp_path / "home.xml", CRANE.replace('key name="parked"', 'key name="home"'))
    np.testing.assert_array_equal(Robot.from_file(named, joints=("rail", "bend")).home, [0.2, 0.4])


def test_a_urdf_with_everything(tmp_path: Path) -> None:
    robot = Robot.from_file(written(tmp_path / "two.urdf", URDF))
    assert robot.joints == ("shoulder", "elbow")
    assert robot.tool == "flange"
    assert robot.flexible.torque_limit[0] == 40.0
    model = robot.link_side.model
    np.testing.assert_array_equal(model.jnt_limited, [1, 0])
    np.testing.assert_array_equal(model.dof_damping, [0.7, 0.3])
    assert lines(robot, "dropped", "joint jaw_joint") == ["follows joint elbow; welded at 0 m"]
    assert lines(robot, "dropped", "joint loose") == ["a floating joint: what hangs on it is fixed where it stands"]
    assert "1 not found" in lines(robot, "dropped", "meshes")[0]
    assert "package://nowhere/upper.stl" in lines(robot, "dropped", "meshes")[0]


def test_masses_that_a_urdf_lacks_are_assumed(tmp_path: Path) -> None:
    moving = URDF.replace('type="floating"', 'type="continuous"')
    robot = Robot.from_file(written(tmp_path / "light.urdf", moving))
    assert robot.joints == ("shoulder", "elbow", "loose")
    assert lines(robot, "assumed", "link massless") == ["moves and has no mass; it got 0.001 kg, 1e-06 kg m^2"]
    flat = URDF.replace('ixx="0.02" ixy="0.001"', 'ixx="0" ixy="0"').replace('iyy="0.021"', 'iyy="0"')
    robot = Robot.from_file(written(tmp_path / "flat.urdf", flat))
    assert "not above 0 about all axes" in lines(robot, "assumed", "link upper")[0]
    odd = URDF.replace('izz="0.003"', 'izz="0.3"')
    robot = Robot.from_file(written(tmp_path / "odd.urdf", odd))
    assert "was balanced" in lines(robot, "assumed", "inertia")[0]


def test_who_follows_nobody_stands_still(tmp_path: Path) -> None:
    robot = Robot.from_file(written(tmp_path / "lost.urdf", URDF.replace('mimic joint="elbow"', 'mimic joint="knee"')))
    assert robot.joints == ("shoulder", "elbow")
    assert lines(robot, "dropped", "joint jaw_joint") == ["follows knee, which does not move: it is fixed"]


def test_a_body_may_be_the_tool_where_sites_have_a_material_by_default(tmp_path: Path) -> None:
    text = CRANE.replace("<geom density", '<site material="red"/><geom density')
    text = text.replace("<contact>", '<asset><material name="red" rgba="1 0 0 1"/></asset><contact>')
    assert Robot.from_file(written(tmp_path / "red.xml", text), tool="arm").link_side.model.site("arm").matid[0] == -1


def test_packages_are_found_beside_and_above(tmp_path: Path) -> None:
    folder = tmp_path / "arm_description"
    (folder / "urdf").mkdir(parents=True)
    (folder / "meshes").mkdir()
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [1, 0, 0], [0, 0, 1]]], dtype="<f4")
    faces = [np.zeros(3, "<f4").tobytes() + corner.tobytes() + b"\0\0" for corner in (*corners, *corners[:, ::-1])]
    (folder / "meshes/upper.stl").write_bytes(bytes(80) + len(faces).to_bytes(4, "little") + b"".join(faces))
    text = URDF.replace("package://nowhere/upper.stl", "package://arm_description/meshes/upper.stl")
    robot = Robot.from_file(written(folder / "urdf/arm.urdf", text))
    assert lines(robot, "dropped", "meshes") == []
    assert robot.link_side.scene.nmesh == 1
    assert robot.link_side.model.nmesh == 0


def test_arms_of_packages_work_by_their_files_alone() -> None:
    pusher, arm = Robot.from_file(PUSHER), Robot.from_file(ur5e())
    assert (pusher.dof, arm.dof) == (7, 6)
    assert all(name.startswith("r_") for name in pusher.joints)
    assert arm.tool == "attachment_site"
    assert lines(arm, "taken", "home") == ["keyframe home"]
    np.testing.assert_array_equal(arm.flexible.torque_limit, [150.0] * 3 + [28.0] * 3)
    np.testing.assert_array_equal(arm.flexible.motor_inertia, [0.1] * 6)
    assert arm.link_side.scene.nmesh == 20


@pytest.mark.parametrize("name", ["miro_like", "single_link"])
def test_the_shipped_links_are_their_files_to_the_bit(name: str) -> None:
    """All that dynamics and pictures depend on is the compiled file's: what is edited out was not in it."""
    plain = mujoco.MjModel.from_xml_path(str(asset_path(name)))
    joints = tuple(plain.joint(i).name for i in range(plain.njnt))
    side = LinkSide(asset_path(name), joints)
    prefixes = {
        "model": ("body", "jnt", "dof", "site", "qpos0", "M"),
        "scene": ("body", "jnt", "dof", "geom", "cam", "mat"),
    }
    not_of_links = {"body_geomadr", "body_geomnum", "dof_length"}
    for kind, own in prefixes.items():
        model = getattr(side, kind)
        names = [n for n in dir(plain) if n.split("_")[0] in own and isinstance(getattr(plain, n), np.ndarray)]
        assert len(names) > 40
        differ = [n for n in names if not np.array_equal(getattr(plain, n), getattr(model, n))]
        assert set(differ) <= (not_of_links if kind == "model" else set())


def test_a_file_that_changes_is_read_again(tmp_path: Path) -> None:
    path = written(tmp_path / "crane.xml", CRANE)
    side = Robot.from_file(path, joints=("rail", "turn")).link_side
    before = side.model.body_mass.sum()
    path.write_text(CRANE.replace('density="700"', 'density="1400"'))
    assert side.model.body_mass.sum() == pytest.approx(2.0 * before)


def test_a_model_that_somebody_changes_stays_his_own(tmp_path: Path) -> None:
    side = Robot.from_file(written(tmp_path / "crane.xml", CRANE)).link_side
    side.model.body_mass[:] = 0.0
    assert side.model.body_mass.sum() > 1.0


def test_what_springs_back_and_floats_keeps_its_numbers(tmp_path: Path) -> None:
    """A springdamper is resolved with the armature in place; gravity compensation and drag stay."""
    text = CRANE.replace('range="-90 90"', 'range="-90 90" springdamper="0.2 0.9"')
    text = text.replace('<body name="arm"', '<body name="arm" gravcomp="1"').replace('density="0"', 'density="1.2"')
    path = written(tmp_path / "springs.xml", text)
    whole = mujoco.MjModel.from_xml_path(str(path))
    robot = Robot.from_file(path, joints=("rail", "turn", "bend", "twist"))
    ours, theirs = robot.link_side.model.joint("twist"), whole.joint("twist")
    assert ours.stiffness[0] == theirs.stiffness[0] > 0.0
    assert ours.damping[0] == theirs.damping[0] > 0.0
    for what in ("gravcomp", "medium", "springs of the file"):
        assert lines(robot, "taken", what), what
