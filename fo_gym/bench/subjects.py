"""What is timed: our environments, and beside them MuJoCo alone and what else steps many environments."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from functools import partial
from typing import Any, cast

import gymnasium as gym
import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from fo_gym.bench.measure import Subject
from fo_gym.envs.single import JointEnv
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.simulation.kernels import TAU_M
from fo_gym.simulation.simulation import Simulation

Array = NDArray[np.float64]
Reset = Callable[[], Any]

TWIN_TIMESTEP = 1e-4
"""MuJoCo's step of the twin [s]."""

_SETTINGS: dict[str, Any] = {"duration": 3600.0}  # no episode ends while the clock runs
_TRAINING: dict[str, Any] = {**_SETTINGS, "variant": "randomized"}
_PERIODS_BEFORE = 200
# What the server of processes imports once, instead of every process for itself.
_IMPORTS = [
    "__main__",
    "fo_gym.bench.subjects",
    "gymnasium.vector.async_vector_env",
    "stable_baselines3.common.vec_env.subproc_vec_env",
]

__all__ = [
    "TWIN_TIMESTEP",
    "gymnasium_async",
    "gymnasium_sync",
    "many_beside_few",
    "many_beside_peer",
    "one_beside_mujoco",
    "sb3_subproc",
    "some_beside_mujoco",
    "threads_beside_one",
]


def _actions(simulation: Simulation) -> Array:
    """One wrong friction estimate for each joint, (num_envs, dof), up to twice Coulomb's: some stick, some slide."""
    shape = (simulation.num_envs, simulation.dof)
    return np.random.default_rng(0).uniform(-2.0, 2.0, shape) * simulation.robot.friction.level("coulomb")


def _held(env: Any, ours: JointEnv | JointVectorEnv, action: Array) -> Subject:
    """One control period of `env` under this action, wrappers around `ours` included, from a moment of its motion."""
    env.reset(seed=0)
    for _ in range(_PERIODS_BEFORE):
        env.step(action)
    state: Any = ours.get_state()
    return Subject(call=partial(env.step, action), prepare=partial(ours.set_state, state))


def _twin(simulation: Simulation) -> Subject:
    """One control period of every environment's twin from where it is now, its motor torque held: physics alone.

    It is as lean as MuJoCo has it: nothing to see, no contacts, no joint limits. All environments must have the
    parameters of the first: they are nominal.
    """
    plant = simulation.plant
    model, _ = plant.to_mujoco(timestep=TWIN_TIMESTEP, scene=False)
    batch = Batch(model, simulation.num_envs, nthread=1)  # ours has one thread, too
    batch.bind("time")[:] = plant.time
    batch.bind("qpos")[:] = np.concatenate([plant.q, plant.theta], axis=1)
    batch.bind("qvel")[:] = np.concatenate([plant.q_dot, plant.theta_dot], axis=1)
    batch.bind("act")[:] = plant.z
    batch.bind("ctrl")[:] = simulation.memory.past[TAU_M]
    start = batch.state.copy()
    steps = round(simulation.settings.control_dt / TWIN_TIMESTEP)
    return Subject(call=partial(batch.step, nstep=steps), prepare=partial(np.copyto, batch.state, start))


def _forward(simulation: Simulation) -> Subject:
    """What our plant asks of MuJoCo in a period: inertia and bias of the links, once for every environment."""
    plant = simulation.plant
    batch = Batch(plant.body.model, simulation.num_envs, nthread=1)
    batch.bind("qpos")[:] = plant.q
    batch.bind("qvel")[:] = plant.q_dot
    stage = int(mujoco.mjtStage.mjSTAGE_VEL)
    return Subject(call=partial(batch.forward, stage=stage), prepare=lambda: None)


@contextmanager
def _batch(env_id: str, num_envs: int, num_threads: int = 1) -> Iterator[tuple[Subject, Simulation]]:
    with closing(gym.make_vec(env_id, num_envs=num_envs, num_threads=num_threads, **_SETTINGS)) as envs:
        ours = cast(JointVectorEnv, envs.unwrapped)
        yield _held(envs, ours, _actions(ours.simulation)), ours.simulation


@contextmanager
def some_beside_mujoco(env_id: str, num_envs: int) -> Iterator[list[Subject]]:
    """A control period of `num_envs` environments, of their twins, and of MuJoCo's part in our plants."""
    with _batch(env_id, num_envs) as (held, simulation):
        yield [held, _twin(simulation), _forward(simulation)]


@contextmanager
def threads_beside_one(env_id: str, num_envs: int, num_threads: int) -> Iterator[list[Subject]]:
    """A control period of `num_envs` environments on some threads, and on one."""
    with _batch(env_id, num_envs, num_threads) as (some, _), _batch(env_id, num_envs) as (one, _):
        yield [some, one]


@contextmanager
def many_beside_few(env_id: str, many: int, few: int) -> Iterator[list[Subject]]:
    """A control period of many environments, and of few."""
    with _batch(env_id, many) as (larger, _), _batch(env_id, few) as (smaller, _):
        yield [larger, smaller]


@contextmanager
def one_beside_mujoco(env_id: str) -> Iterator[list[Subject]]:
    """A control period of one environment as `gymnasium.make` gives it, and of its twin."""
    with closing(gym.make(env_id, **_SETTINGS)) as env:
        ours = cast(JointEnv, env.unwrapped)
        held = _held(env, ours, _actions(ours.simulation)[0])
        yield [held, _twin(ours.simulation)]


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
        action = _actions(cast(JointVectorEnv, envs.unwrapped).simulation)
        yield [
            Subject(call=partial(envs.step, action), prepare=partial(envs.reset, seed=0)),
            Subject(call=partial(peer.step, action), prepare=reset),
        ]
