"""Same seed, same bytes: alone or in a batch, copied, saved, or beside Gymnasium's own vector environment."""

from __future__ import annotations

import copy
import functools
import pickle
import random

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers.vector import DictInfoToList, NormalizeObservation, RecordEpisodeStatistics

import fo_gym

IDS = tuple(fo_gym.ENVIRONMENTS)
STICTION_ID = "FJRStiction-v0"

every_env = pytest.mark.parametrize("env_id", IDS)
every_variant = pytest.mark.parametrize("variant", ["nominal", "randomized", "hardware"])
duplicates = pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])


@functools.cache
def largest_action(env_id):
    return gym.make(env_id).action_space.high


def random_actions(env_id, steps, i):
    """Actions of environment i, (steps, dof): noise of a third of the limit, so that joints stick and slip."""
    high = largest_action(env_id)
    return np.random.default_rng(i).normal(0.0, 0.3, (steps, len(high))) * high


def batch_actions(env_id, steps, num_envs):
    """(steps, num_envs, dof)."""
    return np.stack([random_actions(env_id, steps, i) for i in range(num_envs)], axis=1)


def same(one, other):
    """Equal to the bit, types included."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray) and one.dtype != object:
        return (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())
    return type(one) is type(other) and np.array_equal(one, other)


def run(env, actions):
    """All that the environment says under these actions, none of which it changes afterwards."""
    said = [(step := env.step(action), copy.deepcopy(step)) for action in actions]
    assert all(same(step, as_it_was) for step, as_it_was in said)
    return [step for step, _ in said]


def single(env_id, variant="randomized", **arguments):
    return gym.make(env_id, variant=variant, **arguments).unwrapped


@every_env
@every_variant
def test_same_seed_same_bytes(env_id, variant):
    actions = random_actions(env_id, 100, 0)
    fresh, used = single(env_id, variant), single(env_id, variant)
    for seed in (5, None):
        used.reset(seed=seed, options={"push": {"time": 0, "duration": 1, "torque": np.ones(actions.shape[1])}})
        run(used, actions[:30])
    assert same(fresh.reset(seed=7), used.reset(seed=7))
    assert same(run(fresh, actions), run(used, actions))


@every_env
def test_other_seed_other_episode(env_id):
    """Every part of the episode that the variant draws is another one."""
    env = single(env_id)
    drawn = []
    for seed in (0, 1):
        obs, _ = env.reset(seed=seed)
        (episode,) = env.simulation.scenarios
        parts = {**vars(episode.friction), **vars(episode.joints), "start": episode.q_start, "mass": episode.mass_scale}
        if episode.push is not None:
            parts |= {"push torque": episode.push.torque, "push time": episode.push.time}
        if episode.hand is not None:
            parts |= {name: getattr(episode.hand, name) for name in ("stroke", "speed", "stiffness", "direction")}
        parts["observation"] = obs
        if env.simulation.limits.takes_target:
            parts["target"] = episode.target
        drawn.append(parts)
    equal = {name for name in drawn[0] if np.array_equal(drawn[0][name], drawn[1][name])}
    assert equal == {"damping", "torque_limit"}


@every_env
def test_without_friction_the_episode_is_the_same_otherwise(env_id):
    """What the score compares: the same joints, masses, start, target, push and hand, with and without friction."""
    one, other = single(env_id), single(env_id, friction=fo_gym.FRICTIONLESS)
    one.reset(seed=5)
    other.reset(seed=5)
    (mine,), (theirs,) = one.simulation.scenarios, other.simulation.scenarios
    for part in (
        lambda episode: vars(episode.joints),
        lambda episode: vars(episode.push) if episode.push else {},
        vars,
    ):
        rest = [{k: v for k, v in part(e).items() if k not in ("friction", "joints", "push")} for e in (mine, theirs)]
        assert same(*rest)
    assert (theirs.friction.sigma_0 == 0.0).all()


@every_env
def test_reset_without_seed_continues_the_generator(env_id):
    """The second and third episodes follow from the seed of the first, and differ from it and from each other."""
    for make in (single, lambda env_id: gym.make_vec(env_id, num_envs=2, variant="randomized")):
        env, other = make(env_id), make(env_id)
        episodes = [env.reset(seed=3), env.reset(), env.reset()]
        assert same(episodes, [other.reset(seed=3), other.reset(), other.reset()])
        for i, j in ((0, 1), (0, 2), (1, 2)):
            assert (episodes[i][1]["theta"] != episodes[j][1]["theta"]).all()


@every_env
@pytest.mark.parametrize(
    "variant", [*(pytest.param(v, marks=pytest.mark.slow) for v in ("nominal", "randomized")), "hardware"]
)
@pytest.mark.parametrize("action_mode", ["compensation", "torque"])
def test_vector_is_gymnasiums_own_to_the_bit(env_id, variant, action_mode):
    """Over 350 steps and more, past ends of episodes; under torque the last one leaves its joint range first."""
    duration = 0.15 if action_mode == "compensation" else 0.6 if env_id == STICTION_ID else 0.25
    arguments = {"num_envs": 3, "variant": variant, "action_mode": action_mode, "duration": duration}
    ours = gym.make_vec(env_id, **arguments)
    theirs = gym.make_vec(env_id, vectorization_mode="sync", **arguments)
    actions = batch_actions(env_id, round(1000 * duration) + 200, 3)
    if action_mode == "torque":
        actions[:, 2] = ours.single_action_space.high
    ends = np.zeros((2, 3), dtype=int)
    for seed, length in ((0, len(actions)), (None, 50)):
        assert same(ours.reset(seed=seed), theirs.reset(seed=seed))
        for action in actions[:length]:
            step = ours.step(action)
            assert same(step, theirs.step(action))
            ends += step[2:4]
    terminated, truncated = ends
    assert truncated[:2].all()
    assert bool(terminated[2]) == (action_mode == "torque")
    theirs.close()


@every_env
def test_batch_and_neighbours_do_not_matter(env_id):
    """Environment i of one, three and eight, to the bit, among neighbours with other seeds and other actions."""
    runs = {}
    actions = batch_actions(env_id, 200, 8)
    for num_envs in (1, 3, 8):
        for i in (0, num_envs - 1):
            seeds = [100 + k for k in range(num_envs)]
            seeds[i] = 42
            mine = actions[:, :num_envs].copy()
            mine[:, i] = random_actions(env_id, 200, 99)
            env = gym.make_vec(env_id, num_envs=num_envs, variant="randomized", duration=0.12)
            env.reset(seed=seeds)
            story = [
                (*(part[i] for part in step[:4]), {k: v[i] for k, v in step[4].items()}) for step in run(env, mine)
            ]
            runs[num_envs, i] = story
    for story in runs.values():
        assert same(story, runs[1, 0])


@every_env
def test_seed_of_a_batch_counts_upwards(env_id):
    env = gym.make_vec(env_id, num_envs=3, variant="randomized")
    obs, info = env.reset(seed=11)
    for i in range(3):
        alone = single(env_id)
        assert same(alone.reset(seed=11 + i), (obs[i], {k: v[i] for k, v in info.items() if not k.startswith("_")}))
    assert same(env.reset(seed=[11, 12, 13])[0], obs)
    with pytest.raises(ValueError, match=r"seed has 2 values; .* one for each of 3"):
        env.reset(seed=[1, 2])
    with pytest.raises(gym.error.ResetNeeded, match="before the first reset"):
        gym.make_vec(env_id, num_envs=3).step(env.action_space.high)


def middles(env_id):
    """A single and a batched environment in the middle of things, and the actions that follow."""
    env = single(env_id, duration=0.25)
    env.reset(seed=1)
    run(env, random_actions(env_id, 100, 0))
    yield env, random_actions(env_id, 100, 1)
    batch = gym.make_vec(env_id, num_envs=3, variant="randomized", duration=0.1)
    batch.reset(seed=1)
    run(batch, batch_actions(env_id, 100, 3))  # the next step resets all three
    yield batch, batch_actions(env_id, 150, 3)


@every_env
@duplicates
def test_copies_continue(env_id, duplicate):
    for env, actions in middles(env_id):
        twin = duplicate(env)
        expected = [run(env, actions), env.reset(), run(env, actions)]
        assert same([run(twin, actions), twin.reset(), run(twin, actions)], expected)


@every_env
def test_saved_states_continue(env_id):
    """In the same environment and in a fresh one, with bristles, pending resets and random generators."""
    for env, actions in middles(env_id):
        assert (env.simulation.plant.z != 0.0).all()
        state = env.get_state()
        twin = pickle.loads(pickle.dumps(env))
        twin.reset(seed=1234)
        expected = [run(env, actions), env.reset(), run(env, actions)]
        for each in (env, twin):
            each.set_state(state)
            assert same([run(each, actions), each.reset(), run(each, actions)], expected)


@every_env
def test_saved_state_goes_into_a_fresh_environment(env_id):
    env, fresh = single(env_id), single(env_id)
    env.reset(seed=1)
    actions = random_actions(env_id, 50, 0)
    run(env, actions)
    fresh.set_state(env.get_state())
    assert same(run(fresh, actions), run(env, actions))
    assert same(fresh.reset(), env.reset())


@every_env
def test_no_global_random_state(env_id):
    np.random.random(), random.random()  # away from where a hidden seed(0) may have left them  # noqa: NPY002
    before = np.random.get_state(), random.getstate()  # noqa: NPY002
    batch = gym.make_vec(env_id, num_envs=2, variant="randomized", duration=0.02)
    for env, actions in ((single(env_id), random_actions(env_id, 50, 0)), (batch, batch_actions(env_id, 50, 2))):
        for seed in (None, 0):
            env.reset(seed=seed)
            run(env, actions)
    assert same(list(before), [np.random.get_state(), random.getstate()])  # noqa: NPY002


@every_env
def test_gymnasiums_vector_wrappers(env_id):
    """Statistics of an episode are its sum of rewards and its length, whatever is wrapped around it."""
    env = gym.make_vec(env_id, num_envs=3, variant="randomized", duration=0.05)
    env = DictInfoToList(NormalizeObservation(RecordEpisodeStatistics(env)))
    _, infos = env.reset(seed=0)
    dof = env.unwrapped.simulation.dof
    assert [info["theta"].shape for info in infos] == [(dof,)] * 3
    total = np.zeros(3)
    for action in batch_actions(env_id, 50, 3):
        obs, reward, _, truncated, infos = env.step(action)
        total += reward
        assert np.isfinite(obs).all()
    assert truncated.all()
    np.testing.assert_allclose([info["episode"]["r"] for info in infos], total, rtol=1e-6)  # it sums in float32
    assert [int(info["episode"]["l"]) for info in infos] == [50] * 3
    env.close()


def test_a_push_next_door_leaves_no_trace():
    """Not even in the sign of a zero: nobody else's external torque turns -0.0."""
    vector = gym.make_vec("FJRStiction-v0", num_envs=8, variant="randomized")
    vector.reset(seed=0)
    simulation = vector.simulation
    pushes = [scenario.push for scenario in simulation.scenarios]
    start = min(push.time for push in pushes)
    assert any(push.torque[0] < 0.0 and push.time > start + 0.2 for push in pushes)
    simulation.ticks[:] = round((start + 0.1) / 1e-3)
    tau_ext = vector.step(np.zeros((8, 1)))[4]["tau_ext"]
    active = np.array([push.time < start + 0.1 for push in pushes])
    assert active.any()
    assert not np.signbit(tau_ext[~active]).any()
