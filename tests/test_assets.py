"""The compiled robots: names, absence of anything dissipative, and the numbers of their README."""

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from robots import README, ROBOTS, Robot, Y, Z, numbers, rows, section

from envs_assets import asset_path

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


# --- the README ---


@pytest.fixture(scope="module")
def arm() -> Robot:
    return Robot("miro_like")


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
