"""robot.toml: what is written comes back, to the last bit; what is missing is designed, what is wrong is named."""

from __future__ import annotations

import dataclasses
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from robot_files import CRANE, PUSHER, URDF, ur5e

import fo_gym.robots
from envs_assets import asset_path
from fo_gym.robots import Robot, robot_of, shipped_robots


def differences(first: Any, second: Any, path: str = "") -> list[str]:
    """Dotted paths of what differs in two dataclasses, arrays to the bit; reports and sources apart."""
    if dataclasses.is_dataclass(first) and type(first) is type(second):
        names = [field.name for field in dataclasses.fields(first) if field.name not in ("report", "sources")]
        return [d for name in names for d in differences(getattr(first, name), getattr(second, name), f"{path}.{name}")]
    if isinstance(first, np.ndarray):
        return [] if first.dtype == second.dtype and first.tobytes() == second.tobytes() else [path]
    return [] if type(first) is type(second) and first == second else [f"{path}: {first} and {second}"]


def some_robots(folder: Path) -> list[Robot]:
    (folder / "crane.xml").write_text(CRANE)
    (folder / "two.urdf").write_text(URDF)
    return [
        robot_of("miro_like"),
        robot_of("single_link"),
        Robot.from_file(folder / "crane.xml"),
        Robot.from_file(folder / "crane.xml", joints=("rail", "bend"), home="parked"),
        Robot.from_file(folder / "two.urdf"),
        Robot.from_file(PUSHER),
        Robot.from_file(ur5e()),
    ]


def test_a_robot_comes_back_as_it_was_written(tmp_path: Path) -> None:
    for robot in some_robots(tmp_path):
        path = tmp_path / "written.toml"
        robot.to_toml(path)
        back = Robot.from_toml(path)
        assert differences(robot, back) == []
        assert dict(robot.sources) == dict(back.sources)
        first = path.read_bytes()
        back.to_toml(path)
        assert path.read_bytes() == first


def test_a_robot_can_be_pickled(tmp_path: Path) -> None:
    for robot in some_robots(tmp_path):
        back = pickle.loads(pickle.dumps(robot))
        assert differences(robot, back) == []
        assert back.report == robot.report
        assert back.link_side.model.nq == robot.dof


