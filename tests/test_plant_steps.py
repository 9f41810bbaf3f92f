"""What the plant refuses: periods that do not fit, joints too fast to follow, wrong shapes."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mujoco_arm import MujocoArm, dense_inertia
from pendulum import FRICTION, JOINTS, POSE, MakeRobot, plant_of

from fo_gym.friction import FRICTIONLESS
from fo_gym.micro_steps import micro_steps
from fo_gym.plant import FlexibleJointPlant


@pytest.mark.parametrize(
    ("control_dt", "physics_dt", "steps"),
    [
        (1e-3, None, 5),
        (1e-4, None, 1),
        (2e-4, None, 1),
        (13 * 2e-4, None, 13),  # 13.000000000000002 in floating point
        (1e-3, 1e-3, 1),
        (1e-3, 1e-4, 10),
        (1 / 3000, 1 / 9000, 3),
    ],
)
def test_micro_steps(control_dt: float, physics_dt: float | None, steps: int) -> None:
    assert micro_steps(control_dt, physics_dt) == steps


@pytest.mark.parametrize("control_dt", [1e-3, 3e-4, 1 / 3000, 2.5e-3, 1e-5])
def test_default_micro_step_divides_and_is_short(control_dt: float) -> None:
    steps = micro_steps(control_dt, None)
    assert control_dt / steps <= 2e-4 * (1 + 1e-9)
    assert steps == 1 or control_dt / (steps - 1) > 2e-4


@pytest.mark.parametrize(("control_dt", "physics_dt"), [(1e-3, 3e-4), (1e-3, 6e-4), (1e-3, 1e-2), (1 / 3000, 1e-4)])
def test_non_divisor_is_refused_with_a_value_that_works(control_dt: float, physics_dt: float) -> None:
    with pytest.raises(ValueError, match="does not divide") as refusal:
        micro_steps(control_dt, physics_dt)
    assert str(physics_dt) in str(refusal.value)
    advice = float(str(refusal.value).split(";")[1].split()[0])
    assert micro_steps(control_dt, advice) >= 1


@pytest.mark.parametrize("bad", [True, np.True_, 1j, "fast", "2e-4", [1e-4], np.array(1e-4), {}])
def test_a_micro_step_is_a_number_of_seconds(pendulum: MakeRobot, bad: Any) -> None:
    with pytest.raises(ValueError, match=r"physics_dt is .*; give a number (of seconds, \"auto\", or None|in s)"):
        plant_of(pendulum(), physics_dt=bad)


@pytest.mark.parametrize(("control_dt", "physics_dt"), [(1e-3, 1e-12), (1e-3, 5e-324), (1e300, None), (3.0, None)])
def test_more_micro_steps_than_anybody_can_wait_for_are_refused(control_dt: float, physics_dt: float | None) -> None:
    with pytest.raises(ValueError, match=r"makes .* micro-steps in a control period; at most 10000 .*use a longer"):
        micro_steps(control_dt, physics_dt)
    assert micro_steps(1e-3, 1e-7) == 10_000


@pytest.mark.parametrize("bad", [0.0, -1e-3, np.nan, np.inf])
def test_periods_must_be_positive(bad: float) -> None:
    with pytest.raises(ValueError, match="control_dt"):
        micro_steps(bad, None)
    with pytest.raises(ValueError, match="physics_dt"):
        micro_steps(1e-3, bad)


def test_too_long_micro_step_is_refused_with_numbers(pendulum: MakeRobot) -> None:
    """The fastest mode, K_j (1/B + (M^-1)_jj), from the link's own inertia matrix; the advised step is accepted."""
    robot, stiff = pendulum(), replace(JOINTS, stiffness=np.array([3e3, 3e5]))
    arm = MujocoArm(robot.file, stiff, FRICTION)
    inverse = np.linalg.inv(dense_inertia(arm, np.zeros(2)))
    omega = np.sqrt(3e5 * (1.0 + inverse[1, 1]))
    with pytest.raises(ValueError, match=r"0\.0005 s.*'elbow'") as refusal:
        FlexibleJointPlant(robot, 1, joints=stiff, friction=FRICTION, physics_dt=5e-4)
    assert f"is {omega:.4g} 1/s" in str(refusal.value)
    advice = float(str(refusal.value).split("at most ")[1].split()[0])
    steps = round(1e-3 / advice)
    assert advice * omega <= 0.5 < 1.02e-3 / (steps - 1) * omega
    FlexibleJointPlant(robot, 1, joints=stiff, friction=FRICTION, physics_dt=advice)


def test_reset_checks_the_micro_step_of_new_parameters(pendulum: MakeRobot) -> None:
    plant = plant_of(pendulum(), num_envs=2)
    plant.configure(np.array([1]), joints=replace(JOINTS, stiffness=3e6), friction=FRICTION)
    with pytest.raises(ValueError, match="too long"):
        plant.reset(np.array([1]), POSE)
    plant.reset(np.array([0]), POSE)


# --- What friction asks of the micro-step: each of these once ran, and ended far off the solver --------------------

UNFOLLOWED = {
    "its bristle's mode, sqrt(sigma_0 / B)": {"sigma_0": 1e6, "sigma_1": 600.0, "f_s": 1.0},
    "the ringing of its bristle": {"sigma_0": 1e5, "sigma_1": 0.0},
    "its friction's damping": {"sigma_1": 1e3},
    "its Stribeck effect": {"sigma_0": 1e5, "sigma_1": 300.0, "f_s": 100.0},
}


