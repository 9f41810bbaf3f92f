"""Stable-Baselines3 on the environments: the adapter over a batch, and single environments."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest
from environments import IDS, every_env
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import ClipReward, RescaleAction, RescaleObservation
from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env as make_dummy_vec_env
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import DummyVecEnv, VecCheckNan, VecMonitor, VecNormalize

from fo_gym.sb3 import VecEnvAdapter, make_vec_env
from fo_gym.wrappers.vector import AgentView

pytestmark = pytest.mark.usefixtures("one_torch_thread")
STICTION_ID = IDS[0]
# An episode of 30 steps, in which the randomized push cannot fall.
KWARGS = {"variant": "randomized", "decimation": 2, "duration": 0.06}


def dummy(env_id: str, num_envs: int) -> DummyVecEnv:
    """SB3's own vector of the same environments."""
    return DummyVecEnv([lambda: gym.make(env_id, **KWARGS) for _ in range(num_envs)])


@every_env
def test_it_does_what_sb3s_own_vector_does(env_id):
    """Observations, rewards, ends, terminal observations and time limits, over three episodes, to the bit."""
    ours, theirs = make_vec_env(env_id, 3, **KWARGS), dummy(env_id, 3)
    for venv in (ours, theirs):
        venv.seed(7)
    np.testing.assert_array_equal(ours.reset(), theirs.reset())
    rng = np.random.default_rng(0)
    ends = 0
    for _ in range(100):
        actions = rng.uniform(-1.0, 1.0, (3, *ours.action_space.shape)).astype(np.float32)
        results = [venv.step(actions.copy()) for venv in (ours, theirs)]
        for mine, reference in zip(results[0][:3], results[1][:3], strict=True):
            np.testing.assert_array_equal(mine, reference)
            assert mine.dtype == reference.dtype
        for mine, reference in zip(results[0][3], results[1][3], strict=True):
            assert mine.get("TimeLimit.truncated", False) == reference["TimeLimit.truncated"]
            assert ("terminal_observation" in mine) == ("terminal_observation" in reference)
            if "terminal_observation" in mine:
                ends += 1
                np.testing.assert_array_equal(mine["terminal_observation"], reference["terminal_observation"])
    assert ends == 9


def test_an_environment_that_ends_itself_is_no_time_limit():
    venv = make_vec_env(STICTION_ID, 2, seed=0, duration=5.0, action_mode="torque")
    venv.reset()
    flung = np.array([[10.0], [0.0]])
    for _ in range(5000):
        obs, _, dones, infos = venv.step(flung)
        if dones.any():
            break
    assert dones.tolist() == [True, False]
    assert infos[0]["termination"] == "joint_limit"
    assert infos[0]["TimeLimit.truncated"] is False
    assert infos[1] == {}
    assert np.abs(infos[0]["terminal_observation"][0]) > 0.1
    assert obs[0, 0] == 0.0


def test_it_needs_environments_that_leave_the_reset_to_it():
    with pytest.raises(ValueError, match="DISABLED"):
        VecEnvAdapter(gym.make_vec(STICTION_ID, num_envs=2))


def test_seeds_and_options_reach_the_environments():
    venv = make_vec_env(STICTION_ID, 2, seed=3)
    venv.set_options({"target": [0.02]})
    obs = venv.reset()
    alone = gym.make(STICTION_ID)
    for i in range(2):
        np.testing.assert_array_equal(obs[i], alone.reset(seed=3 + i, options={"target": [0.02]})[0])
    venv.set_options([{"target": np.array([0.02, 0.0])[:1]}, {"target": np.array([0.02])}])
    np.testing.assert_array_equal(venv.reset()[0, 5], 0.02)
    venv.set_options([{"target": [0.02]}, {}])
    with pytest.raises(ValueError, match="options differ"):
        venv.reset()


def test_attributes_and_methods_are_the_batchs():
    venv = make_vec_env(STICTION_ID, 3, seed=0)
    venv.reset()
    assert venv.get_attr("num_envs") == [3, 3, 3]
    assert venv.get_attr("num_envs", indices=1) == [3]
    assert len(venv.env_method("get_state", indices=[0, 2])) == 2
    wrapped = make_vec_env(STICTION_ID, 2, seed=0, wrapper=AgentView)
    wrapped.reset()
    assert len(wrapped.env_method("get_state")) == len(wrapped.get_attr("joint_info")) == 2
    assert venv.env_is_wrapped(gym.Wrapper) == [False] * 3
    venv.set_attr("note", 1)
    assert venv.env.unwrapped.note == 1
    with pytest.raises(ValueError, match="whole batch"):
        venv.set_attr("note", 2, indices=[0])
    venv.close()


def test_gymnasium_wrappers_under_it():
    env = gym.make_vec(STICTION_ID, num_envs=2, autoreset_mode=AutoresetMode.DISABLED, **KWARGS)
    venv = VecEnvAdapter(ClipReward(RescaleAction(env, -1.0, 1.0), max_reward=0.5))
    assert venv.action_space.high == 1.0
    assert venv.env_is_wrapped(ClipReward, indices=0) == [True]
    venv.seed(0)
    venv.reset()
    assert venv.step(np.zeros((2, 1)))[1].max() <= 0.5


