"""Squares fitted to arms of any kind: on the path, away from singular poses and limits; and why there is none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from arms import SIX, arm, miro

from fo_gym.friction import FRICTIONLESS
from fo_gym.plant.links import Links
from fo_gym.robots.poses import Poses, scaled, tool_rows
from fo_gym.tasks.kinematics import path_table
from fo_gym.tasks.square_fit import GRAVITY_CHANGE, LARGEST_SIDE, SINGULAR, fitted_square
from fo_gym.tasks.tool_path import ToolPath

Z, Y, X = "0 0 1", "0 1 0", "1 0 0"
DT = 0.02


def test_the_shipped_square_is_the_fitted_one() -> None:
    assert fitted_square(miro()) == (0.15, ((0.0, -1.0, 0.0), (0.0, 0.0, -1.0)))
    fitted = ToolPath(5.0).fitted_to(miro())
    assert fitted == ToolPath(5.0, 0.15, (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))


def test_squares_of_all_kinds_of_arms_keep_their_distance(tmp_path: Path) -> None:
    """Against MuJoCo alone: position, orientation where there are 6 joints, held joints, conditioning, limits."""
    arms = {
        "three": arm(tmp_path / "3.xml", (Z, Y, Y)),
        "four": arm(tmp_path / "4.xml", (Z, Y, Y, Y)),
        "five": arm(tmp_path / "5.xml", SIX[:5]),
        "gantry": arm(tmp_path / "g.xml", (X, Y, Z), slides=(0, 1, 2)),
        "six": arm(tmp_path / "6.xml"),
        "small": arm(tmp_path / "s.xml", scale=0.2),
        "eight": arm(tmp_path / "8.xml", (*SIX, Z, Y)),
        "rail": arm(tmp_path / "r.xml", (Y, *SIX), slides=(0,)),
        "endless": arm(tmp_path / "e.xml", limited=False),
    }
    for name, robot in arms.items():
        model, home, held, rows = robot.link_side.model, robot.home, robot.redundant, tool_rows(robot.dof)
        assert len(held) == robot.dof - rows, name
        path = ToolPath(5.0).fitted_to(robot)
        assert path.side is not None
        assert 0.2 * LARGEST_SIDE * (0.2 if name == "small" else 1.0) <= path.side <= LARGEST_SIDE, name
        table = path_table(robot.link_side, path, home, DT, held)
        check = _Check(model, rows, [robot.joints.index(joint) for joint in held])
        for position, q in zip(table.position[::12], table.q_d[::12], strict=True):
            check.at(name, home, position, q)
        assert check.smallest > 0.99 * SINGULAR, (name, check.smallest)


class _Check:
    """One pose after the other against MuJoCo."""

    def __init__(self, model: mujoco.MjModel, rows: int, held: list[int]) -> None:
        self.model, self.rows, self.held = model, rows, held
        self.data = mujoco.MjData(model)
        self.poses, self.smallest = Poses(model, "tool"), np.inf
        self.reach = self.poses.reach()

    def _tool(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        self.data.qpos[:] = q
        mujoco.mj_kinematics(self.model, self.data)
        tool = self.data.site("tool")
        return tool.xpos.copy(), tool.xmat.reshape(3, 3).copy()

    def at(self, name: str, home: np.ndarray, position: np.ndarray, q: np.ndarray) -> None:
        found, rotation = self._tool(q)
        assert np.abs(found - position).max() < 1e-9, name
        if self.rows == 6:
            assert np.abs(rotation - self._tool(home)[1]).max() < 1e-8, name
        assert np.abs(q - home)[self.held].max(initial=0.0) < 1e-9, name
        limited = self.model.jnt_limited.astype(bool)
        low, high = self.model.jnt_range[limited].T
        assert np.all(np.minimum(q[limited] - low, high - q[limited]) >= 0.099 * np.minimum(high - low, 4.0)), name
        jacobian = scaled(self.poses.jacobian(q)[: self.rows], self.poses.units, self.reach)
        stacked = np.concatenate([jacobian, np.eye(self.model.nq)[self.held]])
        self.smallest = min(self.smallest, np.linalg.svd(stacked, compute_uv=False)[-1])


def test_arms_without_a_square_say_why(tmp_path: Path) -> None:
    two = arm(tmp_path / "2.xml", (Z, Y))
    with pytest.raises(ValueError, match="at least 3 joints; this one has 2"):
        fitted_square(two)
    planar = replace(arm(tmp_path / "planar.xml", (Y, Y, Y)), home=np.array([0.5, 0.8, -0.6]))
    with pytest.raises(ValueError, match=r"move it in 2 of the 3 directions.*singular value is"):
        fitted_square(planar)
    with pytest.raises(ValueError, match=r"in [45] of the 6 directions"):
        fitted_square(replace(arm(tmp_path / "6.xml"), home=np.zeros(6)))
    with pytest.raises(ValueError, match=r"no square of 0\.9 m.*0 of what is asked for"):
        fitted_square(miro(), side=0.9)
    with pytest.raises(ValueError, match=r"redundant joints are \(\); .* needs 1 of \('joint1'"):
        fitted_square(replace(miro(), redundant=()))
    cornered = miro().home.copy()
    cornered[6] = 2.85
    with pytest.raises(ValueError, match="limit of every joint"):
        fitted_square(replace(miro(), home=cornered))


def test_the_square_is_the_same_without_friction_and_level_where_it_can_be(tmp_path: Path) -> None:
    """The reference without friction is run on the same square; gravity changes little in it, or least of all sizes."""
    for robot in (miro(), arm(tmp_path / "6.xml"), arm(tmp_path / "3.xml", (Z, Y, Y))):
        side, plane = fitted_square(robot)
        assert fitted_square(replace(robot, friction=FRICTIONLESS)) == (side, plane)
        path = ToolPath(5.0, side, *plane)
        table = path_table(robot.link_side, path, robot.home, DT, robot.redundant)
        gravity = Links(robot.link_side).gravity(table.q_d)
        change = np.abs(gravity - gravity[0]).max(axis=0) / robot.flexible.torque_limit
        assert change.max() < 1.02 * GRAVITY_CHANGE or side < LARGEST_SIDE


def test_what_is_given_is_kept() -> None:
    assert fitted_square(miro(), side=0.1)[0] == 0.1
    plane = ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    assert fitted_square(miro(), plane=plane)[1] == plane
