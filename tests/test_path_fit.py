"""Squares fitted to arms of any kind: on the path, away from singular poses and limits; and why there is none."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from arms import SIX, arm, compiled, miro, standing

from fo_gym.robots.home import found_home, redundant_joints
from fo_gym.robots.poses import Poses, scaled, tool_rows
from fo_gym.tasks.kinematics import path_table
from fo_gym.tasks.squares import LARGEST_SIDE, SINGULAR, fitted_square
from fo_gym.tasks.tool_path import ToolPath

Z, Y, X = "0 0 1", "0 1 0", "1 0 0"
DT = 0.02


def test_the_shipped_square_is_the_fitted_one() -> None:
    robot = miro()
    home = compiled(robot).key("home").qpos.copy()
    assert fitted_square(standing(robot, home, ("joint3",))) == (0.15, (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))


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
        model = compiled(robot)
        home = found_home(model, "tool")
        held = redundant_joints(model, home, "tool")
        rows = tool_rows(model.nq)
        assert len(held) == model.nq - rows, name
        path = ToolPath(duration=5.0).fitted_to(standing(robot, home, held))
        assert 0.2 * LARGEST_SIDE * (0.2 if name == "small" else 1.0) <= path.side <= LARGEST_SIDE, name
        table = path_table(robot, path, home, DT, held)
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
        fitted_square(standing(two, np.zeros(2), ()))
    planar = arm(tmp_path / "planar.xml", (Y, Y, Y))
    with pytest.raises(ValueError, match="that pose is singular, with a smallest singular value of"):
        fitted_square(standing(planar, np.array([0.5, 0.8, -0.6]), ()))
    stretched = arm(tmp_path / "6.xml")
    with pytest.raises(ValueError, match="pose is singular"):
        fitted_square(standing(stretched, np.zeros(6), ()))
    home = compiled(miro()).key("home").qpos.copy()
    with pytest.raises(ValueError, match=r"no square of 0\.9 m.*0 of what is asked for"):
        fitted_square(standing(miro(), home, ("joint3",)), side=0.9)
    with pytest.raises(ValueError, match=r"redundant joints are \('joint3', 'joint3'\)"):
        fitted_square(standing(miro(), home, ("joint3", "joint3")))
    cornered = home.copy()
    cornered[6] = 2.85
    with pytest.raises(ValueError, match="limit of every joint"):
        fitted_square(standing(miro(), cornered, ("joint3",)))


def test_a_given_side_is_kept() -> None:
    home = compiled(miro()).key("home").qpos.copy()
    assert fitted_square(standing(miro(), home, ("joint3",)), side=0.1)[0] == 0.1
