"""The view of a vector environment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import VectorEnv, VectorWrapper
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from fo_gym.envs.vector import JointVectorEnv
from fo_gym.signals import Signals
from fo_gym.wrappers.single import checked_inner
from fo_gym.wrappers.view import View

Array = NDArray[np.float64]
Seen = NDArray[np.float32]

__all__ = ["AgentView"]


class AgentView(VectorWrapper):
    """`fo_gym.wrappers.AgentView` of a batch: row i is, to the bit, what that of environment i alone gives.

    Both autoreset modes of the environments are followed: where an episode begins, its first observation is seen
    alone.

    Args:
        env: the vector environment of `gymnasium.make_vec`.
        stack, action_share: as of `fo_gym.wrappers.AgentView`.

    Raises:
        TypeError: `env` is none of fo_gym's.
        ValueError: an argument is out of bounds.
    """

    def __init__(self, env: VectorEnv[Any, Any, Any], stack: int = 1, action_share: float | None = None) -> None:
        inner = checked_inner(env, JointVectorEnv, "gym.make_vec('FJRStiction-v0', num_envs=8)")
        super().__init__(env)
        self._view = View(inner.simulation, stack, action_share)
        self.single_observation_space = self._view.observation_space
        self.single_action_space = self._view.action_space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    @property
    def signals(self) -> Signals:
        """The environments' own last observation, in physical units and float64, (num_envs, dof) each."""
        return self._view.signals

    @property
    def action_scale(self) -> Array:
        """What the action 1 means, (dof,) [N | N m]."""
        return self._view.action_scale.copy()

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Seen, dict[str, Any]]:
        """As `JointVectorEnv.reset`, with its errors; with a "reset_mask", what the others have seen stays."""
        envs: Any = self.env  # Gymnasium's type of a batch knows one seed alone
        obs, info = envs.reset(seed=seed, options=options)
        return self._view.look(obs, moved=False), info

    def step(self, actions: Seen) -> tuple[Seen, Array, NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """As `JointVectorEnv.step`, with its errors."""
        assert self.action_space.shape is not None
        torque = self._view.torque(actions, self.action_space.shape)
        obs, reward, terminated, truncated, info = self.env.step(torque)
        return self._view.look(obs), reward, terminated, truncated, info
