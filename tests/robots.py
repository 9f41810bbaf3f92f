"""The compiled robots and the tables of their README, for the tests of both."""

import re

import mujoco
import numpy as np

from envs_assets import asset_path

ROBOTS = ("miro_like", "single_link")
README = asset_path("miro_like").with_name("README.md")
X, Y, Z = np.eye(3)


class Robot:
    """A compiled model with the few quantities that the tests ask for."""

    def __init__(self, name: str) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(asset_path(name)))
        self.data = mujoco.MjData(self.model)
        self.home = self.model.key("home").qpos.copy()

    def at(self, q: np.ndarray) -> mujoco.MjData:
        self.data.qpos[:] = q
        self.data.qvel[:] = 0
        mujoco.mj_forward(self.model, self.data)
        return self.data

    def inertia(self, q: np.ndarray) -> np.ndarray:
        dense = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.at(q), dense)
        return dense

    def gravity(self, q: np.ndarray) -> np.ndarray:
        return self.at(q).qfrc_bias.copy()

    def gravity_stiffness(self, q: np.ndarray, step: float = 1e-5) -> np.ndarray:
        shifts = step * np.eye(self.model.nv)
        return np.array([self.gravity(q + s) - self.gravity(q - s) for s in shifts]).T / (2 * step)

    def tool(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position (3,), rotation (3, 3) and Jacobian (6, 7) of the tool."""
        site = self.at(q).site("tool")
        jacobian = np.zeros((6, 7))
        mujoco.mj_jacSite(self.model, self.data, jacobian[:3], jacobian[3:], site.id)
        return site.xpos.copy(), site.xmat.reshape(3, 3).copy(), jacobian

    def random_poses(self, count: int, seed: int) -> np.ndarray:
        low, high = self.model.jnt_range.T
        return np.random.default_rng(seed).uniform(low, high, (count, self.model.nq))


def section(robot: str) -> str:
    """The part of the README that is about one robot."""
    return README.read_text(encoding="utf-8").split(f"\n## {robot}\n")[1].split("\n## ")[0]


def rows(robot: str, first_column: str) -> dict[str, list[str]]:
    """Cells of a README table by the name in the first column; the table is found by that column's title."""
    table = re.search(rf"^\| {first_column} \|.*\n\|[-|]+\n((?:\|.*\n)+)", section(robot), re.MULTILINE)
    assert table, f"README has no table of {first_column}s for {robot}"
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in table[1].splitlines()]
    return {line[0].split("`")[1]: line[1:] for line in lines}


def numbers(cell: str) -> list[float]:
    return [float(n) for n in re.findall(r"-?\d+(?:\.\d+)?", cell)]
