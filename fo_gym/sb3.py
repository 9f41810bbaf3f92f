"""Stable-Baselines3 on the vector environments: `VecEnvAdapter` and `make_vec_env`. Needs the extra "rl"."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from fo_gym.checks import text
from fo_gym.extras import install_command
from fo_gym.generators import seed_number

try:
    from stable_baselines3.common.vec_env import VecEnv
    from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvStepReturn
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(f"{error}; fo_gym.sb3 needs: {install_command('rl')}", name=error.name) from error

__all__ = ["VecEnvAdapter", "make_vec_env"]


class VecEnvAdapter(VecEnv):
    """A Gymnasium vector environment with autoreset mode DISABLED, as Stable-Baselines3 wants it.

    Observations and actions keep their dtype; rewards are float32, as in SB3's own vectors. Where an episode ends, the
    observation is the next one's first, and the environment's info holds "terminal_observation",
    "TimeLimit.truncated", and "termination" where the environment ended it; elsewhere infos are empty, since a
    dictionary per environment and step would cost more than the physics. The batch is one object: attributes and
    methods are those of the whole batch, the same for every index.

    Args:
        env: the vector environment; of its spaces the single ones are SB3's.

    Raises:
        ValueError: the autoreset mode is another one.
    """

    def __init__(self, env: VectorEnv[Any, Any, Any]) -> None:
        mode = env.metadata.get("autoreset_mode")
        if mode is not AutoresetMode.DISABLED:
            raise ValueError(
                f"autoreset_mode is {mode}; the adapter resets what has ended itself: make the environment with "
                "autoreset_mode=AutoresetMode.DISABLED, or use fo_gym.sb3.make_vec_env"
            )
        self.env = env
        self._actions: NDArray[Any] | None = None
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)

    def reset(self) -> NDArray[Any]:
        """Start an episode everywhere, with the seeds and options given since the last reset."""
        seeds: Any = None if all(seed is None for seed in self._seeds) else list(self._seeds)
        if not all(_equal(options, self._options[0]) for options in self._options):
            raise ValueError("options differ between environments; one batch takes the same for all")
        obs, _ = self.env.reset(seed=seeds, options=self._options[0] or None)
        self.reset_infos = [{} for _ in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        return np.asarray(obs)

    def step_async(self, actions: NDArray[Any]) -> None:
        """Keep the actions for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> VecEnvStepReturn:
        """Take the step: observations, rewards, dones, infos."""
        obs, reward, terminated, truncated, info = self.env.step(self._actions)
        done = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for i in np.flatnonzero(done):
            infos[i]["terminal_observation"] = np.array(obs[i])
            infos[i]["TimeLimit.truncated"] = bool(truncated[i] and not terminated[i])
            if terminated[i] and "termination" in info:
                infos[i]["termination"] = info["termination"][i]
        if done.any():
            obs, _ = self.env.reset(options={"reset_mask": done})
        return np.asarray(obs), reward.astype(np.float32), done, infos

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """One image of every environment."""
        images: Any = self.env.render()
        return list(images) if images is not None else []

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """The batch's attribute, once for every index."""
        value = self._found(attr_name)
        return [value for _ in self._get_indices(indices)]

    def _found(self, name: str) -> Any:
        """What the wrapper has of this name, or else the batch itself."""
        return getattr(self.env if hasattr(self.env, name) else self.env.unwrapped, name)

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Set the batch's attribute.

        Raises:
            ValueError: only some of the environments are named.
        """
        if indices is not None and len(list(self._get_indices(indices))) != self.num_envs:
            raise ValueError(f"attribute {attr_name!r} belongs to the whole batch; leave indices out")
        setattr(self.env.unwrapped, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: VecEnvIndices = None, **kwargs: Any) -> list[Any]:
        """Call the batch's method once; its result, once for every index."""
        result = self._found(method_name)(*args, **kwargs)
        return [result for _ in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: VecEnvIndices = None) -> list[bool]:
        """Whether the vector environment is wrapped with a vector wrapper of this class."""
        env: Any = self.env
        found = isinstance(env, wrapper_class)
        while not found and isinstance(env, gym.vector.VectorWrapper):
            env = env.env
            found = isinstance(env, wrapper_class)
        return [found for _ in self._get_indices(indices)]


def _equal(one: Any, other: Any) -> bool:
    """Whether two options of a reset are the same: mappings, or values that may be arrays."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_equal(one[name], other[name]) for name in one)
    return np.array_equal(one, other)


def make_vec_env(
    env_id: str,
    num_envs: int,
    *,
    seed: int | None = None,
    wrapper: Callable[[VectorEnv[Any, Any, Any]], VectorEnv[Any, Any, Any]] | None = None,
    **settings: Any,
) -> VecEnvAdapter:
    """`num_envs` environments in one batch, as a Stable-Baselines3 VecEnv.

    Args:
        env_id: a registered environment, such as "FJRStiction-v0".
        num_envs: size of the batch.
        seed: environment i gets the seed `seed` + i at the first reset.
        wrapper: makes of the vector environment what is adapted, such as `fo_gym.wrappers.vector.AgentView`; None
            leaves it as it is.
        settings: arguments of the environment, see `fo_gym.Settings`.

    Raises:
        ValueError, TypeError: an argument is not allowed.
    """
    text("env_id", env_id)
    seed = None if seed is None else seed_number("seed", seed)
    env = gym.make_vec(env_id, num_envs=num_envs, autoreset_mode=AutoresetMode.DISABLED, **settings)
    venv = VecEnvAdapter(env if wrapper is None else wrapper(env))
    if seed is not None:
        venv.seed(seed)
    return venv
