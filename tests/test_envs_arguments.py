"""Arguments, actions and options that an environment refuses, and what it says then."""

from __future__ import annotations

import copy
import re

import gymnasium as gym
import numpy as np
import pytest
from environments import every_env, make

import fo_gym


@every_env
def test_bad_actions_are_refused_and_change_nothing(env_id):
    env, vector = make(env_id), gym.make_vec(env_id, num_envs=2)
    vector.reset(seed=0)
    dof = env.simulation.dof
    good = np.zeros(dof)
    expected = env.step(good)[0]
    for wrong in (np.zeros(dof + 1), np.zeros((1, dof)), np.float64(0.0)):
        with pytest.raises(ValueError, match=re.escape(f"shape {wrong.shape}; this environment takes {(dof,)}")):
            env.step(wrong)
        with pytest.raises(ValueError, match=re.escape(f"this environment takes {(2, dof)}")):
            vector.step(wrong)
    for value in (np.nan, np.inf, -np.inf):
        bad = np.append(np.zeros(dof - 1), value)
        with pytest.raises(ValueError, match=f"{value}.*must be finite"):
            env.step(bad)
        with pytest.raises(ValueError, match="must be finite"):
            vector.step(np.stack([good, bad]))
    np.testing.assert_array_equal(vector.step(np.zeros((2, dof)))[0], [expected, expected])


