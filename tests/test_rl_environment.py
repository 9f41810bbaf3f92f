"""The environment that policies are trained in: its reward, its episodes, and who is reset with whom."""

from __future__ import annotations

from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest

import fo_gym
from baselines import PIDObserver
from baselines.rl import Design
from baselines.rl.course import COURSES, course_of
from baselines.rl.environment import TrainingEnv
from fo_gym.sb3 import VecEnvAdapter

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"


class TestEnvironment:
    def test_the_reward_is_its_formula(self):
        """Without action: the observer alone on the robot and its twin, run here by hand."""
        design = Design()
        env = TrainingEnv(STICTION, 2, design)
        env.reset(seed=11)
        course = COURSES[STICTION]
        arguments = {
            "num_envs": 2,
            "variant": "randomized",
            "randomization": course.randomization,
            "physics_dt": "auto",
        }
        robots = gym.make_vec(STICTION, feedback="nominal", **arguments)
        twins = gym.make_vec(STICTION, disturbed=False, **arguments)
        obs, _ = robots.reset(seed=11)
        twins.reset(seed=11)
        observer = PIDObserver(design.L, design.Lp, design.Li)
        observer.reset(robots.unwrapped.joint_info, 2)
        for step in range(200):
            _, reward, *_ = env.step(np.zeros((2, 1)))
            costs = []
            for _ in range(2):
                obs, _, _, _, true = robots.step(observer.estimate(fo_gym.Signals.from_observation(obs, 1)))
                *_, ideal = twins.step(np.zeros((2, 1)))
                signals = fo_gym.Signals.from_observation(obs, 1)
                d = np.hypot(true["theta"] - ideal["theta"], 0.1 * (true["theta_dot"] - ideal["theta_dot"]))
                e = np.abs(signals.theta_n - signals.theta)
                costs.append((np.log1p(d / 1e-4) + np.log1p(e / 1e-4)) / 2)
            if step < 5 or step % 50 == 0:
                np.testing.assert_allclose(reward, -np.mean(costs, axis=0)[:, 0], rtol=1e-6)

    def test_a_change_of_action_costs(self):
        rewards = []
        for action in (0.0, 1.0):
            env = TrainingEnv(STICTION, 1, replace(Design(), bound=1e-9))
            env.reset(seed=1)
            rewards.append(env.step(np.full((1, 1), action))[1][0])
        assert rewards[0] - rewards[1] == pytest.approx(0.05, rel=1e-6)

    @pytest.mark.slow
    def test_episodes_do_not_run_in_step(self):
        """First episodes are cut at random lengths, later ones are whole; the observation after a reset is one."""
        env = TrainingEnv(STICTION, 16, Design())
        venv = VecEnvAdapter(env)
        venv.seed(0)
        venv.reset()
        length = round(COURSES[STICTION].duration / Design().period)
        ends = np.zeros((2 * length, 16), dtype=bool)
        for step in range(2 * length):
            obs, _, ends[step], infos = venv.step(np.zeros((16, 1)))
            for i in np.flatnonzero(ends[step]):
                assert infos[i]["TimeLimit.truncated"]
                assert infos[i]["terminal_observation"].shape == (9,)
                assert obs[i, -1] == 0.0
                assert obs[i, :3].tolist() == [0.0, 0.0, 0.0]
        first = ends.argmax(axis=0)
        assert len(set(first)) > 12
        for i in range(16):
            assert set(np.diff(np.flatnonzero(ends[:, i]))) <= {length}

    def test_who_leaves_the_range_pays(self):
        env = TrainingEnv(REGULATION, 2, Design(residual=False, bound=50.0, floor=1.0))
        env.reset(seed=0)
        for _ in range(2000):
            _, reward, terminated, _, _ = env.step(np.ones((14, 1)))
            if terminated.any():
                break
        robot = terminated.reshape(2, 7)
        assert (robot.all(axis=1) == robot.any(axis=1)).all()
        assert (reward[terminated] < -20).all()
        _, _, terminated, _, _ = env.step(np.ones((14, 1)))  # still reported: nobody has reset it yet
        assert terminated.any()
        obs, _ = env.reset(options={"reset_mask": terminated})
        assert not obs[terminated][:, :3].any()

    def test_where_the_twin_leaves_the_range_the_episode_is_terminated_and_nobody_pays(self, monkeypatch):
        """A cut would be bootstrapped from the observation, which is of the next episode."""
        env = TrainingEnv(REGULATION, 2, Design())
        env.reset(seed=0)
        step, gone = env._twins.step, np.array([False, True])

        def leave(actions):
            obs, reward, _, truncated, info = step(actions)
            return obs, reward, gone, truncated, info

        monkeypatch.setattr(env._twins, "step", leave)
        _, reward, terminated, truncated, _ = env.step(np.zeros((14, 1)))
        assert terminated.tolist() == [False] * 7 + [True] * 7
        assert not truncated.any()
        assert (reward > -20.0).all()
        monkeypatch.undo()
        env.reset(options={"reset_mask": terminated})
        assert not env.step(np.zeros((14, 1)))[2].any()

    def test_without_a_seed_the_generators_go_on(self):
        """After a seed to the same episodes every time; where there never was one to any, the twins' the same."""
        env = TrainingEnv(STICTION, 8, Design())
        unseeded = env.reset()[0]
        joints, twins = (batch.unwrapped.joint_info for batch in (env._robots, env._twins))
        np.testing.assert_array_equal(joints.motor_inertia, twins.motor_inertia)
        drawn = [(env.reset(seed=seed)[0], env._left) for seed in (3, None, 3, None, 0)]
        np.testing.assert_equal(drawn[:2], drawn[2:4])
        for seeded in (drawn[0], drawn[4]):
            assert all((one != other).any() for one, other in zip(drawn[1], seeded, strict=True))
        assert all((unseeded != first).any() for first, _ in drawn)

    def test_joints_of_one_robot_are_reset_together(self):
        env = TrainingEnv(REGULATION, 2, Design())
        env.reset(seed=0)
        mask = np.zeros(14, dtype=bool)
        mask[3] = True
        with pytest.raises(ValueError, match="joints of one robot"):
            env.reset(options={"reset_mask": mask})

    def test_an_environment_without_a_course(self):
        with pytest.raises(ValueError, match=r"no training course for 'CartPole-v1'; there is one for FJRStiction-v0"):
            course_of("CartPole-v1")


def test_every_course_is_followed_by_its_step() -> None:
    """The most extreme joints that a course may draw, in many episodes: none is refused for a step that is too long."""
    for env_id in COURSES:
        observation, _ = TrainingEnv(env_id, 64, Design()).reset(seed=0)
        assert np.isfinite(observation).all()
