"""What is designed for an arm that nobody has measured: followed by the default step, bounded, the same in any unit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arms import SIX, arm, miro

from fo_gym.control.design import TOMEI, designed_impedance, designed_pd
from fo_gym.micro_steps import DEFAULT_PHYSICS_DT
from fo_gym.parameters import FlexibleJoint
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot
from fo_gym.robots.design import (
    ACCELERATION,
    BRISTLE_MODE,
    FRICTION_DECELERATION,
    designed_friction,
    designed_joints,
)
from fo_gym.robots.home import found_home
from fo_gym.robots.poses import SLIDE, Poses
from fo_gym.tasks.randomization import Randomization

Z, Y = "0 0 1", "0 1 0"
ONLY = np.zeros(1, dtype=np.intp)


def test_the_default_step_follows_every_designed_arm_and_what_is_drawn_of_it(tmp_path: Path) -> None:
    """From 5 cm to 4 m of reach, wrists of a ten-thousandth of the mass, slides, endless joints; in any pose."""
    fastest = Randomization().fastest
    arms = {
        "tiny": arm(tmp_path / "tiny.xml", scale=0.05),
        "large": arm(tmp_path / "large.xml", scale=4.0),
        "light wrist": arm(tmp_path / "light.xml", wrist=1e-4),
        "slides": arm(tmp_path / "slides.xml", slides=(0, 5)),
        "endless": arm(tmp_path / "endless.xml", limited=False),
        "one": arm(tmp_path / "one.xml", (Y,)),
        "nine": arm(tmp_path / "nine.xml", (*SIX, Z, Y, Z)),
        "miro": miro(),
    }
    offenders = []
    for name, robot in arms.items():
        model = robot.link_side.model
        joints = designed_joints(model, robot.home)
        friction = designed_friction(model, joints)
        plant = FlexibleJointPlant(robot.link_side, 1, joints=joints, friction=friction)
        plant.reset(ONLY, robot.home)
        # The fastest joints and bristles of the "randomized" variant.
        plant.configure(
            ONLY,
            joints=replace(
                joints,
                stiffness=joints.stiffness * fastest.stiffness[1],
                motor_inertia=joints.motor_inertia * fastest.motor_inertia[0],
            ),
            friction=replace(
                friction,
                sigma_0=friction.sigma_0 * fastest.bristle[1],
                sigma_1=friction.sigma_1 * np.sqrt(fastest.bristle[1]),
                sigma_2=friction.sigma_2 * fastest.viscous[1],
                f_s=friction.f_c + (friction.f_s - friction.f_c) * fastest.stiction[1],
            ),
            mass_scale=fastest.mass[0],
        )
        poses = np.random.default_rng(1).uniform(Poses(model).low, Poses(model).high, (20, model.nq))
        longest = [plant.advise(ONLY, q[None]).physics_dt.min() for q in poses]
        if not min(longest) >= DEFAULT_PHYSICS_DT:
            offenders.append((name, min(longest)))
    assert offenders == []


def test_what_the_file_gives_is_taken(tmp_path: Path) -> None:
    model = arm(tmp_path / "arm.xml").link_side.model
    home = found_home(model, "tool")
    armature = np.array([0.1, 0.0, 0.03, 4.0, 0.0, 1e-4])
    limit = np.array([150.0, np.inf, 28.0, 28.0, np.inf, 12.0])
    joints = designed_joints(model, home, armature=armature, torque_limit=limit)
    free = designed_joints(model, home)
    np.testing.assert_array_equal(joints.motor_inertia[armature > 0], armature[armature > 0])
    np.testing.assert_array_equal(joints.torque_limit[np.isfinite(limit)], limit[np.isfinite(limit)])
    assert np.all(joints.motor_inertia > 0)
    assert np.all(np.isfinite(joints.torque_limit))
    assert joints.torque_limit[1] == free.torque_limit[1]
    # A frictionloss that hardly slows the motor is a placeholder, one near the torque limit an error; others are f_c.
    loss = np.array([0.01, 0.0, 40.0, 2.0, 1.0, 0.3])
    friction, assumed = (designed_friction(model, free, frictionloss=each) for each in (loss, None))
    taken = (loss >= free.motor_inertia) & (loss <= 0.25 * free.torque_limit)
    assert 0 < np.count_nonzero(taken) < len(taken)
    np.testing.assert_array_equal(friction.f_c, np.where(taken, loss, assumed.f_c))


def test_measured_arms_lie_within_the_rules() -> None:
    """The shipped arm's own numbers, which the paper and its neighbours gave: the rules give the same, within 3."""
    model = miro().link_side.model
    home = miro().home
    limit = np.array([150.0, 150.0, 100.0, 100.0, 50.0, 40.0, 40.0])
    joints = designed_joints(model, home, torque_limit=limit)
    friction = designed_friction(model, joints)
    ours = {
        "B": (joints.motor_inertia, [1.2, 1.2, 1.2, 1.2, 0.6, 0.6, 0.6]),
        "K_j": (joints.stiffness, [6000.0, 6000.0, 5000.0, 5000.0, 3000.0, 3000.0, 3000.0]),
        "f_c": (friction.f_c, miro().friction.f_c),
        "sigma_2": (friction.sigma_2, miro().friction.sigma_2),
    }
    offenders = {name: found / np.array(known) for name, (found, known) in ours.items()}
    assert {name: ratio for name, ratio in offenders.items() if ratio.max() > 3.0 or ratio.min() < 1 / 3.0} == {}


