"""The agent's view of the environments, single and batched, and its policies as compensators."""

from __future__ import annotations

import copy
import pickle
from functools import partial

import gymnasium as gym
import numpy as np
import pytest
from environments import IDS, SQUARE_ID, every_env, told_by
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env as check_sb3_env

import fo_gym
from fo_gym.sb3 import make_vec_env
from fo_gym.scaling import FRICTION_SHARE, LARGEST, POSITION_GAIN, ROWS, VELOCITY_GAIN
from fo_gym.wrappers import AgentCompensator, AgentView, vector

STICTION_ID, ARM_ID = IDS[0], IDS[1]
KWARGS = {"variant": "randomized", "decimation": 10, "duration": 0.3}  # an episode of 30 steps
IS_A_WRAPPER = "is different from the unwrapped version"


def view_of(env_id=STICTION_ID, stack=1, action_share=None, **settings):
    return AgentView(gym.make(env_id, **{**KWARGS, **settings}), stack, action_share)


def views_of(num_envs, env_id=STICTION_ID, stack=1, mode=AutoresetMode.NEXT_STEP, **settings):
    envs = gym.make_vec(env_id, num_envs=num_envs, autoreset_mode=mode, **{**KWARGS, **settings})
    return vector.AgentView(envs, stack)


@every_env
@pytest.mark.parametrize("action_mode", ["compensation", "torque"])
@pytest.mark.parametrize("variant", ["nominal", "hardware"])
def test_checkers_have_nothing_to_say(env_id, action_mode, variant):
    """But for Gymnasium's one, that a wrapper is a wrapper."""
    env = view_of(env_id, stack=2, action_mode=action_mode, variant=variant)
    (only,) = told_by(check_env, env)
    assert IS_A_WRAPPER in only
    assert told_by(check_sb3_env, env) == set()


@every_env
def test_the_blocks_are_the_documented_ones(env_id):
    env = view_of(env_id, feedback="nominal")
    env.reset(seed=1)
    for _ in range(5):
        obs, *_ = env.step(np.full(env.action_space.shape, 0.3, dtype=np.float32))
    joints, signals = env.unwrapped.joint_info, env.signals
    s = FRICTION_SHARE * joints.torque_limit
    lever = joints.motor_inertia * VELOCITY_GAIN * POSITION_GAIN / s
    expected = {
        "distance": np.arcsinh(lever * (signals.theta - signals.theta_d)),
        "velocity": np.arcsinh(joints.motor_inertia * VELOCITY_GAIN * signals.theta_dot / s),
        "lag": np.arcsinh(lever * (signals.theta_n - signals.theta)),
        "rate": np.arcsinh(joints.motor_inertia * VELOCITY_GAIN * (signals.theta_n_dot - signals.theta_dot) / s),
        "drive": np.arcsinh((signals.tau_c - signals.tau_j) / s),
        "tau_c": np.arcsinh(signals.tau_c / s),
        "tau_m": np.arcsinh(signals.tau_m / s),
        "theta_d": signals.theta_d,
    }
    assert tuple(expected) == ROWS
    assert all(f"| {name} | " in (AgentView.__doc__ or "") for name in ROWS)
    rest = [np.arcsinh(signals.time), signals.reference]
    np.testing.assert_allclose(obs, np.concatenate([*expected.values(), *rest]), rtol=2e-6, atol=1e-6)
    assert obs in env.observation_space


def test_the_true_observation_stays_within_reach():
    env, plain = view_of(ARM_ID), gym.make(ARM_ID, **KWARGS)
    env.reset(seed=2)
    first, _ = plain.reset(seed=2)
    np.testing.assert_array_equal(env.signals.observation(), first)


@pytest.mark.parametrize(("mode", "share"), [("compensation", 0.3), ("torque", 1.0)])
def test_what_actions_mean(mode, share):
    env = view_of(ARM_ID, action_mode=mode)
    limit = env.unwrapped.action_space.high
    np.testing.assert_array_equal(env.action_scale, share * limit)
    applied = "tau_m" if mode == "torque" else "tau_f_hat"
    for action, meant in ((0.1, 0.1), (7.0, 1.0)):
        env.reset(seed=0)
        *_, info = env.step(np.full(7, action, dtype=np.float32))
        np.testing.assert_allclose(info[applied], meant * share * limit, rtol=1e-6)


