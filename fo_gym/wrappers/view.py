"""What an agent sees of a batch of joints, and what its actions mean, whoever steps the joints."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from fo_gym.checks import real, whole_number
from fo_gym.scaling import LARGEST, ROWS, scaled, torque_share
from fo_gym.signals import Signals
from fo_gym.simulation.simulation import Simulation

Array = NDArray[np.float64]

__all__ = ["Frames", "View"]


class Frames:
    """The last `stack` observations of each environment, the newest last.

    Args:
        stack: how many, at least 1.

    Raises:
        ValueError: `stack` is no such number.
    """

    def __init__(self, stack: int) -> None:
        self.stack = whole_number("stack", stack, 1)
        self._frames = np.zeros((0, self.stack, 0), dtype=np.float32)

    def see(self, frame: NDArray[np.float32], first: NDArray[np.bool_], *, moved: bool = True) -> NDArray[np.float32]:
        """The observations with this newest frame, (num_envs, stack x size): a new array.

        Args:
            frame: (num_envs, size).
            first: whose episode has just begun, (num_envs,): all of its frames are this one.
            moved: whether time went on in the others; where not, nothing of theirs changes.
        """
        if len(self._frames) != len(frame):
            self._frames = np.repeat(frame[:, None], self.stack, axis=1)
        if moved:
            self._frames = np.concatenate([self._frames[:, 1:], frame[:, None]], axis=1)
        self._frames[first] = frame[first, None]
        return self._frames.reshape(len(frame), -1).copy()


class View:
    """The face that a simulation shows to agents.

    Args:
        simulation: whose environment is wrapped.
        stack: observations that are seen together.
        action_share: see `fo_gym.scaling.torque_share`.

    Attributes:
        action_scale: what the action 1 means, (dof,) [N | N m].
        observation_space, action_space: of one environment, float32 and finite.
        signals: the true observation that was last looked at, (num_envs, dof) each.

    Raises:
        ValueError: an argument is out of bounds.
    """

    signals: Signals

    def __init__(self, simulation: Simulation, stack: int, action_share: float | None) -> None:
        self._simulation = simulation
        self._frames = Frames(stack)
        dof, references = simulation.dof, simulation.control.reference.shape[1]
        self._limit = np.broadcast_to(simulation.torque_limit, (dof,))
        self.action_scale = torque_share(simulation.settings.action_mode, action_share) * self._limit
        size = self._frames.stack * (len(ROWS) * dof + 1 + references)
        self.observation_space = Box(-LARGEST, LARGEST, (size,), np.float32)
        self.action_space = Box(-1.0, 1.0, (dof,), np.float32)

    def look(self, obs: Array, *, moved: bool = True) -> NDArray[np.float32]:
        """The agent's observation, (num_envs, size), of the environment's own; `moved` says that a step gave it."""
        self.signals = Signals.from_observation(obs, self._simulation.dof, self._simulation.available)
        frame = scaled(self.signals, self._simulation.hardware_model.motor_inertia, self._limit)
        return self._frames.see(frame, self.signals.time[:, 0] == 0.0, moved=moved)

    def torque(self, action: Any, shape: tuple[int, ...]) -> Array:
        """What an action of this shape means [N | N m]; beyond +-1 it is clipped.

        Raises:
            ValueError: the action has another shape, or does not hold real numbers. What is not finite is left to
                the environment, which refuses it unless it ignores the action.
        """
        array = real("action", action)
        if array.shape != shape:
            raise ValueError(f"action has shape {array.shape}; this view takes {shape}")
        return np.where(np.isfinite(array), np.clip(array, -1.0, 1.0), array) * self.action_scale
