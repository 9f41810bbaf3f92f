"""What is timed: our environments, and beside them MuJoCo alone."""

from __future__ import annotations

from collections.abc import Iterator
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

TWIN_TIMESTEP = 1e-4
"""MuJoCo's step of the twin [s]."""

SETTINGS: dict[str, Any] = {"duration": 3600.0}  # no episode ends while the clock runs
_PERIODS_BEFORE = 200

__all__ = [
    "SETTINGS",
    "TWIN_TIMESTEP",
    "actions",
    "batch",
    "forward",
    "one",
    "one_beside_mujoco",
    "some_beside_mujoco",
    "threads_beside_one",
    "twin",
]


def actions(simulation: Simulation) -> Array:
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


def twin(simulation: Simulation, timestep: float = TWIN_TIMESTEP, integrator: str = "implicitfast") -> Subject:
    """One control period of every environment's twin from where it is now, its motor torque held: physics alone.

    It is as lean as MuJoCo has it: nothing to see, no contacts, no joint limits. All environments must have the
    parameters of the first: they are nominal.

    Args:
        simulation: of ours.
        timestep: MuJoCo's step [s], which divides the control period.
        integrator: MuJoCo's, see `FlexibleJointPlant.to_mujoco`.
    """
    plant = simulation.plant
    model, _ = plant.to_mujoco(timestep=timestep, integrator=integrator, scene=False)
    batch = Batch(model, simulation.num_envs, nthread=1)  # ours has one thread, too
    batch.bind("time")[:] = plant.time
    batch.bind("qpos")[:] = np.concatenate([plant.q, plant.theta], axis=1)
    batch.bind("qvel")[:] = np.concatenate([plant.q_dot, plant.theta_dot], axis=1)
    batch.bind("act")[:] = plant.z
    batch.bind("ctrl")[:] = simulation.memory.past[TAU_M]
    start = batch.state.copy()
    steps = round(simulation.settings.control_dt / timestep)
    return Subject(call=partial(batch.step, nstep=steps), prepare=partial(np.copyto, batch.state, start))


def forward(simulation: Simulation) -> Subject:
    """What our plant asks of MuJoCo in a period: inertia and bias of the links, once for every environment."""
    plant = simulation.plant
    batch = Batch(plant.body.model, simulation.num_envs, nthread=1)
    batch.bind("qpos")[:] = plant.q
    batch.bind("qvel")[:] = plant.q_dot
    stage = int(mujoco.mjtStage.mjSTAGE_VEL)
    return Subject(call=partial(batch.forward, stage=stage), prepare=lambda: None)


@contextmanager
def batch(env_id: str, num_envs: int, num_threads: int = 1, **settings: Any) -> Iterator[tuple[Subject, Simulation]]:
    """A control period of `num_envs` environments, and their simulation; `settings` are the environment's."""
    with closing(gym.make_vec(env_id, num_envs=num_envs, num_threads=num_threads, **SETTINGS, **settings)) as envs:
        ours = cast(JointVectorEnv, envs.unwrapped)
        yield _held(envs, ours, actions(ours.simulation)), ours.simulation


@contextmanager
def one(env_id: str) -> Iterator[tuple[Subject, Simulation]]:
    """A control period of one environment as `gymnasium.make` gives it, and its simulation."""
    with closing(gym.make(env_id, **SETTINGS)) as env:
        ours = cast(JointEnv, env.unwrapped)
        yield _held(env, ours, actions(ours.simulation)[0]), ours.simulation


@contextmanager
def some_beside_mujoco(env_id: str, num_envs: int) -> Iterator[list[Subject]]:
    """A control period of `num_envs` environments, of their twins, and of MuJoCo's part in our plants."""
    with batch(env_id, num_envs) as (held, simulation):
        yield [held, twin(simulation), forward(simulation)]


@contextmanager
def one_beside_mujoco(env_id: str) -> Iterator[list[Subject]]:
    """A control period of one environment, and of its twin."""
    with one(env_id) as (held, simulation):
        yield [held, twin(simulation)]


@contextmanager
def threads_beside_one(env_id: str, num_envs: int, num_threads: int) -> Iterator[list[Subject]]:
    """A control period of `num_envs` environments on some threads, and on one."""
    with batch(env_id, num_envs, num_threads) as (some, _), batch(env_id, num_envs) as (single, _):
        yield [some, single]