def test_what_cannot_be_is_refused():
    with pytest.raises(TypeError, match="takes environments of fo_gym"):
        AgentView(gym.make("CartPole-v1"))
    with pytest.raises(TypeError, match=r"fo_gym\.wrappers\.vector"):
        AgentView(gym.make_vec(STICTION_ID, num_envs=2))
    with pytest.raises(TypeError, match="num_envs=8"):
        vector.AgentView(gym.make(STICTION_ID))
    with pytest.raises(ValueError, match="stack is 0"):
        view_of(stack=0)
    with pytest.raises(ValueError, match="give at most 1"):
        view_of(action_share=1.5)
    with pytest.raises(ValueError, match="action_share is 0"):
        view_of(action_share=0)
    with pytest.raises(ValueError, match="give at most 1"):
        AgentCompensator(Wave(), period=0.01, action_share=7.0)
    env = view_of(ARM_ID)
    env.reset(seed=0)
    with pytest.raises(ValueError, match="action has shape"):
        env.step(np.float32(0.5))
    for value in (np.nan, np.inf):
        with pytest.raises(ValueError, match="every value must be finite"):
            env.step(np.full(7, value))


def test_a_signal_that_is_not_there_is_zero():
    env = view_of(sensors="motor")
    obs, _ = env.reset(seed=0)
    for _ in range(20):
        obs, *_ = env.step(env.action_space.high)
    blocks = dict(zip(ROWS, obs, strict=False))
    assert [blocks[name] for name in ("lag", "rate", "drive")] == [0.0, 0.0, 0.0]
    assert all(blocks[name] != 0.0 for name in ("distance", "velocity", "tau_c", "tau_m"))


def test_what_is_far_away_is_clipped():
    env = view_of(ARM_ID, action_mode="torque", duration=30.0)
    env.reset(seed=0)
    seen, ended = 0.0, False
    while not ended:
        obs, _, terminated, truncated, _ = env.step(np.ones(7, dtype=np.float32))
        seen, ended = max(seen, float(np.abs(obs).max())), terminated or truncated
        assert obs in env.observation_space
    assert seen <= LARGEST


@pytest.mark.parametrize("stack", [1, 3])
def test_a_stack_is_the_last_observations_and_begins_anew(stack):
    env, plain = view_of(stack=stack), view_of()
    rng = np.random.default_rng(0)
    for seed in (3, None):
        first = plain.reset(seed=seed)[0]
        frames = [first] * stack
        np.testing.assert_array_equal(env.reset(seed=seed)[0], np.concatenate(frames))
        for _ in range(5):
            action = rng.uniform(-1.0, 1.0, 1).astype(np.float32)
            frames = [*frames[1:], plain.step(action)[0]]
            np.testing.assert_array_equal(env.step(action)[0], np.concatenate(frames))


@every_env
@pytest.mark.parametrize("action_mode", ["compensation", "torque"])
def test_a_batch_is_its_environments(env_id, action_mode):
    """Over two ends, at times of their own; autoreset NEXT_STEP: the step after an end is the reset."""
    batch = views_of(2, env_id, stack=2, action_mode=action_mode)
    singles = [view_of(env_id, stack=2, action_mode=action_mode) for _ in range(2)]
    rng = np.random.default_rng(1)
    obs, _ = batch.reset(seed=7)
    ended = [False, False]
    for i, env in enumerate(singles):
        np.testing.assert_array_equal(obs[i], env.reset(seed=7 + i)[0])
    for _ in range(65):
        actions = rng.uniform(-1.0, 1.0, batch.action_space.shape).astype(np.float32)
        actions[ended] = np.nan  # which is ignored
        obs, reward, terminated, truncated, _ = batch.step(actions)
        for i, env in enumerate(singles):
            alone = env.reset()[0] if ended[i] else env.step(actions[i])
            if ended[i]:
                np.testing.assert_array_equal(obs[i], alone)
                ended[i] = False
            else:
                np.testing.assert_array_equal(obs[i], alone[0])
                assert (reward[i], terminated[i], truncated[i]) == alone[1:4]
                ended[i] = bool(terminated[i] or truncated[i])
    assert obs.dtype == np.float32
    assert obs in batch.observation_space


