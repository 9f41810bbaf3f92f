"""Robots with hinges and slides: what is told of them is told in one unit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fo_gym
from fo_gym.compensators import NoCompensation
from fo_gym.evaluation.episode.recorder import record
from fo_gym.evaluation.episode.recording import References
from fo_gym.evaluation.metrics import score
from fo_gym.robots import Robot
from fo_gym.tasks.task import Task

LEVER = 0.1
"""Of a slide [m/rad], see `Robot.levers`."""

# A slide that carries a hinge, and the same with a hinge on a long arm in its place, so that 1 rad of it is 0.1 m.
MIXED = """<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="first" type="slide" axis="1 0 0"/>
  <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body>
  <body pos="0 1 0"><joint name="second" type="hinge" axis="0 0 1"/>
  <inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body></worldbody></mujoco>"""
TURNING = MIXED.replace('type="slide" axis="1 0 0"', 'type="hinge" axis="0 0 1"').replace("1 1 1", "0.02 0.02 0.02")


def made(path: Path, mjcf: str, lever: float) -> Robot:
    """The robot with a first joint whose numbers are those of a hinge for `lever` 1, of a slide otherwise."""
    path.write_text(mjcf, encoding="utf-8")
    first = np.array([lever, 1.0])
    inertia, f_c = np.array([0.02, 0.1]) / first**2, np.array([0.3, 0.5]) / first
    flexible = fo_gym.FlexibleJoint(np.array([400.0, 900.0]) / first**2, 0.0, inertia, np.array([9.0, 9.0]) / first)
    friction = fo_gym.LuGre(
        np.array([900.0, 3000.0]) / first**2,
        np.array([4.0, 15.0]) / first**2,
        0.05 / first**2,
        f_c,
        1.5 * f_c,
        0.01 * first,
    )
    home = np.zeros(2)
    return Robot.from_file(path, flexible=flexible, friction=friction, home=home)


def hold(robot: Robot) -> Task:
    """A step of 0.1 rad on both joints, and what that is where one slides."""
    gains = fo_gym.PDGains(kp=np.array([4.0, 9.0]) / robot.levers**2, kd=np.array([0.3, 0.6]) / robot.levers**2)
    return Task(fo_gym.Step(size=0.1 * robot.levers, time=0.1), duration=1.5, gains=gains)


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> tuple[Robot, Robot]:
    folder = tmp_path_factory.mktemp("robots")
    return made(folder / "mixed.xml", MIXED, LEVER), made(folder / "turning.xml", TURNING, 1.0)


def test_a_slide_is_told_as_the_hinge_that_it_is_like(robots: tuple[Robot, Robot]) -> None:
    """Every metric of the mixed robot is that of one with hinges alone whose first joint moves 0.1 m per radian."""
    mixed, turning = robots
    assert mixed.units == ("m", "rad")
    assert (mixed.joint_unit, turning.joint_unit) == ("rad", "rad")
    np.testing.assert_array_equal(mixed.levers, [LEVER, 1.0])
    compensator = fo_gym.make_compensator("pd-low")
    scores = []
    for robot in robots:
        arguments = {"robot": robot, "task": hold}
        runs = [
            record(each, "it", "FJRRegulation-v0", "nominal", [0], arguments)
            for each in (compensator, NoCompensation(), fo_gym.make_compensator("ideal"))
        ]
        references = References(runs[2].motions, runs[1].motions)
        scores.append(score(replace(runs[0], task=hold(robot)).episode(0, references)))
    assert scores[0].keys() == scores[1].keys()
    for name, value in scores[0].items():
        assert value == pytest.approx(scores[1][name], rel=1e-6, abs=1e-9, nan_ok=True), name
    assert 0.1 < scores[0]["frr"] < 1.0
    assert scores[0]["steady_state_error_ju"] > 1e-4
