"""Kinematics and gravity of the links against MuJoCo's own passes, on the arm and on a tree of all kinds of joints."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from fo_gym import Robot
from fo_gym.plant.links import Links
from fo_gym.robots import LinkSide
from fo_gym.robots.shipped import robot_of

TREE = """
<mujoco>
  <compiler angle="radian"/>
  <option gravity="1.5 -2.0 -9.0" density="1.2" wind="3 0 0"/>
  <worldbody>
    <body name="cart" pos="0.1 0.2 0.3" quat="0.9 0.1 0.3 -0.2">
      <joint name="rail" type="slide" axis="1 2 0.5" pos="0.1 0 0" stiffness="20" springref="0.05"/>
      <joint name="turn" axis="0 1 1" pos="0.05 -0.02 0.1" ref="0.4" stiffness="3 -0.7 1.1" springref="-0.2"/>
      <geom type="box" size="0.1 0.05 0.08" pos="0.02 0.01 0.05" mass="2"/>
      <body name="plate" pos="0 0 0.2" quat="0.7 0 0.7 0">
        <geom type="box" size="0.03 0.05 0.02" pos="0.1 0 0" mass="0.7"/>
        <body name="upper" pos="0.2 0 0" gravcomp="0.6">
          <joint name="bend" axis="0.3 -1 0.2" pos="0 0.03 0"/>
          <geom type="capsule" size="0.03" fromto="0 0 0 0.3 0.1 0" mass="1.5"/>
          <body name="hand" pos="0.3 0.1 0">
            <joint name="reach" type="slide" axis="0 0 1"/>
            <geom type="sphere" size="0.04" pos="0.02 0.03 0.1" mass="0.4"/>
            <site name="tip" pos="0.05 -0.02 0.2" quat="0.5 0.5 -0.1 0.7"/>
          </body>
        </body>
        <body name="side" pos="-0.2 0.1 0">
          <joint name="swing" axis="1 0 0"/>
          <geom type="capsule" size="0.02" fromto="0 0 0 0 0.3 0.1" mass="0.9"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
JOINTS = ("rail", "turn", "bend", "reach", "swing")


def tree(folder: Path) -> LinkSide:
    """A cart on a rail with two arms, one of which carries the tool."""
    file = folder / "tree.xml"
    file.write_text(TREE, encoding="utf-8")
    return LinkSide(file, JOINTS, tool="tip")


@pytest.fixture(params=["arm", "tree"])
def link_side(request: pytest.FixtureRequest, tmp_path: Path) -> LinkSide:
    return tree(tmp_path) if request.param == "tree" else robot_of("miro_like").link_side


def mujoco_says(link_side: LinkSide, q: np.ndarray, mass: float) -> tuple[np.ndarray, ...]:
    """g(q), tool position, rotation and Jacobian, by MuJoCo's own passes on the compiled link side."""
    model = link_side.model
    model.body_mass *= mass
    data = mujoco.MjData(model)
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    site = data.site(link_side.tool)
    jacobian = np.zeros((6, model.nv))
    mujoco.mj_jacSite(model, data, jacobian[:3], jacobian[3:], site.id)
    return data.qfrc_bias - data.qfrc_passive, site.xpos.copy(), site.xmat.reshape(3, 3).copy(), jacobian


def test_gravity_and_tool_are_mujocos(link_side: LinkSide) -> None:
    """To rounding, 1e-13 of values up to a few hundred; masses scale gravity, and not the file's springs."""
    links = Links(link_side)
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.0, 2.0, (20, link_side.dof))
    mass = rng.uniform(0.5, 2.0, len(q))
    pose, gravity = links.tool_pose(q), links.gravity(q, mass)
    np.testing.assert_array_equal(links.tool_position(q), pose.position)
    for i in range(len(q)):
        expected, position, rotation, jacobian = mujoco_says(link_side, q[i], mass[i])
        assert np.abs(expected).max() > 0.1
        np.testing.assert_allclose(gravity[i], expected, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(pose.position[i], position, rtol=0.0, atol=1e-13)
        np.testing.assert_allclose(pose.rotation[i], rotation, rtol=0.0, atol=1e-13)
        np.testing.assert_allclose(pose.jacobian[i], jacobian, rtol=0.0, atol=1e-13)


def test_row_by_row(link_side: LinkSide) -> None:
    """Neighbours and the size of the batch change no bit, nor does an array that lies otherwise."""
    links = Links(link_side)
    q = np.random.default_rng(1).uniform(-2.0, 2.0, (7, link_side.dof))
    np.testing.assert_array_equal(links.gravity(q), np.concatenate([links.gravity(row[None]) for row in q]))
    np.testing.assert_array_equal(links.gravity(np.asfortranarray(q)), links.gravity(q))
    together, apart = links.tool_pose(q), [links.tool_pose(row[None]) for row in q]
    for whole, *parts in zip(together, *apart, strict=True):
        np.testing.assert_array_equal(whole, np.concatenate(parts))


def test_a_link_side_without_a_tool_says_so(tmp_path: Path) -> None:
    links = Links(LinkSide(tree(tmp_path).file, JOINTS))
    q = np.full((2, len(JOINTS)), 0.3)
    assert np.isfinite(links.gravity(q)).all()
    assert np.isnan(links.tool_position(q)).all()


def test_a_wind_is_dropped_and_reported(tmp_path: Path) -> None:
    """The drag of still air acts on links that move; a wind would be a load that no gravity torque balances."""
    side = tree(tmp_path)
    assert side.model.opt.density == 1.2
    assert not side.model.opt.wind.any()
    robot = Robot.from_file(side.file, joints=JOINTS, tool="tip")
    assert any("wind" in line for line in str(robot.report).splitlines())