def test_a_reset_of_some_leaves_the_others_alone():
    batch = views_of(3, stack=3, mode=AutoresetMode.DISABLED)
    batch.reset(seed=0)
    for _ in range(4):
        obs, *_ = batch.step(np.full((3, 1), 0.5, dtype=np.float32))
    kept = obs.copy()
    again, _ = batch.reset(options={"reset_mask": np.array([False, True, False])})
    np.testing.assert_array_equal(again[[0, 2]], kept[[0, 2]])
    np.testing.assert_array_equal(obs, kept)  # what was given is the user's
    np.testing.assert_array_equal(*np.split(again[1], 3)[:2])
    assert (again[1] != kept[1]).any()


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_copies_go_on_as_the_original(copied):
    for env in (view_of(ARM_ID, stack=2), views_of(2, ARM_ID, stack=2)):
        env.reset(seed=0)
        action = np.full(env.action_space.shape, 0.2, dtype=np.float32)
        env.step(action)
        other = copied(env)
        for _ in range(3):
            np.testing.assert_array_equal(env.step(action)[0], other.step(action)[0])


def test_the_spec_makes_it_again():
    env = view_of(stack=3, action_share=0.5)
    again = env.spec.make()
    assert isinstance(again, AgentView)
    np.testing.assert_array_equal(env.reset(seed=0)[0], again.reset(seed=0)[0])
    np.testing.assert_array_equal(env.action_scale, again.action_scale)


@pytest.mark.usefixtures("one_torch_thread")
def test_sb3_learns_on_the_batch():
    venv = make_vec_env(STICTION_ID, 4, seed=0, wrapper=partial(vector.AgentView, stack=2), **KWARGS)
    assert venv.env_is_wrapped(vector.AgentView) == [True] * 4
    assert venv.get_attr("action_scale", indices=0)[0].tolist() == [3.0]
    model = PPO("MlpPolicy", venv, n_steps=32, batch_size=64, seed=0)
    model.learn(256)
    assert all(value.isfinite().all() for value in model.policy.state_dict().values())


class Wave:
    """A policy that needs every input: bounded, of all the stack."""

    def __init__(self, amplitude=1.0):
        self.amplitude = amplitude

    def predict(self, observation, state=None, episode_start=None, deterministic=False):
        assert deterministic
        assert episode_start.all() == (state is None)
        count = 0 if state is None else state
        wave = np.tanh(0.3 * observation.sum(axis=-1, keepdims=True) + 0.1 * count)
        return self.amplitude * wave, count + 1


@pytest.mark.parametrize("action_mode", ["compensation", "torque"])
@pytest.mark.parametrize("feedback", ["measured", "nominal"])
def test_a_policy_is_the_same_as_agent_and_as_compensator(action_mode, feedback):
    """At 100 Hz in its own environment, and as a compensator at every tick of 1 kHz: the same torques and motion."""
    env = view_of(stack=2, action_mode=action_mode, feedback=feedback)
    obs, _ = env.reset(seed=5)
    # A torque that is far from the controller's would be clipped as an estimate.
    amplitude = 0.1 if action_mode == "torque" else 1.0
    policy, state, path = Wave(amplitude), None, []
    for _ in range(30):
        action, state = policy.predict(obs[None], state, np.array([state is None]), deterministic=True)
        obs, *_, info = env.step(action[0])
        path.append([info["theta"][0], info["tau_m"][0]])
    plain = gym.make(STICTION_ID, **{**KWARGS, "decimation": 1, "feedback": feedback})
    compensator = AgentCompensator(Wave(amplitude), 0.01, action_mode=action_mode, feedback=feedback, stack=2)
    obs, _ = plain.reset(seed=5)
    compensator.reset(plain.unwrapped.joint_info, 1)
    means, torques = [], []
    for _ in range(300):
        signals = fo_gym.Signals.from_observation(obs[None], 1, plain.unwrapped.available)
        obs, *_, info = plain.step(compensator.estimate(signals)[0])
        torques.append(info["tau_m"][0])
        if len(torques) % 10 == 0:
            means.append([info["theta"][0], np.mean(torques[-10:])])
    np.testing.assert_allclose(means, path, rtol=1e-4, atol=1e-7)


def test_a_policy_is_scored_beside_the_others():
    rows = fo_gym.evaluate(AgentCompensator(Wave(), 0.01), STICTION_ID, variant="randomized", seeds=2, duration=1.0)
    assert rows["status"].tolist() == ["ok", "ok"]
    assert np.isfinite(rows["frr"]).all()
    assert rows["learned"].all()


def test_the_rate_of_a_policy_must_fit():
    with pytest.raises(fo_gym.CompensatorError, match="which does not suit control_dt"):
        fo_gym.evaluate(AgentCompensator(Wave(), 0.0105), SQUARE_ID, duration=0.1)