def test_sb3_wrappers_over_it_and_training():
    venv = VecNormalize(VecMonitor(VecCheckNan(make_vec_env(STICTION_ID, 4, seed=0, **KWARGS), raise_exception=True)))
    model = PPO("MlpPolicy", venv, n_steps=32, batch_size=64, seed=0)
    before = {name: value.clone() for name, value in model.policy.state_dict().items()}
    model.learn(256)
    assert any((value != before[name]).any() for name, value in model.policy.state_dict().items())
    mean, _ = evaluate_policy(model, venv, n_eval_episodes=4)
    assert np.isfinite(mean)
    assert len(model.ep_info_buffer) == 8
    assert {info["l"] for info in model.ep_info_buffer} == {30}


@every_env
def test_plain_sb3_on_a_single_environment(env_id):
    venv = make_dummy_vec_env(env_id, n_envs=1, seed=0, env_kwargs=KWARGS)
    model = PPO("MlpPolicy", venv, n_steps=32, batch_size=32, n_epochs=1, seed=0)
    before = {name: value.clone() for name, value in model.policy.state_dict().items()}
    model.learn(32)
    after = model.policy.state_dict()
    assert any((value != before[name]).any() for name, value in after.items())
    assert all(value.isfinite().all() for value in after.values())


def test_pictures():
    venv = make_vec_env(STICTION_ID, 2, seed=0, render_mode="rgb_array", **KWARGS)
    venv.reset()
    images = venv.get_images()
    assert len(images) == 2
    assert venv.render().size == images[0].size + images[1].size
    venv.close()


class TestResetMask:
    """The autoreset mode DISABLED of the batch."""

    def test_only_the_masked_environments_begin_again(self):
        env = gym.make_vec(STICTION_ID, num_envs=3, autoreset_mode=AutoresetMode.DISABLED, **KWARGS)
        obs, _ = env.reset(seed=5)
        first = obs[1].copy()
        for _ in range(4):
            obs, *_ = env.step(np.full((3, 1), 0.5))
        again, info = env.reset(seed=5, options={"reset_mask": np.array([False, True, False])})
        np.testing.assert_array_equal(again[[0, 2]], obs[[0, 2]])
        np.testing.assert_array_equal(again[1], first)
        assert info["theta"].shape == (3, 1)

    def test_a_seed_is_for_the_masked_environments_alone(self):
        def second_episode(**arguments):
            env = gym.make_vec(STICTION_ID, num_envs=2, autoreset_mode=AutoresetMode.DISABLED, variant="randomized")
            env.reset(seed=[1, 2])
            env.reset(options={"reset_mask": np.array([True, False])}, **arguments)
            return env.reset()[0]

        without, seeded = second_episode(), second_episode(seed=5)
        np.testing.assert_array_equal(seeded[1], without[1])
        assert not np.array_equal(seeded[0], without[0])

    def test_what_has_ended_must_be_reset(self):
        env = gym.make_vec(STICTION_ID, num_envs=2, autoreset_mode=AutoresetMode.DISABLED, duration=0.002)
        env.reset(seed=0)
        truncated = np.zeros(2, dtype=bool)
        while not truncated.any():
            _, _, _, truncated, _ = env.step(np.zeros((2, 1)))
        with pytest.raises(gym.error.ResetNeeded, match="have ended"):
            env.step(np.zeros((2, 1)))
        env.reset(options={"reset_mask": truncated})
        env.step(np.zeros((2, 1)))

    @pytest.mark.parametrize("mask", [[True, False], np.array([True]), np.array([1, 0])])
    def test_a_mask_of_another_kind(self, mask):
        env = gym.make_vec(STICTION_ID, num_envs=2, autoreset_mode=AutoresetMode.DISABLED)
        env.reset(seed=0)
        with pytest.raises(ValueError, match="NumPy array of 2 bools"):
            env.reset(options={"reset_mask": mask})

    def test_the_first_reset_is_of_all(self):
        env = gym.make_vec(STICTION_ID, num_envs=2, autoreset_mode=AutoresetMode.DISABLED)
        with pytest.raises(gym.error.ResetNeeded, match="first reset"):
            env.reset(options={"reset_mask": np.array([True, False])})

    def test_the_third_mode_is_refused(self):
        with pytest.raises(ValueError, match="NEXT_STEP and DISABLED"):
            gym.make_vec(STICTION_ID, num_envs=2, autoreset_mode=AutoresetMode.SAME_STEP)

    def test_observation_wrappers_of_gymnasium(self):
        env = gym.make_vec(STICTION_ID, num_envs=2, autoreset_mode=AutoresetMode.DISABLED, **KWARGS)
        with pytest.raises((ValueError, AssertionError)):  # the observation has no bounds to rescale from
            RescaleObservation(env, -1.0, 1.0)