@pytest.mark.parametrize("reason", UNFOLLOWED)
def test_friction_too_fast_for_the_step_is_refused_with_a_step_that_would_do(pendulum: MakeRobot, reason: str) -> None:
    friction = replace(FRICTION, **UNFOLLOWED[reason])
    pattern = rf"physics_dt 0.0002 s is too long for joint 'shoulder': {re.escape(reason)}.* 1/s; use a physics_dt of"
    with pytest.raises(ValueError, match=pattern) as refusal:
        plant_of(pendulum(), friction=friction)
    advice = float(str(refusal.value).split("at most ")[1].split()[0])
    assert plant_of(pendulum(), friction=friction, physics_dt=advice).physics_dt == pytest.approx(advice)
    assert plant_of(pendulum(), friction=friction, physics_dt="auto").physics_dt <= advice * (1 + 1e-9) + 1e-12


def test_what_no_step_follows_is_refused_with_what_would_help(pendulum: MakeRobot) -> None:
    friction, remedy = replace(FRICTION, sigma_0=1e13), "a larger sigma_1 or a smaller sigma_0"
    with pytest.raises(ValueError, match=f"no physics_dt of at most 10000 micro-steps would do; use {remedy}"):
        plant_of(pendulum(), friction=friction)
    with pytest.raises(ValueError, match=rf"\"auto\" for joint 'shoulder' .* 7.*e\+04 micro-steps.*use {remedy}"):
        plant_of(pendulum(), friction=friction, physics_dt="auto")


def test_advice_names_every_joint_and_is_the_limit(pendulum: MakeRobot) -> None:
    """A joint's largest step and its reason; the elbow's bristle is the faster, the shoulder's spring the slower."""
    friction = replace(FRICTION, sigma_0=np.array([1e4, 1e6]), sigma_1=np.array([1e2, 6e2]))
    plant = plant_of(pendulum(), friction=friction, physics_dt="auto")
    advice = plant.advise(np.array([0]), POSE[None])
    assert advice.joints == ("shoulder", "elbow")
    assert advice.physics_dt[1] == pytest.approx(0.125 / 1e3)
    assert "bristle's mode, sqrt(sigma_0 / B) is 1000 1/s" in advice.reasons[1]
    assert advice.physics_dt[0] > advice.physics_dt[1]
    assert plant.steps == int(np.ceil(1e-3 / (0.9 * advice.physics_dt.min())))


def test_a_plant_without_friction_is_bounded_by_its_springs(pendulum: MakeRobot) -> None:
    advice = plant_of(pendulum(), friction=FRICTIONLESS).advise(np.array([0]), POSE[None])
    assert all("fastest mode" in reason for reason in advice.reasons)


# Each of these once corrupted memory, diverged or drifted without a word.


@pytest.mark.parametrize("name", ["tau_m", "tau_ext"])
@pytest.mark.parametrize("rows", [1, 6])
def test_torques_of_another_shape_are_refused(pendulum: MakeRobot, name: str, rows: int) -> None:
    plant = plant_of(pendulum(), num_envs=4)
    before = plant.get_state()
    torques = {"tau_m": np.zeros((4, 2)), "tau_ext": np.zeros((4, 2)), name: np.zeros((rows, 2))}
    with pytest.raises(ValueError, match=rf"{name} has shape \({rows}, 2\); this plant needs \(4, 2\)"):
        plant.step(**torques)
    np.testing.assert_array_equal(plant.get_state().q, before.q)
    np.testing.assert_array_equal(plant.time, before.time)


@pytest.mark.parametrize("scale", [0.0, -1.0, np.nan, np.inf])
def test_impossible_masses_are_refused(pendulum: MakeRobot, scale: float) -> None:
    plant = plant_of(pendulum())
    with pytest.raises(ValueError, match=f"mass scale is .*{scale:g}".replace("-", r"\-")):
        plant.configure(np.array([0]), joints=JOINTS, friction=FRICTION, mass_scale=scale)


def test_a_spring_too_damped_for_the_sweeps_is_refused(pendulum: MakeRobot) -> None:
    with pytest.raises(
        ValueError, match=r"physics_dt .* is too long for joint 'elbow': its spring's damping"
    ) as refusal:
        FlexibleJointPlant(pendulum(), 1, joints=replace(JOINTS, damping=1e4), friction=FRICTION)
    advice = float(str(refusal.value).split("at most ")[1].split()[0])
    assert 0.0 < advice < 2e-4


def test_a_damper_in_the_file_may_be_as_strong_as_it_likes(pendulum: MakeRobot) -> None:
    """D / M of 3e5 1/s: pushed by a torque, the elbow soon creeps at torque / D, as it would in the world."""
    damper, torque = 1e4, 5.0
    plant = FlexibleJointPlant(
        pendulum(elbow=f'axis="0 1 0" damping="{damper:g}"', rest='<option gravity="0 0 0"/>'),
        1,
        joints=replace(JOINTS, motor_inertia=1e-2, stiffness=300.0),
        friction=FRICTIONLESS,
    )
    for _ in range(1000):
        plant.step(np.array([[0.0, torque]]), np.zeros((1, 2)))
    assert plant.q[0, 1] == pytest.approx(torque / damper * plant.time[0], rel=1e-2)


def test_a_lost_environment_says_so_in_its_friction_too(pendulum: MakeRobot, monkeypatch: Any, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warning about the state into the working directory
    plant = plant_of(pendulum(), num_envs=2)
    plant.q[1] = np.nan
    plant.step(np.zeros((2, 2)), np.zeros((2, 2)))
    assert plant.finite.tolist() == [True, False]
    assert np.isfinite(plant.tau_f[0]).all()
    assert np.isnan(plant.tau_f[1]).all()
