"""Found start poses and redundant joints: room, conditioning, the same for an arm of any size."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from arms import SIX, arm, miro

from fo_gym.robots.home import SINGULAR, conditioning, found_home, poor_home, redundant_joints
from fo_gym.robots.poses import CENTRAL, SLIDE, Poses, motion_units, natural_units, scaled

Z, Y = "0 0 1", "0 1 0"
GANTRY = ("1 0 0", "0 1 0", "0 0 1")


def test_every_arm_finds_room_away_from_singular_poses(tmp_path: Path) -> None:
    arms = {
        "one": arm(tmp_path / "1.xml", (Y,)),
        "two": arm(tmp_path / "2.xml", (Z, Y)),
        "three": arm(tmp_path / "3.xml", (Z, Y, Y)),
        "gantry": arm(tmp_path / "g.xml", GANTRY, slides=(0, 1, 2)),
        "five": arm(tmp_path / "5.xml", SIX[:5], slides=(0,)),
        "six": arm(tmp_path / "6.xml"),
        "endless": arm(tmp_path / "e.xml", limited=False),
        "nine": arm(tmp_path / "9.xml", (*SIX, Z, Y, Z), slides=(8,)),
        "miro": miro(),
    }
    offenders = []
    for name, robot in arms.items():
        model = robot.link_side.model
        home, poses = found_home(model, "tool"), Poses(model, "tool")
        central = np.abs(home - 0.5 * (poses.low + poses.high)) <= 0.5 * CENTRAL * (poses.high - poses.low) + 1e-3
        if not central.all() or poor_home(model, home, "tool") is not None:
            offenders.append((name, home, poor_home(model, home, "tool")))
        if model.nq >= 3 and conditioning(poses, home, poses.reach()) < SINGULAR:
            offenders.append((name, "badly conditioned", conditioning(poses, home, poses.reach())))
    assert offenders == []


def test_size_and_mass_of_an_arm_do_not_change_its_home(tmp_path: Path) -> None:
    homes = [found_home(arm(tmp_path / "arm.xml", scale=scale).link_side.model, "tool") for scale in (0.05, 1.0, 5.0)]
    np.testing.assert_array_equal(homes[1:], homes[:-1])


def test_gravity_within_half_of_the_torque_limits(tmp_path: Path) -> None:
    """With limits that are just above the largest load, the pose moves to where gravity takes less of them."""
    model = arm(tmp_path / "arm.xml", (Y, Y)).link_side.model
    poses = Poses(model)
    load = np.max(np.abs([poses.gravity(q) for q in poses.sample(127, share=1.0)]), axis=0)
    free, careful = (poses.gravity(found_home(model, None, limit)) for limit in (None, 1.1 * load))
    assert np.max(np.abs(careful) / load) < 0.56 <= np.max(np.abs(free) / load)


def test_poor_homes_say_why(tmp_path: Path) -> None:
    model = arm(tmp_path / "arm.xml").link_side.model
    assert "'joint2' stands at 2.45" in str(poor_home(model, np.array([0.0, 0.0, 2.45, 0.0, 0.0, 0.0])))
    assert "singular" in str(poor_home(model, np.zeros(6), "tool"))
    assert poor_home(model, np.zeros(6)) is None
    assert poor_home(miro().link_side.model, miro().home, "tool") is None


def test_short_slides_move_within_their_range(tmp_path: Path) -> None:
    """A step of 5 degrees is 8.7 mm of a slide, and 8.7 % of the range of one that is shorter than 0.1 m."""
    long, short = (arm(tmp_path / f"{scale}.xml", ("1 0 0",), slides=(0,), scale=scale) for scale in (1.0, 0.05))
    np.testing.assert_allclose(motion_units(long.link_side.model), [0.1])
    np.testing.assert_allclose(motion_units(short.link_side.model), [0.02])
    np.testing.assert_allclose(natural_units(short.link_side.model), [0.1])


def test_conditioning_is_that_of_the_jacobian(tmp_path: Path) -> None:
    """A gantry's tool moves as its slides do: 0.1 m of each moves it by 0.1 m, which is also its longest lever."""
    model = arm(tmp_path / "g.xml", GANTRY, slides=(0, 1, 2)).link_side.model
    poses = Poses(model, "tool")
    assert poses.reach() == pytest.approx(SLIDE)
    assert conditioning(poses, np.zeros(3), poses.reach()) == pytest.approx(1.0)
    jacobian = scaled(np.ones((6, 3)), np.array([1.0, 1.0, SLIDE]), reach=0.5)
    np.testing.assert_allclose(jacobian, [[2.0, 2.0, 0.2]] * 3 + [[1.0, 1.0, 0.1]] * 3)


def test_redundant_joints_are_those_that_the_tool_needs_least(tmp_path: Path) -> None:
    model = miro().link_side.model
    assert redundant_joints(model, miro().home, "tool") == ("joint3",) == miro().redundant
    assert redundant_joints(arm(tmp_path / "6.xml").link_side.model, np.zeros(6), "tool") == ()
    assert redundant_joints(model, miro().home, None) == ()
    beside = mujoco.MjSpec.from_file(str(arm(tmp_path / "6.xml").link_side.file))
    body = beside.worldbody.add_body(name="beside", mass=1.0, inertia=[1.0, 1.0, 1.0], explicitinertial=True)
    body.add_joint(name="idle", axis=[0.0, 0.0, 1.0])
    model = beside.compile()
    assert redundant_joints(model, found_home(model, "tool"), "tool") == ("idle",)
    four = arm(tmp_path / "4.xml", SIX[:4]).link_side.model
    held = redundant_joints(four, found_home(four, "tool"), "tool")
    assert len(held) == 1
    jacobian = Poses(four, "tool").jacobian(found_home(four, "tool"))[:3]
    left = {f"joint{j}": np.linalg.svd(np.delete(jacobian, j, axis=1), compute_uv=False)[-1] for j in range(4)}
    assert held == (max(left, key=lambda name: left[name]),)
