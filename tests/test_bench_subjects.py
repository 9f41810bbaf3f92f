"""The benchmark of speed times what it says: the same work, from the same start, to the same end."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from environments import every_env

from fo_gym.bench.accuracy import one_beside_lsoda, some_beside_twins
from fo_gym.bench.bars import INTEGRATORS
from fo_gym.bench.growth import batches_of, chains_of, threads_of
from fo_gym.bench.memory import batch_of, growths_of_resident_set, twins_of
from fo_gym.bench.precision import cases_of, lsoda
from fo_gym.bench.subjects import one_beside_mujoco, some_beside_mujoco
from fo_gym.bench.vectors import gymnasium_async, gymnasium_sync, many_beside_peer, sb3_subproc
from fo_gym.bench.yardsticks import one_beside_pusher, tick_beside_step
from fo_gym.certificate.steppers import motion
from fo_gym.plant.twin import INTEGRATORS as MUJOCO_INTEGRATORS

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


@pytest.mark.parametrize("env_id", [STICTION, REGULATION])
def test_the_twins_of_equal_accuracy_take_as_many_steps_as_they_need(env_id: str) -> None:
    with some_beside_twins(env_id, 3, (50, 40, 20)) as (ours, *twins):
        plant = ours.call.func.__self__.unwrapped.simulation.plant
        for twin, integrator, steps in zip(twins, INTEGRATORS, (50, 40, 20), strict=True):
            batch = twin.call.func.__self__
            assert batch.model.opt.integrator == MUJOCO_INTEGRATORS[integrator]
            assert twin.call.keywords == {"nstep": steps}
            ours.prepare()
            twin.prepare()
            start = batch.qpos.copy()
            ours.call()
            twin.call()
            np.testing.assert_allclose(batch.time, plant.time)
            moved = np.concatenate([plant.q, plant.theta], axis=1) - start
            np.testing.assert_allclose(batch.qpos - start, moved, atol=0.01 * np.abs(moved).max())


@pytest.mark.parametrize("env_id", [STICTION, REGULATION])
def test_lsoda_goes_through_its_case_from_the_start(env_id: str) -> None:
    (case,) = cases_of(env_id, 1, 3)
    expected = motion(case, lsoda(case, 1e-6))
    with one_beside_lsoda(env_id, 1e-6) as (_, theirs):
        solved = theirs.call.__self__
        for _ in range(2):
            theirs.prepare()
            period, seen = solved.period, []
            solved.period = lambda push, period=period, seen=seen: seen.append(period(push))
            for _ in range(3):
                theirs.call()
            np.testing.assert_array_equal(seen, expected)


def test_growth_is_over_what_it_says() -> None:
    with batches_of(STICTION, (1, 3)) as subjects:
        assert [len(observation(each.call())) for each in subjects] == [1, 3]
    with threads_of(STICTION, (1, 2), 900) as subjects:
        counts = [each.call.func.__self__.unwrapped.simulation.plant.threads.count for each in subjects]
        assert counts == [1, 2]
    with chains_of(REGULATION, (1, 2, 14), 2) as subjects:
        plants = [each.call.func.__self__.unwrapped.simulation.plant for each in subjects]
        assert [plant.q.shape for plant in plants] == [(2, 1), (2, 2), (2, 14)]
        for each, plant in zip(subjects, plants, strict=True):
            each.prepare()
            before = plant.q.copy()
            for _ in range(300):
                _, _, terminated, truncated, _ = each.call()
            assert not (terminated | truncated).any()
            assert (np.abs(plant.q - before).max(axis=0) > 1e-9).all()


def test_a_step_of_pusher_is_five_physics_steps() -> None:
    with one_beside_pusher(REGULATION) as (_, theirs):
        pusher = theirs.call.func.__self__.unwrapped
        theirs.prepare()
        before = pusher.data.time
        theirs.call()
        assert round((pusher.data.time - before) / pusher.model.opt.timestep) == 5
        assert pusher.model.njnt - 4 == 7  # beside the slides of the two things


def test_the_observer_is_asked_for_all_environments() -> None:
    with tick_beside_step(REGULATION, 3) as (tick, step):
        tick.prepare()
        estimate = np.asarray(tick.call())
        assert estimate.shape == (3, 7)
        assert np.abs(estimate).max() > 0.0
        assert len(observation(step.call())) == 3


def test_the_resident_set_grows_with_what_is_made() -> None:
    made: list[np.ndarray] = []

    def make(env_id: str, num_envs: int) -> np.ndarray:
        made.append(np.ones(num_envs * 50_000))
        return made[-1]

    grown = growths_of_resident_set((make, make), STICTION, 100)
    assert grown == pytest.approx([8 * 101 * 50_000] * 2, rel=0.2)
    assert [len(each) for each in made] == [50_000, 101 * 50_000] * 2


def test_what_memory_is_measured_of() -> None:
    assert batch_of(STICTION, 3).unwrapped.simulation.plant.time.tolist() == [1e-3] * 3
    assert twins_of(STICTION, 3).time.tolist() == [1e-4] * 3
