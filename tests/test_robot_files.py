"""Robot files: what is read, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pendulum import FRICTION, JOINTS, MakeRobot

from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import LinkSide


@pytest.mark.parametrize("joints", [("elbow", "shoulder"), ("shoulder", "wrist"), ()])
def test_other_joints_than_the_files_are_refused(pendulum: MakeRobot, joints: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match=r"\('shoulder', 'elbow'\)"):
        assert replace(pendulum(), joints=joints).model


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"nowhere\.xml"):
        assert LinkSide(tmp_path / "nowhere.xml", ("joint",)).model


def test_missing_tool_is_named(pendulum: MakeRobot) -> None:
    with pytest.raises(ValueError, match=r"grip.*tip"):
        assert replace(pendulum(), tool="grip").model


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
    plant = FlexibleJointPlant(LinkSide(path, ("pivot",)), 1, joints=JOINTS, friction=FRICTION)
    assert plant.body.dense_inertia(np.zeros((1, 1))).item() == pytest.approx(0.1 + 2 * 0.25)
    assert abs(plant.body.gravity(np.zeros((1, 1))).item()) == pytest.approx(2 * 9.81 * 0.5)