def test_a_slide_is_a_hinge_with_a_lever_of_a_tenth_of_a_metre(tmp_path: Path) -> None:
    """m on a slide without gravity against m (0.1 m)^2 about a vertical axis: forces times 0.1 m are torques."""
    text = (
        '<mujoco><worldbody><body name="link"><joint name="j" type="{}" axis="{}"/>'
        '<inertial mass="3" pos="0 0 0" diaginertia="{} {} {}"/></body></worldbody></mujoco>'
    )
    robots = []
    for kind, axis, inertia in (("slide", "1 0 0", 1e-3), ("hinge", "0 0 1", 3.0 * SLIDE**2)):
        path = tmp_path / f"{kind}.xml"
        path.write_text(text.format(kind, axis, inertia, inertia, inertia), encoding="utf-8")
        robots.append(Robot.from_file(path))
    (slide, slide_friction), (hinge, hinge_friction) = ((robot.flexible, robot.friction) for robot in robots)
    assert slide.torque_limit[0] * SLIDE == pytest.approx(hinge.torque_limit[0], rel=0.05)
    for name in ("motor_inertia", "stiffness", "damping"):
        assert getattr(slide, name)[0] * SLIDE**2 == pytest.approx(getattr(hinge, name)[0], rel=0.05), name
    for name, power in (("f_c", 1), ("f_s", 1), ("sigma_0", 2), ("sigma_1", 2), ("sigma_2", 2)):
        found = getattr(slide_friction, name)[0] * SLIDE**power
        assert found == pytest.approx(getattr(hinge_friction, name)[0], rel=0.1), name
    assert slide_friction.v_s[0] == pytest.approx(SLIDE * hinge_friction.v_s[0])
    # K_p / (M + B) = (5 rad/s)^2 and K_d / (M + B) = 2 0.5 5 rad/s, in either unit.
    for robot, mass in zip(robots, (3.0, 3.0 * SLIDE**2), strict=True):
        gains, total = designed_pd(robot), robot.flexible.motor_inertia[0] + mass
        assert (gains.kp[0], gains.kd[0]) == pytest.approx((25.0 * total, 5.0 * total))


def test_friction_slows_as_measured_arms_do(tmp_path: Path) -> None:
    least, most = FRICTION_DECELERATION
    robot = arm(tmp_path / "arm.xml", wrist=1e-3)
    slowed = robot.friction.f_c / robot.flexible.motor_inertia
    assert np.all((slowed > 0.95 * least) & (slowed < 1.05 * most))
    assert np.all(robot.friction.sigma_0 / robot.flexible.motor_inertia <= BRISTLE_MODE**2 * (1 + 1e-12))
    assert np.all(robot.flexible.motor_inertia <= 1.06 * robot.flexible.torque_limit / ACCELERATION)


def test_gravity_has_one_rest_under_the_designed_gains(tmp_path: Path) -> None:
    """Tomei: K_p + dg/dq and K_j + dg/dq are positive definite in any pose, also those that the design never saw."""
    for robot in (arm(tmp_path / "arm.xml"), arm(tmp_path / "slides.xml", slides=(1, 4)), miro()):
        model = robot.link_side.model
        gains, poses = designed_pd(robot), Poses(model)
        assert np.all(gains.kp >= TOMEI * poses.gravity_bound())
        for q in np.random.default_rng(2).uniform(poses.low, poses.high, (50, robot.dof)):
            slope = 0.5 * (poses.gravity_slope(q) + poses.gravity_slope(q).T)
            assert np.linalg.eigvalsh(np.diag(gains.kp) + slope)[0] > 0.0
            assert np.linalg.eigvalsh(np.diag(robot.flexible.stiffness) + slope)[0] > 0.0


def test_impedance_of_a_gantry_is_closed_form(tmp_path: Path) -> None:
    """Three slides at right angles: the tool's inertia along each is what that slide carries, motors included."""
    axes, masses = ("1 0 0", "0 1 0", "0 0 1"), np.array([4.0 + 2.4 + 1.44, 2.4 + 1.44, 1.44])
    robot = arm(tmp_path / "gantry.xml", axes, slides=(0, 1, 2))
    robot = replace(robot, flexible=FlexibleJoint(1e5, 0.0, np.array([1.0, 2.0, 8.0]), 1e3))
    gains = designed_impedance(robot)
    total = masses + robot.flexible.motor_inertia
    # 250 1/s^2 of the lightest motor, 1 kg, is more than (10 rad/s)^2 of the mean mass only where that is below 2.5 kg.
    assert gains.kp_position == pytest.approx(min(100.0 * np.prod(total) ** (1 / 3), 250.0))
    assert gains.kd_position == pytest.approx(min(2.0 * np.sqrt(gains.kp_position * np.prod(total) ** (1 / 3)), 200.0))


def test_the_papers_gains_follow_on_the_shipped_arm() -> None:
    """1000 N/m and K_p = 50 at joint 2, with the arm's own motors; orientation and damping are not below."""
    gains = designed_impedance(miro())
    assert gains.kp_position == pytest.approx(1000.0, rel=0.1)
    assert designed_pd(miro()).kp[1] == pytest.approx(50.0, rel=0.05)
    rest = np.array([gains.kd_position, gains.kp_orientation, gains.kd_orientation])
    assert np.all((rest > [200.0, 10.0, 2.0]) & (rest < [400.0, 40.0, 8.0]))


def test_an_impedance_needs_a_tool_that_moves(tmp_path: Path) -> None:
    robot = arm(tmp_path / "arm.xml", (Y, Y, Y))
    with pytest.raises(ValueError, match="cannot move its tool in 3 directions at home"):
        designed_impedance(robot)
    with pytest.raises(ValueError, match="has no tool"):
        designed_impedance(replace(robot, link_side=replace(robot.link_side, tool=None)))