def test_a_file_is_named_from_its_toml(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, elsewhere = tmp_path / "robots", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    (folder / "crane.xml").write_text(CRANE)
    Robot.from_file(folder / "crane.xml").to_toml(folder / "crane.toml")
    assert 'file = "crane.xml"' in (folder / "crane.toml").read_text()
    folder.rename(tmp_path / "moved")
    monkeypatch.chdir(elsewhere)
    assert Robot.from_toml("../moved/crane.toml").dof == 5


def test_the_shipped_robots_are_what_the_paper_and_its_arm_are() -> None:
    """The numbers that all published rows were computed with, as arithmetic gives them."""
    arm, link = robot_of("miro_like"), robot_of("single_link")
    f_c = np.array([5.35] * 4 + [4.0125] * 3)
    expected = {
        "sigma_0": f_c / 1e-4,
        "sigma_1": np.sqrt(f_c / 1e-4 * np.array([1.2] * 4 + [0.6] * 3)),
        "sigma_2": np.full(7, 3.16),
        "f_c": f_c,
        "f_s": 2.15 * f_c,
        "v_s": np.full(7, 0.002),
    }
    for friction in (arm.friction, arm.identified):
        for name, value in expected.items():
            np.testing.assert_allclose(getattr(friction, name), value, rtol=1e-15, err_msg=name)
    np.testing.assert_array_equal(arm.flexible.stiffness, [6e3, 6e3, 5e3, 5e3, 3e3, 3e3, 3e3])
    np.testing.assert_array_equal(arm.flexible.motor_inertia, [1.2] * 4 + [0.6] * 3)
    np.testing.assert_array_equal(arm.home, [0.24, 0.57, -0.32, 2.32, 0.12, -1.24, 0.02])
    assert arm.link_side.file == asset_path("miro_like")
    assert (arm.tool, arm.redundant, link.tool) == ("tool", ("joint3",), None)
    assert arm.hardware is not None
    assert link.hardware is not None
    assert arm.hardware.sensors.encoder.cutoff == 2.0 * math.pi * 150.0  # type: ignore[union-attr]
    assert arm.hardware.ripple.period == 2.0 * math.pi / 200.0  # type: ignore[union-attr]
    assert arm.hardware.temperature.start == (0.0, 30.0)  # type: ignore[union-attr]
    np.testing.assert_array_equal(link.friction.sigma_1, [np.sqrt(1e5)])
    assert link.units == ("m",)


def test_every_number_that_is_shipped_says_where_it_is_from() -> None:
    for name in ("miro_like", "single_link"):
        robot = robot_of(name)
        content = (Path(fo_gym.robots.__file__).parent / f"data/{name}.toml").read_text()
        assert content.count("value =") == content.count("source =") == content.count("unit =")
        assert not robot.report.assumed


def test_what_is_missing_is_designed(tmp_path: Path) -> None:
    (tmp_path / "two.urdf").write_text(URDF)
    path = tmp_path / "some.toml"
    path.write_text(
        'file = "two.urdf"\ntool = "flange"\n[flexible.motor_inertia]\nvalue = [0.2, 0.1]\nunit = "kg m^2"\n'
        'source = "data sheet"\n[friction.f_c]\nvalue = 0.7\n'
    )
    robot = Robot.from_toml(path)
    np.testing.assert_array_equal(robot.flexible.motor_inertia, [0.2, 0.1])
    np.testing.assert_array_equal(robot.friction.f_c, [0.7, 0.7])
    np.testing.assert_array_equal(robot.friction.f_s, 1.5 * robot.friction.f_c)
    assert robot.flexible.torque_limit[0] == 40.0
    assert {line.what for line in robot.report.assumed} >= {"K_j [N m/rad | N/m]", "sigma_0 [N m/rad | N/m]"}
    assert any("data sheet" in line.text for line in robot.report.taken)


WRONG = [
    ("", "there is no file ="),
    ("file = 3", "file is 3"),
    ('file = "nowhere.xml"', "does not exist"),
    ('file = "two.urdf"\ncolour = "red"', r"\['colour'\]; it has name, file"),
    ('file = "two.urdf"\njoints = ["knee"]', r"\['knee'\] are not there"),
    ('file = "two.urdf"\nunits = ["inch"]', "units is"),
    ('file = "two.urdf"\nfrozen = 3', "frozen is 3"),
    ('file = "two.urdf"\n[frozen]\nknee = 1.0', "knee"),
    ('file = "two.urdf"\nflexible = 3', "flexible is 3"),
    ('file = "two.urdf"\n[flexible]\nstiffnes = 3', "stiffnes"),
    ('file = "two.urdf"\n[flexible]\nstiffness = 3', "give a table of value, unit and source"),
    ('file = "two.urdf"\n[flexible.stiffness]\nvalue = "much"', "flexible.stiffness is 'much'"),
    ('file = "two.urdf"\n[flexible.stiffness]\nvalue = [1.0, true]', "flexible.stiffness is"),
    ('file = "two.urdf"\n[flexible.stiffness]\nvalue = [1.0, 2.0, 3.0]', r"stiffness is .*shape \(3,\)"),
    ('file = "two.urdf"\n[flexible.stiffness]\nvalue = -1.0', "stiffness"),
    ('file = "two.urdf"\n[flexible.stiffness]\nvalue = 1.0\nunit = "lb in"', "in 'lb in'; give it in 'N m/rad'"),
    ('file = "two.urdf"\n[flexible.stiffness]\nvalue = 1.0\nsource = 3', "source is 3"),
    ('file = "two.urdf"\n[hardware.sensors.camera]\nvalue = 1.0', "hardware.sensors: there is"),
    ('file = "two.urdf"\n[hardware.delay]\n', "hardware.delay"),
    ('file = "two.urdf"\n[pd_gains.kp]\nvalue = [1.0, 2.0]', "pd_gains"),
    ('file = "two.urdf"\nhome = [0.0]', "home is"),
    ("file = ", "TOML"),
    ('package = "no-such-package-here"\nfile = "x.xml"', "pip install no-such-package-here"),
    ('package = "gymnasium"\nfile = "x.xml"', "package gymnasium .* has no file x.xml"),
]


def test_what_is_wrong_is_named(tmp_path: Path) -> None:
    (tmp_path / "two.urdf").write_text(URDF)
    path, offenders = tmp_path / "wrong.toml", []
    for content, words in WRONG:
        path.write_text(content)
        try:
            with pytest.raises((ValueError, FileNotFoundError), match=words):
                Robot.from_toml(path)
        except (Exception, pytest.fail.Exception) as failure:
            offenders.append(f"{content!r}: {failure!r}")
    assert offenders == []


def test_robots_go_by_many_names(tmp_path: Path) -> None:
    (tmp_path / "crane.xml").write_text(CRANE)
    (tmp_path / "two.urdf").write_text(URDF)
    robot = robot_of(tmp_path / "crane.xml")
    robot.to_toml(tmp_path / "crane.toml")
    assert robot_of(robot) is robot
    assert differences(robot, robot_of(str(tmp_path / "crane.toml"))) == []
    assert robot_of(tmp_path / "two.urdf").dof == 2
    assert {"miro_like", "single_link", "ur5e", "panda", "gen3"} <= set(shipped_robots())
    for nothing in ("r2d2", 3, None, "robot.step", tmp_path):
        with pytest.raises(ValueError, match=r"give a Robot, one of .*miro_like.*\*\.urdf"):
            robot_of(nothing)  # type: ignore[arg-type]
