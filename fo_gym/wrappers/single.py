"""The view of a single environment."""

from __future__ import annotations

from typing import Any, TypeVar

import gymnasium as gym
import numpy as np
from gymnasium.utils import RecordConstructorArgs
from numpy.typing import NDArray

from fo_gym.envs.single import JointEnv
from fo_gym.signals import Signals
from fo_gym.wrappers.view import View

Array = NDArray[np.float64]
Seen = NDArray[np.float32]
Kind = TypeVar("Kind")

__all__ = ["AgentView", "checked_inner"]


def checked_inner(env: Any, kind: type[Kind], elsewhere: str) -> Kind:
    """The innermost environment. Raises TypeError where it is not of this kind; `elsewhere` is where to look then."""
    if not isinstance(inner := getattr(env, "unwrapped", env), kind):
        raise TypeError(f"env is {env}; AgentView takes environments of fo_gym: {elsewhere}")
    return inner


class AgentView(gym.Wrapper[Any, Any, Any, Any], RecordConstructorArgs):
    """Actions in [-1, 1] and scaled observations, float32 and finite, of any environment of fo_gym.

    Action 1 is `action_share` of the joint's torque limit, in either action mode; beyond +-1 actions are clipped. With
    s = 0.02 torque limits, L = 100 1/s and L_p = 20 1/s the observation is, joint by joint in each block:

    | block | value | |
    | --- | --- | --- |
    | distance | arsinh(B L L_p (theta - theta_d) / s) | from the target |
    | velocity | arsinh(B L theta' / s) | |
    | lag | arsinh(B L L_p (theta_n - theta) / s) | behind the friction-free motor |
    | rate | arsinh(B L (theta_n' - theta') / s) | |
    | drive | arsinh((tau_c - tau_j) / s) | what would accelerate the motor without friction |
    | tau_c | arsinh(tau_c / s) | the controller's torque |
    | tau_m | arsinh(tau_m / s) | the motor's, in the past step |
    | theta_d | theta_d [m or rad] | |

    then arsinh(time / 1 s) and the task's reference [m], if it has one; everything clipped to +-10. B is what
    `JointInfo` tells of the episode. The reward is the environment's.

    Args:
        env: the environment; other wrappers that leave observations and actions alone may lie between.
        stack: how many observations are seen together, the newest last; an episode begins with its first one repeated.
        action_share: above 0, at most 1; None means 0.3 for `action_mode="compensation"`, 1 for "torque".

    Raises:
        TypeError: `env` is none of fo_gym's.
        ValueError: an argument is out of bounds.
    """

    def __init__(self, env: gym.Env[Array, Array], stack: int = 1, action_share: float | None = None) -> None:
        inner = checked_inner(env, JointEnv, "gym.make('FJRStiction-v0'); of gym.make_vec, see fo_gym.wrappers.vector")
        RecordConstructorArgs.__init__(self, stack=stack, action_share=action_share)
        gym.Wrapper.__init__(self, env)
        self._view = View(inner.simulation, stack, action_share)
        self.observation_space = self._view.observation_space
        self.action_space = self._view.action_space

    @property
    def signals(self) -> Signals:
        """The environment's own last observation, in physical units and float64, (dof,) each."""
        seen = self._view.signals
        return Signals.from_observation(seen.observation()[0], seen.theta.shape[-1], seen.available)

    @property
    def action_scale(self) -> Array:
        """What the action 1 means, (dof,) [N | N m]."""
        return self._view.action_scale.copy()

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Seen, dict[str, Any]]:
        """As `JointEnv.reset`, with its errors."""
        obs, info = self.env.reset(seed=seed, options=options)
        return self._view.look(obs[None], moved=False)[0], info

    def step(self, action: Seen) -> tuple[Seen, Any, bool, bool, dict[str, Any]]:
        """As `JointEnv.step`, with its errors; `info` is privileged truth in physical units."""
        assert self.action_space.shape is not None
        torque = self._view.torque(action, self.action_space.shape)
        obs, reward, terminated, truncated, info = self.env.step(torque)
        return self._view.look(obs[None])[0], reward, terminated, truncated, info
