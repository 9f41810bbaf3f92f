"""Sinusoids of the joints: smooth, from rest to rest, within range and torque of any arm."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from arms import SIX, arm, miro

from fo_gym.control.design import designed_pd
from fo_gym.friction import FRICTIONLESS
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot
from fo_gym.robots.poses import Poses, joint_range
from fo_gym.tasks.joint_fit import AMPLITUDE, TORQUE_SHARE
from fo_gym.tasks.joint_path import JointPath
from fo_gym.tasks.scenario import Scenario

PATH = JointPath(8.0, 1.5, np.array([0.3, 0.02]), np.array([0.2, 0.7]), np.array([0.4, 2.0]))
ALL = slice(None)


def test_the_motion_is_smooth_and_from_rest_to_rest() -> None:
    """Velocity is the derivative of position, and acceleration continuous, also where the envelope's parts meet."""
    h = 1e-4
    time = np.arange(-5000, 85_000) * h
    offset, velocity = PATH.at(time)
    outside = (time <= 0.0) | (time >= 8.0)
    assert np.all(offset[outside] == 0.0)
    assert np.all(velocity[outside] == 0.0)
    # A central difference is good to h^2 / 6 times the third derivative: below (1/s)^3 of 60 / swell^3 + (2 pi f)^3.
    jerk = np.array([0.3, 0.02]) * (60.0 / 1.5**3 + 4.0 * (2.0 * np.pi * np.array([0.2, 0.7]) + 2.0) ** 3)
    central = (offset[2:] - offset[:-2]) / (2.0 * h)
    assert np.all(np.abs(central - velocity[1:-1]).max(axis=0) < h**2 * jerk)
    acceleration = np.diff(velocity, axis=0) / h
    assert np.all(np.abs(np.diff(acceleration, axis=0)).max(axis=0) < 2.0 * h * jerk)
    assert np.all(np.abs(offset).max(axis=0) > [0.29, 0.0195])


def swing(robot: Robot, path: JointPath) -> tuple[np.ndarray, np.ndarray]:
    """Positions and torques (inverse dynamics by MuJoCo, motors added) along the path, (n, dof) each."""
    model, h = robot.link_side.model, 1e-3
    data, joints = mujoco.MjData(model), robot.flexible
    torques, poses = [], []
    for t in np.arange(0.0, path.duration, 0.05):
        offset, velocity = path.at(np.array([t - h, t, t + h]))
        data.qpos[:], data.qvel[:] = robot.home + offset[1], velocity[1]
        data.qacc[:] = (velocity[2] - velocity[0]) / (2.0 * h)
        mujoco.mj_inverse(model, data)
        motors = data.qfrc_inverse + joints.motor_inertia * data.qacc
        torques.append(np.abs(motors))
        poses.append(robot.home + offset[1])
    return np.array(poses), np.array(torques)


def test_fitted_motions_stay_within_range_and_torque(tmp_path: Path) -> None:
    arms = {
        "one": arm(tmp_path / "1.xml", ("0 1 0",)),
        "two": arm(tmp_path / "2.xml", ("0 0 1", "0 1 0")),
        "slides": arm(tmp_path / "s.xml", slides=(0, 4)),
        "endless": arm(tmp_path / "e.xml", limited=False),
        "small": arm(tmp_path / "small.xml", scale=0.1),
        "eight": arm(tmp_path / "8.xml", (*SIX, "0 0 1", "0 1 0")),
        "miro": miro(),
    }
    for name, robot in arms.items():
        path = JointPath(10.0).fitted_to(robot)
        poses, torques = swing(robot, path)
        units = Poses(robot.link_side.model).units
        low, high = joint_range(robot.link_side.model)
        room = np.minimum(robot.home - low, high - robot.home)
        assert np.all(np.abs(poses - robot.home) <= np.minimum(AMPLITUDE * units, 0.5 * room) + 1e-12), name
        assert np.all(torques / robot.flexible.torque_limit < TORQUE_SHARE + 0.05), name
        reversals = np.count_nonzero(np.diff(np.sign(np.diff(poses, axis=0)), axis=0) != 0, axis=0)
        assert np.all(reversals >= 2), name


