"""Robot files: what is read, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pendulum import FRICTION, JOINTS, MakeRobot

from fo_gym.plant import FlexibleJointPlant, Robot
from fo_gym.plant.robot import load_model


@pytest.mark.parametrize(
    ("parts", "complaint"),
    [
        ({"elbow_type": "ball", "elbow": ""}, "hinge or a slide"),
        ({"rest": '<actuator><motor joint="elbow"/></actuator>'}, "actuators"),
        ({"rest": '<equality><joint joint1="shoulder" joint2="elbow"/></equality>'}, "equalities"),
        ({"rest": '<tendon><fixed><joint joint="elbow" coef="1"/></fixed></tendon>'}, "tendons"),
        ({"shoulder": 'frictionloss="0.1"'}, "frictionloss"),
    ],
)
def test_files_with_more_than_links_are_refused(pendulum: MakeRobot, parts: dict[str, str], complaint: str) -> None:
    robot = pendulum(**parts)
    with pytest.raises(ValueError, match=complaint) as refusal:
        load_model(robot)
    assert str(robot.path) in str(refusal.value)


@pytest.mark.parametrize("joints", [("shoulder",), ("elbow", "shoulder"), ("shoulder", "wrist"), ()])
def test_other_joints_than_the_files_are_refused(pendulum: MakeRobot, joints: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match=r"\('shoulder', 'elbow'\)"):
        load_model(replace(pendulum(), joints=joints))


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"nowhere\.xml"):
        load_model(Robot(tmp_path / "nowhere.xml", ("joint",)))


def test_missing_tool_is_named(pendulum: MakeRobot) -> None:
    with pytest.raises(KeyError, match=r"grip.*tip"):
        load_model(replace(pendulum(), tool="grip"))


def test_urdf_is_a_robot_too(tmp_path: Path) -> None:
    """One hinge with 2 kg at 0.5 m: the plant's gravity and inertia are those of the pencil."""
    path = tmp_path / "pendulum.urdf"
    path.write_text(
        """<robot name="pendulum">
          <link name="base"/>
          <link name="rod"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
            <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
          <joint name="pivot" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint>
        </robot>"""
    )
    plant = FlexibleJointPlant(Robot(path, ("pivot",)), 1, joints=JOINTS, friction=FRICTION)
    assert plant.body.dense_inertia(np.zeros((1, 1))).item() == pytest.approx(0.1 + 2 * 0.25)
    assert abs(plant.body.gravity(np.zeros((1, 1))).item()) == pytest.approx(2 * 9.81 * 0.5)
