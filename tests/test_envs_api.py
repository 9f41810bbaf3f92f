"""Every registered environment, against what Gymnasium, Stable-Baselines3 and its own docstring promise."""

from __future__ import annotations

import inspect
import itertools
import re
from dataclasses import fields, replace

import gymnasium as gym
import numpy as np
import pytest
from environments import GYMNASIUM_TOLERATED, TOOL_IDS, drive, every_env, make, told_by
from gymnasium.utils.env_checker import check_env
from stable_baselines3.common.env_checker import check_env as check_sb3_env

import fo_gym

ORDER = ("theta", "theta_dot", "tau_j", "theta_n", "theta_n_dot", "theta_d", "tau_c", "tau_m")

# Deliberate: actions are torques in physical units, observations are in physical units and unbounded, all in float64.
SB3_TOLERATED = {
    "We recommend you to use a symmetric and normalized Box action space (range=[-1, 1]) "
    "cf. https://stable-baselines3.readthedocs.io/en/master/guide/rl_tips.html",
    "Your action space has dtype float64, we recommend using np.float32 to avoid cast errors.",
}


@every_env
@pytest.mark.parametrize("action_mode", ["compensation", "torque"])
@pytest.mark.parametrize("variant", ["nominal", "randomized", "hardware"])
def test_checkers(env_id, action_mode, variant):
    env = make(env_id, action_mode=action_mode, variant=variant, duration=0.01)
    for checker, tolerated in ((check_env, GYMNASIUM_TOLERATED), (check_sb3_env, SB3_TOLERATED)):
        assert told_by(checker, env) <= tolerated


@every_env
def test_signals_are_views_in_the_documented_order(env_id):
    env = make(env_id)
    dof, size = env.simulation.dof, env.observation_space.shape[0]
    batch = np.arange(2.0 * 3.0 * size).reshape(2, 3, size)
    for obs in (batch, batch[0, 0]):
        signals = fo_gym.Signals.from_observation(obs, dof)
        for i, name in enumerate(ORDER):
            np.testing.assert_array_equal(getattr(signals, name), obs[..., i * dof : (i + 1) * dof])
            assert np.shares_memory(getattr(signals, name), obs)
        np.testing.assert_array_equal(signals.time, obs[..., 8 * dof : 8 * dof + 1])
        np.testing.assert_array_equal(signals.reference, obs[..., 8 * dof + 1 :])
        assert signals.reference.shape[-1] == (3 if env_id in TOOL_IDS else 0)
        assert signals.available == set(ORDER)
    with pytest.raises(ValueError, match=f"{8 * dof} values.*at least {8 * dof + 1}"):
        fo_gym.Signals.from_observation(batch[..., : 8 * dof], dof)


@every_env
@pytest.mark.parametrize("feedback", ["measured", "nominal"])
def test_observation_is_what_the_joint_measures(env_id, feedback):
    """theta and its rate as they are, K_j (theta - q) exactly, and the tau_c that the coming step applies."""
    env = make(env_id, variant="randomized", feedback=feedback)
    stiffness, action = env.joint_info.stiffness, 0.1 * env.action_space.high
    obs, _, _, _, info = env.step(action)
    for _ in range(20):
        signals = fo_gym.Signals.from_observation(obs, env.simulation.dof)
        np.testing.assert_array_equal(signals.theta, info["theta"])
        np.testing.assert_array_equal(signals.theta_dot, info["theta_dot"])
        np.testing.assert_array_equal(signals.tau_j, stiffness * (info["theta"] - info["q"]))
        obs, _, _, _, info = env.step(action)
        np.testing.assert_array_equal(info["tau_m"], signals.tau_c - action)


@every_env
def test_neither_controller_nor_observation_sees_the_truth(env_id):
    """Other links and bristles behind the same motors: nothing but the torque sensor notices."""
    env = make(env_id)
    before = drive(env)[-1]
    state, generator = env.get_state()
    plant = replace(state.plant, q=state.plant.q + 1e-3, q_dot=state.plant.q_dot + 1.0, z=state.plant.z + 1e-5)
    env.set_state((replace(state, plant=plant), generator))
    after = env.simulation.observation()[0]
    tau_j = slice(2 * env.simulation.dof, 3 * env.simulation.dof)
    assert (after[tau_j] != before[tau_j]).all()
    np.testing.assert_array_equal(np.delete(after, tau_j), np.delete(before, tau_j))


