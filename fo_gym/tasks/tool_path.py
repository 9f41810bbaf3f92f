"""A path of the tool: a square, under task-space impedance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.binding import Bound, bound
from fo_gym.checks import POSITIVE, number, real_array, shown
from fo_gym.compiling import jit
from fo_gym.control.design import designed_impedance
from fo_gym.control.impedance import Impedance, impedance_torques
from fo_gym.parameters import ImpedanceGains
from fo_gym.plant import FlexibleJointPlant
from fo_gym.plant.screws import tool_distances
from fo_gym.robots import LinkSide, Robot
from fo_gym.robots.poses import tool_rows
from fo_gym.tasks.control import CompiledControl, PathStatics, path_statics
from fo_gym.tasks.kinematics import PathTable, TimedPath, path_table
from fo_gym.tasks.scenario import Scenario
from fo_gym.tasks.square_fit import Direction, fitted_square

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

__all__ = ["ToolPath", "ToolPathControl"]


@dataclass(frozen=True)
class ToolPath:
    """A square in the plane of two directions, its four sides run through in turn, back to the start.

    Each side follows s(x) = 10 x^3 - 15 x^4 + 6 x^5: smooth up to acceleration, at rest in the corners.

    Attributes:
        duration: time for all four sides [s].
        side: length of a side [m]; None for one that suits the robot.
        first: unit vector of the first side, in the world; None for a plane that suits the robot.
        second: unit vector of the second side, at a right angle to the first; None where `first` is.
    """

    duration: float
    side: float | None = None
    first: Direction | None = None
    second: Direction | None = None

    of_tool = True
    step_time = None

    def __post_init__(self) -> None:
        number("ToolPath.duration", self.duration, POSITIVE, "s")
        if self.side is not None:
            number("ToolPath.side", self.side, POSITIVE, "m")
        if (self.first is None) != (self.second is None):
            raise ValueError(
                f"ToolPath.first is {shown(self.first)} and ToolPath.second is {shown(self.second)}; give both, or none"
            )
        if self.first is not None:
            both = ("first", "second")
            plane = np.array([real_array(f"ToolPath.{name}", getattr(self, name), (3,)) for name in both])
            if not np.allclose(plane @ plane.T, np.eye(2), rtol=0.0, atol=1e-9):
                raise ValueError(
                    f"ToolPath.first is {self.first} and ToolPath.second is {self.second}; give two unit vectors at a "
                    "right angle"
                )

    @property
    def motion_window(self) -> tuple[float, float]:
        """(start, end) [s] in which it moves."""
        return 0.0, self.duration

    def fitted_to(self, robot: Robot) -> ToolPath:
        """The same with side and plane chosen for a robot. Raises ValueError, saying why, where there is no square."""
        if self.side is not None and self.first is not None:
            return self
        plane = None if self.first is None or self.second is None else (self.first, self.second)
        side, (first, second) = fitted_square(robot, self.side, plane)
        return replace(self, side=side, first=first, second=second)

    def target(self, home: Array, share: Array | float = 1.0) -> None:
        """None: the path says where the links go."""

    def designed_gains(self, robot: Robot) -> ImpedanceGains:
        """The robot's own impedance gains, or designed ones."""
        return robot.impedance_gains or designed_impedance(robot)

    def control(self, robot: Robot, plant: FlexibleJointPlant, gains: Any) -> ToolPathControl:
        """Impedance along the path."""
        return ToolPathControl(self, robot, plant, gains)

    def at(self, time: Array) -> tuple[Array, Array]:
        """Offset from the start [m] and velocity [m/s] at `time` (n,) [s], (n, 3) each; at rest after the end."""
        if self.side is None or self.first is None or self.second is None:
            raise ValueError("ToolPath has no side or plane yet; give them, or use fitted_to(robot)")
        side_time = self.duration / 4.0
        progress = np.clip(np.asarray(time, dtype=np.float64) / side_time, 0.0, 4.0)
        index = np.minimum(progress.astype(int), 3)
        x = progress - index
        directions = np.array([self.first, self.second, np.negative(self.first), np.negative(self.second)]) * self.side
        corners = np.vstack([np.zeros(3), np.cumsum(directions, axis=0)])
        along = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
        speed = 30.0 * x**2 * (1.0 - x) ** 2 / side_time
        return corners[index] + along[:, None] * directions[index], speed[:, None] * directions[index]


@lru_cache(maxsize=8)
def _cached_table(
    link_side: LinkSide,
    _stamp: tuple[int, int],
    path: TimedPath,
    home: tuple[float, ...],
    dt: float,
    redundant: tuple[str, ...],
) -> PathTable:
    return path_table(link_side, path, np.array(home), dt, redundant)


class ToolPathControl(CompiledControl):
    """Impedance along a tool path, which can be hashed: its table is kept."""

    def __init__(self, path: TimedPath, robot: Robot, plant: FlexibleJointPlant, gains: ImpedanceGains) -> None:
        super().__init__(plant, references=3)
        home = tuple(robot.home.tolist())
        links = robot.link_side
        self.table = _cached_table(links, links.stamp, path, home, plant.control_dt, robot.redundant)
        held = [robot.joints.index(name) for name in robot.redundant]
        self._law = Impedance(gains, plant.body.links, held, oriented=tool_rows(robot.dof) == 6)
        self._statics = PathStatics(plant, self.table.q_d)
        self._velocity = np.empty_like(self.reference)
        self.path = self.table.position
        self.bind()

    def _bound_follow(self, *given: Any) -> list[Bound]:
        table = self.table.position, self.table.velocity, self.table.rotation, self.table.held
        parts = self._law.compiled, self._statics.compiled, table, self.theta_d, self.reference, self._velocity
        return [bound(_follow, *parts, *given, *share) for share in self._plant.threads.shares]

    def _bound_distance(self, scale: Any, distance: Array) -> list[Bound]:
        plant, links = self._plant, self._plant.body.links
        parts = (links.joints, links.world, links.reference), plant.q, self.reference, scale, distance
        return [bound(_distance, *parts, *share) for share in plant.threads.shares]

    def reset(self, ids: Ids, scenarios: Sequence[Scenario]) -> None:
        """See TaskControl."""
        self._statics.reset(ids, scenarios)

    def desired_links(self, i: int) -> None:
        """See TaskControl."""


@jit
def _follow(law, statics, table, theta_d, reference, velocity, ticks, theta, theta_dot, tau_c, first, last):
    path_statics(statics, ticks, theta_d, first, last)
    position_d, velocity_d, rotation_d, held = table
    mass, stiffness, row, _ = statics[3:]
    for i in range(first, last):
        for axis in range(3):
            reference[i, axis], velocity[i, axis] = position_d[row[i], axis], velocity_d[row[i], axis]
    setpoint = reference, velocity, rotation_d, held
    impedance_torques(law, stiffness, mass, theta, theta_dot, setpoint, tau_c, first, last)


@jit
def _distance(links, q, point, scale, distance, first, last):
    tool_distances(*links, q[first:last], point[first:last], distance[first:last])
    for i in range(first, last):
        distance[i] /= scale
