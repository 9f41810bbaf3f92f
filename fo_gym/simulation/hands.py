"""The hands of a batch: one at each tool, or none."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import real_array
from fo_gym.plant import FlexibleJointPlant
from fo_gym.simulation.kernels import pull
from fo_gym.tasks.hand import Hand

Array = NDArray[np.float64]

_NUMBERS = ("stroke", "speed", "turn", "strokes", "stiffness", "damping", "release")

__all__ = ["HandState", "Hands"]


@dataclass(frozen=True)
class HandState:
    """What hands remember.

    Attributes:
        gripped_at: where each gripped the tool, (num_envs, 3), m; zeros before.
        force: on the tool, mean over the past step, (num_envs, 3), N.
    """

    gripped_at: Array
    force: Array

    def check(self, num_envs: int) -> None:
        """Raise ValueError where a field has another shape, or is not of finite numbers."""
        for name in ("gripped_at", "force"):
            real_array(f"HandState.{name}", getattr(self, name), (num_envs, 3))


@dataclass(eq=False)
class Hands:
    """A hand for every environment of a batch, see `Hand`.

    Attributes:
        plant: whose tools they hold.
        decimation: control ticks per step.
        force: on the tool, mean over the past step, in the world, (num_envs, 3), N; to be cleared before a step.
        point: each hand's own point at the last tick, (num_envs, 3), m.
        held: how firmly each holds on, from 0, not at all, to 1, (num_envs,).
    """

    plant: FlexibleJointPlant
    decimation: int = 1
    force: Array = field(init=False)
    point: Array = field(init=False)
    held: Array = field(init=False)

    def __post_init__(self) -> None:
        num_envs = self.plant.num_envs
        self.force, self.point, self._gripped_at = np.zeros((3, num_envs, 3))
        self.held = np.zeros(num_envs)
        self._grip, self._let_go, self._gone = np.zeros((3, num_envs), dtype=np.int64)
        self._numbers = np.zeros((num_envs, len(_NUMBERS)))
        self._direction = np.zeros((num_envs, 3))

    def set(self, i: int, hand: Hand) -> None:
        """Give environment i its hand, which has not gripped yet."""
        dt = self.plant.control_dt
        self._grip[i], self._let_go[i] = round(hand.grip / dt), round(hand.let_go / dt)
        self._gone[i] = self._let_go[i] + np.ceil(hand.release / dt)
        self._numbers[i] = [getattr(hand, name) for name in _NUMBERS]
        self._direction[i] = cast("Any", hand.direction)
        self.force[i] = self._gripped_at[i] = self.held[i] = 0.0

    def act(self, ticks: NDArray[np.int64], tau_ext: Array) -> None:
        """Add J^T f, held over the coming period, to tau_ext (num_envs, dof), and to `force` the share of a step.

        A hand grips where the tool is when the tick of its grip has come, and is a spring and a damper from then on: f
        is that of the links' true place and velocity at the tick.
        """
        idle = (ticks < self._grip) | (ticks >= self._gone)
        self.held[idle] = 0.0
        if idle.all():
            return
        plant = self.plant
        pose = plant.body.links.tool_pose(plant.q)
        after = (ticks - self._grip) * plant.control_dt
        gone = (ticks - self._let_go) * plant.control_dt
        force = np.zeros_like(self.force)
        hand = self._numbers, self._direction, self._gripped_at, self.point, self.held
        pull(after, gone, pose.position, pose.jacobian, plant.q_dot, *hand, force, tau_ext)
        self.force += force / self.decimation

    def get_state(self) -> HandState:
        """A copy of what they remember."""
        return HandState(self._gripped_at.copy(), self.force.copy())

    def set_state(self, state: HandState) -> None:
        """Continue from a copy of `state`; the hands themselves have been set."""
        self._gripped_at[:], self.force[:] = state.gripped_at, state.force
