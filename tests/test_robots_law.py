"""Robots whose friction is of another law than LuGre: in files, and from a program."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fo_gym import Dahl, ElastoPlastic, MaxwellSlip, Robot
from fo_gym.evaluation.runs.contest import law_of_robot, under_law
from fo_gym.friction import LAWS
from fo_gym.robots import robot_of

OWN = Path(__file__).parent / "outside" / "own_laws.py"


@pytest.mark.parametrize("law", [*LAWS, f"{OWN}:SmoothCoulomb"])
def test_a_robot_is_read_as_it_was_written(law: str, tmp_path: Path) -> None:
    robot: Any = under_law("miro_like", law)
    robot.to_toml(tmp_path / "robot.toml")
    again: Any = Robot.from_toml(tmp_path / "robot.toml")
    assert type(again.friction) is type(robot.friction)
    for name, value in vars(robot.friction).items():
        np.testing.assert_array_equal(getattr(again.friction, name), value)
    assert again.fingerprint == robot.fingerprint
    assert again.identified is not None


def test_a_law_without_numbers_is_made_like_the_robots_own(tmp_path: Path) -> None:
    robot_of("single_link").to_toml(tmp_path / "plain.toml")
    text = (tmp_path / "plain.toml").read_text()
    start = text.index("[friction.sigma_0]")
    end = text.index("[identified") if "[identified" in text else text.index("[hardware")
    (tmp_path / "named.toml").write_text(text[:start] + '[friction]\nlaw = "MaxwellSlip"\n\n' + text[end:])
    robot = Robot.from_toml(tmp_path / "named.toml")
    assert isinstance(robot.friction, MaxwellSlip)
    assert len(robot.friction.alpha) == 4
    assert np.all(robot.friction.sigma_0 > 0.0)


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ('law = "Coulomb"', "law is 'Coulomb'; known are LuGre, ElastoPlastic, MaxwellSlip, Dahl"),
        ('law = "Dahl"\nf_c = {value = 1.0}', "friction: .* allowed are"),
        ('law = "Dahl"\nsigma_0 = {value = 1e5}\nf_c = {value = 0.0}', r"Dahl\.f_c is 0"),
        ('law = "Dahl"\nf_s = {value = 1.0}', "friction: there is .*f_s"),
    ],
)
def test_what_is_no_law_is_refused(table: str, told: str, tmp_path: Path) -> None:
    robot_of("single_link").to_toml(tmp_path / "robot.toml")
    text = (tmp_path / "robot.toml").read_text()
    start, end = text.index("[friction.sigma_0]"), text.index("[hardware")
    (tmp_path / "robot.toml").write_text(text[:start] + f"[friction]\n{table}\n\n" + text[end:])
    with pytest.raises(ValueError, match=told):
        Robot.from_toml(tmp_path / "robot.toml")


def test_a_program_gives_a_robot_any_law() -> None:
    own = robot_of("miro_like")
    law = ElastoPlastic(1e5, 300.0, 1.0, 5.0, 8.0, 2e-3)
    robot = Robot.from_file(own.link_side.file, friction=law)
    assert isinstance(robot.friction, ElastoPlastic)
    np.testing.assert_array_equal(robot.friction.f_s, np.full(robot.dof, 8.0))
    assert robot.advice().lines


def test_tables_tell_the_law_by_the_robots_name() -> None:
    assert under_law("single_link", "LuGre") is robot_of("single_link")
    robot = under_law("single_link", "Dahl")
    assert isinstance(robot.friction, Dahl)
    assert law_of_robot(robot.name) == ("single_link", "Dahl")
    assert law_of_robot("single_link") == ("single_link", "LuGre")
    with pytest.raises(ValueError, match="has friction Dahl; laws are made like a LuGre"):
        under_law(robot, "MaxwellSlip")


def test_the_name_of_a_robot_is_told_from_that_of_its_law() -> None:
    plain, dahl = robot_of("single_link"), under_law("single_link", "Dahl")
    names = [under_law(replace(dahl, name="arm"), "Dahl").name]
    names += [under_law(replace(plain, name="arm with gripper"), law).name for law in ("LuGre", "Dahl")]
    names += [under_law(replace(plain, name="arm with Dahl"), law).name for law in ("LuGre", "Dahl")]
    assert [law_of_robot(name) for name in names] == [
        ("arm", "Dahl"),
        ("arm with gripper", "LuGre"),
        ("arm with gripper", "Dahl"),
        ("arm with Dahl", "LuGre"),
        ("arm with Dahl", "Dahl"),
    ]
    assert law_of_robot("arm with Mine", ["Mine"]) == ("arm", "Mine")