def test_weak_motors_swing_less_and_those_without_torque_say_so() -> None:
    def limited(limit: float) -> Robot:
        return replace(miro(), flexible=replace(miro().flexible, torque_limit=limit))

    free, weak = (JointPath(10.0).fitted_to(limited(limit)) for limit in (1e3, 30.0))
    assert np.all(np.asarray(weak.amplitude) < np.asarray(free.amplitude))
    with pytest.raises(ValueError, match="joint 'joint2' of robot 'miro_like' has no torque to swing"):
        JointPath(10.0).fitted_to(limited(5.0))


def test_the_motion_is_the_same_without_friction() -> None:
    weak = replace(miro(), flexible=replace(miro().flexible, torque_limit=30.0))
    with_it, without = (JointPath(10.0).fitted_to(each) for each in (weak, replace(weak, friction=FRICTIONLESS)))
    np.testing.assert_array_equal(with_it.amplitude, without.amplitude)


def test_what_is_given_is_kept_and_what_is_wrong_is_named() -> None:
    path = JointPath(10.0, amplitude=0.05, frequency=np.full(7, 0.5)).fitted_to(miro())
    np.testing.assert_array_equal(path.amplitude, np.full(7, 0.05))
    np.testing.assert_array_equal(path.frequency, np.full(7, 0.5))
    assert np.shape(path.phase) == (7,)
    with pytest.raises(ValueError, match=r"JointPath\.amplitude has shape \(3,\)"):
        JointPath(10.0, amplitude=np.ones(3)).fitted_to(miro())
    with pytest.raises(ValueError, match=r"swell is 6 s; a motion of 10 s has at most 5 s"):
        JointPath(10.0, swell=6.0)
    with pytest.raises(ValueError, match=r"JointPath\.frequency"):
        JointPath(10.0, frequency=0.0)
    with pytest.raises(ValueError, match="no amplitude, frequency or phase yet"):
        JointPath(10.0).at(np.zeros(1))


def test_without_friction_the_motor_follows_with_gravity_and_velocity_of_the_path() -> None:
    """At each tick tau_c is its formula; the closed loop leaves what acceleration asks for: (M + B) q'' / K_p."""
    robot = replace(miro(), friction=FRICTIONLESS)
    path = JointPath(4.0, 1.0).fitted_to(robot)
    plant = FlexibleJointPlant(robot.link_side, 1, joints=robot.flexible, friction=FRICTIONLESS)
    gains = designed_pd(robot)
    control = path.control(robot, plant, gains)
    only = np.zeros(1, dtype=np.intp)
    plant.reset(only, robot.home)
    control.reset(only, [Scenario(robot.friction, robot.flexible, 1.0, robot.home, None, None)])
    farthest = 0.0
    for tick in range(4000):
        torque = np.empty((1, plant.dof))
        control.follow(np.array([tick]), plant.theta, plant.theta_dot, torque)
        if tick % 500 == 250:
            offset, velocity = path.at(np.array([tick * 1e-3]))
            gravity = plant.body.gravity(robot.home + offset)
            theta_d = robot.home + offset + gravity / plant.stiffness
            expected = gravity - gains.kp * (plant.theta - theta_d) - gains.kd * (plant.theta_dot - velocity)
            np.testing.assert_allclose(torque, expected, rtol=0.0, atol=1e-9)
            np.testing.assert_allclose(control.desired_links(0), (robot.home + offset)[0], rtol=0.0, atol=1e-12)
        plant.step(torque, np.zeros((1, 7)))
        farthest = max(farthest, float(np.abs(plant.theta - control.theta_d).max()))
    amplitude, rate = np.asarray(path.amplitude), 2.0 * np.pi * np.asarray(path.frequency)
    inertia = Poses(robot.link_side.model).inertia(robot.home).sum(axis=0) + robot.flexible.motor_inertia
    assert 0.002 < farthest < 2.0 * (inertia * amplitude * (rate + 2.0) ** 2 / gains.kp).max()
