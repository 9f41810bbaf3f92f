"""The benchmark of speed times what it says: the same work, from the same start, to the same end."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from environments import every_env

from fo_gym.bench.subjects import (
    gymnasium_async,
    gymnasium_sync,
    many_beside_peer,
    one_beside_mujoco,
    sb3_subproc,
    some_beside_mujoco,
)

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"

OPENERS = {"batch": lambda env_id: some_beside_mujoco(env_id, 3), "single": one_beside_mujoco}


def observation(result: object) -> np.ndarray:
    return np.asarray(result[0])  # type: ignore[index]


@every_env
@pytest.mark.parametrize("opener", OPENERS.values(), ids=OPENERS)
def test_the_twin_does_the_same_work(env_id: str, opener: Callable) -> None:
    """It starts where ours is, with one thread, and its call takes it through the same time and the same motion."""
    with opener(env_id) as (ours, twin, *_):
        plant = ours.call.func.__self__.unwrapped.simulation.plant
        batch = twin.call.func.__self__
        for _ in range(2):  # from where it was left, back to the start
            ours.prepare()
            twin.prepare()
            start = batch.qpos.copy()
            np.testing.assert_array_equal(start, np.concatenate([plant.q, plant.theta], axis=1))
            before = plant.time
            for _ in range(5):
                ours.call()
                twin.call()
            np.testing.assert_allclose(plant.time - before, 5e-3)
            np.testing.assert_allclose(batch.time, plant.time)
            moved = np.concatenate([plant.q, plant.theta], axis=1) - start
            np.testing.assert_allclose(batch.qpos - start, moved, atol=0.01 * np.abs(moved).max())
        assert np.abs(moved).max() > 1e-8
        assert batch.nsim == plant.num_envs
        assert (batch.nthread, batch.model.opt.timestep) == (1, 1e-4)


@pytest.mark.slow
@every_env
@pytest.mark.parametrize("opener", OPENERS.values(), ids=OPENERS)
def test_nothing_ends_while_the_clock_runs(env_id: str, opener: Callable) -> None:
    """A slice of one environment is some thousand steps."""
    with opener(env_id) as (ours, twin, *_):
        batch = twin.call.func.__self__
        for _ in range(10_000 if batch.nsim == 1 else 500):
            _, reward, terminated, truncated, _ = ours.call()
            twin.call()
            assert not np.any(terminated | truncated)
            assert np.all(np.asarray(reward) > 0.0)
        assert np.isfinite(batch.state).all()
        assert not batch.warning.any()


@every_env
def test_every_slice_is_the_same_work(env_id: str) -> None:
    for opener in OPENERS.values():
        with opener(env_id) as (ours, *_):
            motions = []
            for _ in range(2):
                ours.prepare()
                motions.append([observation(ours.call()) for _ in range(5)])
            np.testing.assert_array_equal(*motions)


@every_env
def test_forward_is_what_the_plant_asks_for(env_id: str) -> None:
    with some_beside_mujoco(env_id, 3) as (ours, _, forward):
        plant = ours.call.func.__self__.unwrapped.simulation.plant
        batch = forward.call.func.__self__
        inertia, bias = batch.bind("M"), batch.bind("qfrc_bias")
        forward.prepare()
        forward.call()
        expected_inertia, expected_bias = plant.body.dynamics(plant.q, plant.q_dot)
        np.testing.assert_array_equal(inertia, expected_inertia)
        np.testing.assert_array_equal(bias - batch.bind("qfrc_passive"), expected_bias)
        assert batch.nthread == 1
        assert forward.call.keywords == {"stage": int(mujoco.mjtStage.mjSTAGE_VEL)}


@pytest.mark.parametrize("env_id", [STICTION, REGULATION])
@pytest.mark.parametrize(
    "peer", [gymnasium_sync, *(pytest.param(peer, marks=pytest.mark.slow) for peer in (gymnasium_async, sb3_subproc))]
)
def test_peers_step_the_same_environments(env_id: str, peer: Callable) -> None:
    """To the bit, seed by seed; their processes are gone afterwards."""
    children = set(multiprocessing.active_children())
    with many_beside_peer(env_id, 3, peer) as (ours, theirs):
        for _ in range(2):
            ours.prepare()
            theirs.prepare()
            for _ in range(3):
                mine = observation(ours.call())
                np.testing.assert_array_equal(mine, observation(theirs.call()))
        assert len(np.unique(mine, axis=0)) == 3
        processes = set(multiprocessing.active_children()) - children
        assert len(processes) == (0 if peer is gymnasium_sync else 3)
    assert set(multiprocessing.active_children()) == children