@every_env
def test_actions_are_clipped_to_the_torque_limit(env_id):
    limit = make(env_id).joint_info.torque_limit
    for mode, sign in itertools.product(("compensation", "torque"), (1.0, -1.0)):
        env, clipped = make(env_id, action_mode=mode), make(env_id, action_mode=mode)
        np.testing.assert_array_equal(env.action_space.high, limit)
        np.testing.assert_array_equal(env.action_space.low, -limit)
        tau_c = fo_gym.Signals.from_observation(env.reset(seed=0)[0], len(limit)).tau_c
        obs, *_, info = env.step(7.0 * sign * limit)
        np.testing.assert_array_equal(obs, clipped.step(sign * limit)[0])
        np.testing.assert_array_equal(info["tau_m"], sign * limit if mode == "torque" else tau_c - sign * limit)
        np.testing.assert_array_equal(info["tau_f_hat"], 0.0 * limit if mode == "torque" else sign * limit)


@every_env
def test_observation_tells_the_time_and_what_the_motors_got(env_id):
    """At first what held the joints, tau_j; then tau_m's mean over the step, clipped and late as the motors take it."""
    dof = make(env_id).simulation.dof
    fast, slow = (make(env_id, variant="hardware", decimation=n) for n in (1, 5))
    obs, _ = fast.reset(seed=3)
    first = fo_gym.Signals.from_observation(obs, dof)
    np.testing.assert_array_equal(first.time, [0.0])
    np.testing.assert_array_equal(first.tau_m, fast.simulation.plant.tau_j[0])
    slow.reset(seed=3)
    beyond = -2.0 * fast.action_space.high  # more than the motors of the hardware variant give
    ticks = []
    for k in range(1, 6):
        obs, _, _, _, info = fast.step(beyond)
        signals = fo_gym.Signals.from_observation(obs, dof)
        np.testing.assert_array_equal(signals.tau_m, info["tau_m"])
        np.testing.assert_allclose(signals.time, [k * 1e-3], rtol=1e-15)
        ticks.append(signals.tau_m)
    assert np.all(ticks[-1] <= fast.action_space.high)
    signals = fo_gym.Signals.from_observation(slow.step(beyond)[0], dof)
    np.testing.assert_allclose(signals.tau_m, np.mean(ticks, axis=0), rtol=1e-13)
    np.testing.assert_allclose(signals.time, [5e-3], rtol=1e-15)


@every_env
def test_reward_is_what_the_docstring_says(env_id):
    """closeness * (1 - 0.1 roughness), under a held action that lets tau_c alone change tau_m, from tau_j on."""
    env = make(env_id, variant="randomized")
    obs, info = env.reset(seed=0)
    accuracy = {"FJRStiction-v0": 1e-3, **dict.fromkeys(TOOL_IDS, 2e-3)}.get(env_id, 5e-3)
    previous = obs[2 * env.simulation.dof : 3 * env.simulation.dof]
    for _ in range(5):
        obs, reward, _, _, info = env.step(0.1 * env.action_space.high)
        signals = fo_gym.Signals.from_observation(obs, env.simulation.dof)
        distance = np.sqrt(np.mean((signals.theta - signals.theta_d) ** 2))
        if env_id in TOOL_IDS:
            (tool,) = env.simulation.plant.body.links.tool_position(info["q"][None])
            distance = np.linalg.norm(tool - signals.reference)
        roughness = np.mean(np.abs(info["tau_m"] - previous) / env.action_space.high)
        assert reward == pytest.approx((1.0 - 0.1 * roughness) / (1.0 + distance / accuracy), rel=1e-12)
        previous = info["tau_m"]


@every_env
def test_ending_an_episode_never_pays(env_id):
    """Even the roughest commands, from one limit to the other, leave a reward above zero."""
    env = make(env_id, action_mode="torque")
    rewards = [env.step((-1.0) ** k * env.action_space.high)[1] for k in range(20)]
    assert min(rewards) > 0.0


@every_env
def test_decimation_does_not_stretch_time(env_id):
    """The same simulated time, and under held actions the same trajectory, to the bit."""
    assert gym.spec(env_id).max_episode_steps is None
    ends = []
    for decimation in (1, 5, 10):
        env = gym.make(env_id, decimation=decimation, duration=0.1)  # through the wrappers: none of them may truncate
        assert env.spec.max_episode_steps is None
        env.reset(seed=0)
        for step in itertools.count(1):
            held = np.sin((step - 1) * decimation // 10)  # changes every 10 ticks
            obs, _, terminated, truncated, info = env.step(0.1 * held * env.action_space.high)
            assert not terminated
            if truncated:
                break
        assert step * decimation == 100
        assert env.unwrapped.joint_info.control_dt == pytest.approx(1e-3 * decimation, rel=1e-12)
        full = gym.make(env_id, decimation=decimation).unwrapped.simulation
        assert full.last_tick * 1e-3 == pytest.approx(full.task.duration, rel=1e-12)
        dof = env.unwrapped.simulation.dof
        own = np.delete(obs, np.s_[7 * dof : 8 * dof])  # all but tau_m, which is the mean over a step
        ends.append(np.concatenate([own, info["z"]]))
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])
    vector = gym.make_vec(env_id, num_envs=2, decimation=10, duration=0.1)
    vector.reset(seed=0)
    flags = [vector.step(0.0 * vector.action_space.high)[3] for _ in range(11)]
    np.testing.assert_array_equal(flags, np.arange(11)[:, None] == np.array([9, 9]))


