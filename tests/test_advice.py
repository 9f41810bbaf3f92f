"""The check list of a robot: its numbers against formulas, and conditions that break where they should."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arms import arm, miro

from fo_gym.control.design import designed_pd
from fo_gym.parameters import PDGains
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot
from fo_gym.robots.advice import Condition


def lines(robot: Robot, **given: object) -> Mapping[str, Condition]:
    return {line.what: line for line in robot.advice(**given).lines}  # type: ignore[arg-type]


def with_joints(robot: Robot, **values: object) -> Robot:
    return replace(robot, flexible=replace(robot.flexible, **values))  # type: ignore[arg-type]


def test_numbers_of_a_slide_are_closed_form(tmp_path: Path) -> None:
    """4 kg on a slide, without gravity along it: modes, bounds of gains and observers by hand."""
    robot = arm(tmp_path / "slide.xml", ("1 0 0",), slides=(0,))
    robot = with_joints(robot, stiffness=9e4, motor_inertia=2.0, torque_limit=50.0)
    robot = replace(robot, friction=replace(robot.friction, sigma_2=np.array([6.0]), f_c=np.ones(1), f_s=np.ones(1)))
    found = lines(robot, gains=PDGains(kp=100.0, kd=10.0))
    assert found["fastest mode"].value == pytest.approx(np.sqrt(9e4 * (1 / 2.0 + 1 / 4.0)))
    assert found["sqrt(K_j / B) dt"].value == pytest.approx(1e-3 * np.sqrt(4.5e4))
    assert found["K_d above c_3 / L, low gains"].bound == pytest.approx(36.0 / (2.0 * 50.0))
    assert found["K_p / (B L L_p), high gains"].value == pytest.approx(100.0 / (2.0 * 2000.0))
    assert found["f_c / K_p, as a share of a step"].value == pytest.approx(0.01 / np.deg2rad(0.5))
    assert found["K_p above |dg/dq|"].bound == pytest.approx(0.0, abs=1e-6)
    assert found["K_p above |dg/dq|"].unit == "N/m"
    assert found["stiction / torque limit"].value == pytest.approx(0.02)
    assert found["distance to a limit / what a step needs"].value == pytest.approx(0.2 / 0.015)
    assert lines(robot, control_dt=4e-3)["L dt, high gains"].value == pytest.approx(0.4)


def test_the_largest_micro_step_is_the_plants() -> None:
    robot = miro()
    plant = FlexibleJointPlant(robot.link_side, 1, joints=robot.flexible, friction=robot.friction)
    advised = plant.advise(np.zeros(1, dtype=np.intp), robot.home[None]).physics_dt.min()
    assert lines(robot)["largest micro-step"].value == pytest.approx(1e3 * advised, rel=1e-9)


def test_designed_robots_meet_what_designs_are_for(tmp_path: Path) -> None:
    """All but the passivity of the friction, which measured joints fail as well."""
    robots = (
        arm(tmp_path / "six.xml"),
        arm(tmp_path / "small.xml", scale=0.1),
        arm(tmp_path / "slides.xml", slides=(0, 3)),
        arm(tmp_path / "one.xml", ("0 1 0",)),
    )
    unmet = {line.what for robot in robots for line in robot.advice(designed_pd(robot)).unmet}
    assert unmet == {"sigma_2, passive friction"}


def test_each_condition_breaks_where_it_should() -> None:
    robot = miro()
    assert robot.pd_gains is not None
    gains = replace(robot.pd_gains, kd=1.0)
    heavy = with_joints(robot, torque_limit=30.0)
    cases = {
        "fastest mode": lines(with_joints(robot, stiffness=1e6)),
        "largest micro-step": lines(with_joints(robot, stiffness=1e6)),
        "sqrt(K_j / B) dt": lines(with_joints(robot, motor_inertia=1e-3)),
        "K_j above |dg/dq|": lines(with_joints(robot, stiffness=20.0)),
        "gravity at home / torque limit": lines(with_joints(robot, torque_limit=20.0)),
        "L dt, high gains": lines(robot, control_dt=6e-3),
        "stiction / torque limit": lines(with_joints(robot, torque_limit=8.0)),
        "K_p above |dg/dq|": lines(robot, gains=replace(gains, kp=40.0)),
        "K_d above c_3 / L, high gains": lines(robot, gains=replace(gains, kd=0.1)),
        "K_p / (B L L_p), low gains": lines(robot, gains=replace(gains, kp=700.0)),
        "f_c / K_p, as a share of a step": lines(robot, gains=replace(gains, kp=2000.0)),
        "torque of a step / what gravity leaves": lines(heavy, gains=replace(gains, kp=400.0)),
        "smallest singular value of J, scaled": lines(replace(robot, home=np.zeros(7))),
        "distance to a limit / what a step needs": lines(replace(robot, home=np.array([2.85, 0, 0, 1, 0, 1, 0]))),
    }
    offenders = [what for what, found in cases.items() if found[what].met]
    assert offenders == []
    before = lines(robot, gains=gains)
    assert [what for what in cases if not before[what].met] == []


def test_it_prints_a_line_for_each_and_leaves_out_what_nobody_gave() -> None:
    robot = replace(miro(), pd_gains=None)
    told = str(robot.advice())
    assert len(told.splitlines()) == len(robot.advice().lines)
    assert "K_p" not in told
    assert "NOT MET  sigma_2, passive friction" in told
    assert "joint7" in next(line for line in told.splitlines() if "fastest mode" in line)