@every_env
@pytest.mark.parametrize("maker", [gym.make, gym.make_vec])
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"variant": "virtual"}, "variant is 'virtual'; allowed are 'nominal', 'randomized', 'hardware'"),
        ({"variant": "easy"}, "variant is 'easy'; allowed are 'nominal', 'randomized'"),
        ({"action_mode": "position"}, "action_mode is 'position'; allowed are 'compensation', 'torque'"),
        ({"feedback": None}, "feedback is None; allowed are 'measured', 'nominal'"),
        ({"sensors": "imu"}, "sensors is 'imu'; allowed are 'joint'"),
        ({"decimation": 0}, "decimation is 0; .*at least 1"),
        ({"decimation": 2.5}, "decimation is 2.5; .*whole number"),
        ({"duration": 0.0}, "duration is 0.0 s; .*above 0"),
        ({"duration": np.inf}, "duration is inf s; .*finite"),
        ({"duration": np.nan}, "duration is nan s; .*finite"),
        ({"control_dt": -1e-3}, "control_dt is -0.001 s; .*above 0"),
        ({"control_dt": np.nan}, "control_dt is nan s; .*finite"),
        ({"physics_dt": 3e-4}, "physics_dt 0.0003 s does not divide control_dt 0.001 s; 0.000333333333 s would"),
        ({"physics_dt": 2e-3}, "physics_dt 0.002 s does not divide"),
        ({"physics_dt": 0.0}, "physics_dt is 0.0 s; .*above 0"),
        ({"control_dt": 0.05, "physics_dt": 0.05}, "physics_dt 0.05 s is too long for joint 'joint.* at most"),
        ({"render_mode": "video"}, "render_mode is 'video'; .*None.*'rgb_array'"),
        ({"gains": fo_gym.LuGre(1, 1, 1, 1, 1, 1)}, "gains is LuGre.*takes (PDGains|ImpedanceGains)"),
        ({"joints": fo_gym.FlexibleJoint(3e3, 0.0, np.ones(5), 1.0)}, r"motor_inertia has shape \(5,\).*joints"),
        ({"friction": fo_gym.LuGre(1, 1, 1, np.ones(5), 2, 1)}, r"LuGre.f_c has shape \(5,\).*joints"),
        ({"friction": 1.0}, "friction is 1.0; give a FrictionLaw, or None"),
        ({"joints": fo_gym.FRICTIONLESS}, "joints is LuGre.*; give a FlexibleJoint, or None"),
        ({"randomization": (0.5, 2.0)}, "randomization is .*; give a Randomization, or None"),
        ({"duration": "long"}, "duration is 'long'; give a number in s"),
        ({"control_dt": None}, "control_dt is None; give a number in s"),
        ({"fricton": fo_gym.FRICTIONLESS}, "unexpected keyword argument 'fricton'"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*not in the possible render_modes")  # gym.make says it first
def test_bad_arguments_are_refused_with_the_remedy(env_id, maker, arguments, message):
    with pytest.raises(TypeError if "fricton" in arguments else ValueError, match=message):
        maker(env_id, **arguments)


@every_env
def test_reset_options(env_id):
    """What is refused, and why; what is taken is copied, and counts for one episode."""
    env, vector = gym.make(env_id).unwrapped, gym.make_vec(env_id, num_envs=3)
    dof, takes_target = env.simulation.dof, env.simulation.limits.takes_target
    ones, longer = np.ones(dof), np.ones(dof + 1)
    push = {"time": 0.0, "duration": 0.1, "torque": ones}
    refused = [
        ({"goal": ones, "push": push}, r"unknown reset options \['goal'\]; allowed are 'target' and 'push'"),
        ({"push": ones}, "'time', 'duration' and 'torque'"),
        ({"push": {"time": 0.0, "torque": ones}}, "'time', 'duration' and 'torque'"),
        ({"push": {**push, "sign": 1}}, "'time', 'duration' and 'torque'"),
        ({"push": {**push, "torque": longer}}, rf"torque is .*finite numbers of shape \({dof},\)"),
        ({"push": {**push, "torque": np.nan * ones}}, rf"torque is .*nan.*finite numbers of shape \({dof},\)"),
        ({"push": {**push, "time": -1.0}}, "push time is -1.0 s; .*at least 0"),
        ({"push": {**push, "duration": 0.0}}, "push duration is 0.0 s; .*above 0"),
    ]
    why = rf"'target' is .*finite numbers of shape \({dof},\)" if takes_target else "takes no 'target'"
    refused += [({"target": target}, why) for target in (longer, np.inf * ones, 0.0)]
    for options, message in refused:
        for each in (env, vector):
            with pytest.raises(ValueError, match=message):
                each.reset(options=options)
    for each in (env, vector):
        each.reset(seed=0, options={"push": push})
        np.testing.assert_allclose(each.step(0.0 * each.action_space.high)[4]["tau_ext"], np.sin(np.pi / 200.0) ** 2)
        each.reset(seed=0)
        np.testing.assert_array_equal(each.step(0.0 * each.action_space.high)[4]["tau_ext"], 0.0)
    if takes_target:
        target = 0.4 * ones
        env.reset(options={"target": target})
        target[:] = 9.0
        np.testing.assert_array_equal(env.simulation.scenarios[0].target, 0.4)


@every_env
def test_the_action_of_an_episode_that_has_ended_is_ignored(env_id):
    """As Gymnasium's own vectors do in the step that resets: even what would be refused."""
    vector = gym.make_vec(env_id, num_envs=2, duration=0.01)
    vector.reset(seed=0)
    shape = vector.action_space.shape
    for _ in range(10):
        truncated = vector.step(np.zeros(shape))[3]
    assert truncated.all()
    reward = vector.step(np.full(shape, np.nan))[1]
    np.testing.assert_array_equal(reward, 0.0)
    with pytest.raises(ValueError, match="must be finite"):
        vector.step(np.full(shape, np.nan))


def test_nothing_happens_before_the_first_reset():
    single, vector = gym.make("FJRStiction-v0").unwrapped, gym.make_vec("FJRStiction-v0", num_envs=2)
    steps = lambda: single.step(np.zeros(1)), lambda: vector.step(np.zeros((2, 1)))
    for call in (*steps, single.get_state, vector.get_state):
        with pytest.raises(gym.error.ResetNeeded, match="before the first reset"):
            call()


def test_a_closed_batch_is_not_drawn():
    vector = gym.make_vec("FJRStiction-v0", num_envs=2, render_mode="rgb_array")
    vector.reset(seed=0)
    vector.close()
    with pytest.raises(gym.error.ClosedEnvironmentError, match="make a new one"):
        vector.render()


def test_masks_of_info_cannot_be_written_in_copies_either():
    vector = gym.make_vec("FJRStiction-v0", num_envs=2)
    vector.reset(seed=0)
    for each in (vector, copy.deepcopy(vector)):
        with pytest.raises(ValueError, match="read-only"):
            each.step(np.zeros((2, 1)))[4]["_q"][0] = False