@every_env
def test_leaving_the_joint_range_terminates(env_id):
    """Environment 1 is driven out of its range; environment 0, under gentle actions, goes on."""
    env = gym.make_vec(env_id, num_envs=2, action_mode="torque")
    env.reset(seed=0)
    model = env.simulation.plant.body.model
    for _ in range(2000):
        actions = np.stack([0.01 * env.single_action_space.high, env.single_action_space.high])
        _, reward, terminated, truncated, info = env.step(actions)
        outside = ((info["q"] < model.jnt_range[:, 0]) | (info["q"] > model.jnt_range[:, 1])).any(axis=1)
        np.testing.assert_array_equal(terminated, outside)
        if terminated.any():
            break
        assert "termination" not in info
    np.testing.assert_array_equal(terminated, [False, True])
    assert not truncated.any()
    assert np.isfinite(reward).all()
    assert info["termination"].tolist() == [None, "joint_limit"]
    np.testing.assert_array_equal(info["_termination"], terminated)


@every_env
def test_leaving_the_finite_numbers_terminates(env_id):
    """What comes back is the last finite state."""
    joints = fo_gym.FlexibleJoint(3000.0, 0.0, 1.0, torque_limit=1e308)
    env = make(env_id, action_mode="torque", joints=joints)
    before = env.simulation.observation()[0]
    obs, reward, terminated, truncated, info = env.step(env.action_space.high)
    assert (terminated, truncated, info["termination"]) == (True, False, "non_finite")
    assert np.isfinite(reward)
    assert np.isfinite(obs).all()
    np.testing.assert_array_equal(obs[: 2 * len(info["theta"])], before[: 2 * len(info["theta"])])


def table(docstring, section):
    """Rows of the table under `## section`, as lists of cells, and how many numbers each row stands for."""
    part = docstring.split(f"## {section}\n")[1].split("\n## ")[0]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in part.splitlines() if re.match(r"\| +\d", line)]
    spans = [[int(number) for number in row[0].split("-")] for row in rows]
    return rows, [span[-1] - span[0] + 1 for span in spans], [span[0] for span in spans]


@every_env
def test_docstring_tables_match_the_spaces(env_id):
    env = make(env_id)
    doc, names = inspect.getdoc(type(env)), env.simulation.robot.joints
    rows, counts, starts = table(doc, "Action")
    assert counts == [1] * env.action_space.shape[0]
    assert [row[4] for row in rows] == list(names)
    np.testing.assert_array_equal(
        np.array([row[2:4] for row in rows], dtype=float).T, [*env.action_space.low[None], env.action_space.high]
    )
    rows, counts, starts = table(doc, "Observation")
    assert starts == np.cumsum([0, *counts[:-1]]).tolist()
    assert sum(counts) == env.observation_space.shape[0]
    assert [row[1].split(",")[0] for row in rows] == [*ORDER, "time since the start", "reference"][: len(rows)]
    assert len(rows) == (10 if env_id in TOOL_IDS else 9)
    assert {tuple(row[2:4]) for row in rows} == {("-Inf", "Inf")}


@every_env
def test_render_fps_is_real_time(env_id):
    for maker in (gym.make, gym.make_vec):
        for control_dt, decimation, fps in ((1e-3, 1, 1000), (1e-3, 20, 50), (2e-3, 10, 50)):
            env = maker(env_id, control_dt=control_dt, decimation=decimation).unwrapped
            assert env.metadata["render_fps"] == fps
        assert type(env).metadata["render_fps"] == 1000


@every_env
@pytest.mark.parametrize("argument", ["friction", "joints", "gains"])
def test_every_parameter_has_an_effect(env_id, argument):
    """A tenth more of it moves every motor by more than 1e-9 in 0.1 s: a million roundings of the positions."""
    plain = make(env_id)
    usual = getattr(
        plain.simulation.task if argument == "gains" else plain.simulation.robot,
        {"joints": "flexible"}.get(argument, argument),
    )
    motion = drive(plain)[:, : plain.simulation.dof]
    moved = {}
    for field in fields(usual):
        value = getattr(usual, field.name)
        changed = replace(usual, **{field.name: 1.1 * value if np.any(value) else 0.1})
        env = make(env_id, **{argument: changed})
        moved[field.name] = np.abs(drive(env)[:, : plain.simulation.dof] - motion).max(axis=0).min()
        if argument == "joints" and field.name != "damping":
            told = np.broadcast_to(getattr(changed, field.name), motion.shape[1:])
            np.testing.assert_array_equal(getattr(env.joint_info, field.name), told)
    assert {name: distance for name, distance in moved.items() if distance <= 1e-9} == {}
