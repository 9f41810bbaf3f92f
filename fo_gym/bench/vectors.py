"""What else steps many environments: the vectors of Gymnasium and of Stable-Baselines3."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from functools import partial
from typing import Any, cast

import gymnasium as gym

from fo_gym.bench.measure import Subject
from fo_gym.bench.subjects import SETTINGS, actions
from fo_gym.envs.vector import JointVectorEnv

Reset = Callable[[], Any]

_TRAINING: dict[str, Any] = {**SETTINGS, "variant": "randomized"}
# What the server of processes imports once, instead of every process for itself.
_IMPORTS = [
    "__main__",
    "fo_gym.bench.vectors",
    "gymnasium.vector.async_vector_env",
    "stable_baselines3.common.vec_env.subproc_vec_env",
]

__all__ = ["gymnasium_async", "gymnasium_sync", "many_beside_peer", "sb3_subproc"]


def _start_method() -> str:
    """How processes of environments start: without copying the threads of this one."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return "spawn"
    multiprocessing.get_context("forkserver").set_forkserver_preload(_IMPORTS)
    return "forkserver"


def gymnasium_sync(env_id: str, num_envs: int) -> tuple[Any, Reset]:
    """Gymnasium's SyncVectorEnv: one environment after the other."""
    envs = gym.make_vec(env_id, num_envs, "sync", **_TRAINING)
    return envs, partial(envs.reset, seed=0)


def gymnasium_async(env_id: str, num_envs: int) -> tuple[Any, Reset]:
    """Gymnasium's AsyncVectorEnv: a process for every environment."""
    envs = gym.make_vec(env_id, num_envs, "async", {"context": _start_method()}, **_TRAINING)
    return envs, partial(envs.reset, seed=0)


def _training_env(env_id: str) -> gym.Env[Any, Any]:
    # Named here so that a new process, which looks it up, imports this package and with it the environments.
    return gym.make(env_id, **_TRAINING)


def sb3_subproc(env_id: str, num_envs: int) -> tuple[Any, Reset]:
    """Stable-Baselines3's SubprocVecEnv: a process for every environment.

    Raises:
        ModuleNotFoundError: Stable-Baselines3 is not installed.
    """
    from stable_baselines3.common.vec_env import SubprocVecEnv  # noqa: PLC0415

    makers: list[Callable[[], gym.Env[Any, Any]]] = [partial(_training_env, env_id)] * num_envs
    envs = SubprocVecEnv(makers, start_method=_start_method())

    def reset() -> Any:
        envs.seed(0)
        return envs.reset()

    return envs, reset


@contextmanager
def many_beside_peer(
    env_id: str, num_envs: int, make_peer: Callable[[str, int], tuple[Any, Reset]]
) -> Iterator[list[Subject]]:
    """A step of `num_envs` environments in one batch, and of the same randomized episodes as `make_peer` has them."""
    peer, reset = make_peer(env_id, num_envs)
    with closing(peer), closing(gym.make_vec(env_id, num_envs, num_threads=1, **_TRAINING)) as envs:
        action = actions(cast(JointVectorEnv, envs.unwrapped).simulation)
        yield [
            Subject(call=partial(envs.step, action), prepare=partial(envs.reset, seed=0)),
            Subject(call=partial(peer.step, action), prepare=reset),
        ]
