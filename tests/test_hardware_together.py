"""The hardware's effects in the environments: that each one matters, what all share, and sets of sensors."""

from __future__ import annotations

import copy
from dataclasses import fields, replace

import gymnasium as gym
import numpy as np
import pytest
from environments import every_env, make

import fo_gym
from fo_gym import ENVIRONMENTS, Signals
from fo_gym import hardware as hw
from fo_gym.hardware import Hardware, SensorModel

STICTION = "FJRStiction-v0"

EFFECTS = [field.name for field in fields(Hardware) if field.name != "others"]


def only(env_id, name):
    """The environment's own effects, all but one switched off."""
    own = make(env_id, variant="hardware").simulation.robot.hardware
    return replace(Hardware(), **{name: getattr(own, name)})


def drive(env, steps=400):
    """Observations of an environment under a fixed wave of estimates."""
    level = np.minimum(env.action_space.high, 3.0)
    return np.array([env.step(level * np.sin(0.02 * k))[0] for k in range(steps)])


class TestTogether:
    @pytest.mark.parametrize("name", EFFECTS)
    @every_env
    def test_each_effect_can_be_switched_alone_and_matters(self, env_id, name):
        """Against the same episode without effects: the motion of 0.4 s, or of the push, is another one."""
        own = getattr(make(env_id, variant="hardware").simulation.robot.hardware, name)
        if name == "push_time" and "hand" in ENVIRONMENTS[env_id].tags:
            assert own is None  # a hand guides it, nobody pushes it
            return
        assert own is not None
        if name == "saturation":
            return  # its own test below: the limits are not reached by a sane command
        kwargs = {"variant": "randomized"}
        alone, none = make(env_id, hardware=only(env_id, name), **kwargs), make(env_id, **kwargs)
        if name == "push_time":
            one, other = (each.simulation.scenarios[0].push.time for each in (alone, none))
            assert one != other
            assert own.start[0] <= one <= own.start[1]
            return
        assert (drive(alone) != drive(none)).any()

    @every_env
    def test_saturation_matters_where_commands_are_large(self, env_id):
        env = make(env_id, variant="randomized", hardware=only(env_id, "saturation"), action_mode="torque")
        env.step(env.action_space.high)
        weak = replace(Hardware(), saturation=hw.TorqueSaturation(0.1))
        limited = make(env_id, variant="randomized", hardware=weak, action_mode="torque")
        *_, info = limited.step(limited.action_space.high)
        np.testing.assert_allclose(info["tau_m"], 0.1 * limited.action_space.high)

    @every_env
    def test_switching_one_effect_leaves_the_others_draws_alone(self, env_id):
        own = make(env_id, variant="hardware").simulation.robot.hardware
        full = make(env_id, variant="hardware").simulation.scenarios[0]
        for name in ("load", "ripple", "temperature", "delay"):
            less = make(env_id, variant="hardware", hardware=replace(own, **{name: None})).simulation.scenarios[0]
            np.testing.assert_equal(less.hardware.noise_seeds, full.hardware.noise_seeds)
            for effect, drawn in less.hardware.drawn.items():
                np.testing.assert_equal(drawn, full.hardware.drawn[effect], err_msg=f"{effect} without {name}")
            np.testing.assert_array_equal(less.friction.f_c, full.friction.f_c)

    @every_env
    def test_the_same_episode_as_randomized_but_for_the_effects(self, env_id):
        hardware, randomized = (make(env_id, variant=v).simulation.scenarios[0] for v in ("hardware", "randomized"))
        np.testing.assert_array_equal(hardware.friction.f_c, randomized.friction.f_c)
        np.testing.assert_array_equal(hardware.joints.motor_inertia, randomized.joints.motor_inertia)

    @every_env
    def test_a_batch_is_its_environments_to_the_bit(self, env_id):
        batch = gym.make_vec(env_id, num_envs=3, variant="hardware", duration=0.05)
        batch.reset(seed=5)
        singles = [gym.make(env_id, variant="hardware", duration=0.05) for _ in range(3)]
        for i, env in enumerate(singles):
            env.reset(seed=5 + i)
        action = 0.01 * batch.action_space.high
        for _ in range(49):
            obs, reward, *_ = batch.step(action)
            for i, env in enumerate(singles):
                single, single_reward, *_ = env.step(action[i])
                np.testing.assert_array_equal(obs[i], single)
                assert reward[i] == single_reward

    @every_env
    def test_a_saved_state_goes_on_exactly(self, env_id):
        env = make(env_id, variant="hardware")
        drive(env, 20)
        state = copy.deepcopy(env.get_state())
        onward = drive(env, 20)
        other = make(env_id, variant="hardware")
        other.reset(seed=99)
        other.set_state(state)
        np.testing.assert_array_equal(drive(other, 20), onward)

    @every_env
    def test_noise_comes_from_the_environments_seed_alone(self, env_id):
        runs = []
        for seed in (1, 1, 2):
            env = make(env_id, variant="hardware")
            env.reset(seed=seed)
            runs.append(drive(env, 10))
        np.testing.assert_array_equal(runs[0], runs[1])
        assert (runs[0] != runs[2]).any()


class TestTiers:
    @every_env
    def test_the_motor_tier_has_no_torque_sensor(self, env_id):
        env, full = make(env_id, sensors="motor"), make(env_id)
        dof = env.simulation.dof
        action = 0.01 * env.action_space.high
        obs, *_ = env.step(action)
        signals = Signals.from_observation(obs, dof, env.available)
        assert signals.available == {"theta", "theta_dot", "theta_d", "tau_c", "tau_m"}
        for name in ("tau_j", "theta_n", "theta_n_dot"):
            assert not getattr(signals, name).any()
        reference = Signals.from_observation(full.step(action)[0], dof)
        for name in signals.available:
            np.testing.assert_array_equal(getattr(signals, name), getattr(reference, name))
        with pytest.raises(ValueError, match="needs the torque sensor"):
            make(env_id, sensors="motor", feedback="nominal")

    def test_the_full_tier_measures_velocity(self):
        env = make(STICTION, variant="hardware", sensors="full")
        for _ in range(50):
            obs, _, _, _, info = env.step([-0.5])
        assert obs[1] == info["theta_dot"][0] != 0.0
        rough = make(STICTION, variant="hardware")
        for _ in range(50):
            obs, _, _, _, info = rough.step([-0.5])
        assert obs[1] != info["theta_dot"][0]

    def test_a_sensor_model_of_ones_own(self):
        """In any variant, and instead of the hardware's."""
        coarse = SensorModel(hw.MotorEncoder(resolution=0.004))
        for variant in ("nominal", "hardware"):
            env = make(STICTION, variant=variant, sensor_model=coarse)
            env.reset(seed=0)
            steps = drive(env, 300)[:, 0] / 0.004
            np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)

    def test_compensators_hear_which_signals_there_are(self):
        heard = []

        class Curious:
            feedback = "measured"

            def reset(self, joints, num_envs):
                self.zero = np.zeros((num_envs, joints.dof))

            def estimate(self, signals):
                heard.append(signals.available)
                return self.zero

        fo_gym.evaluate(Curious, STICTION, sensors="motor", duration=0.01)
        assert set(heard) == {frozenset({"theta", "theta_dot", "theta_d", "tau_c", "tau_m"})}


@pytest.mark.parametrize(
    ("make_it", "message"),
    [
        (lambda: hw.MotorEncoder(resolution=-1.0), "MotorEncoder.resolution is -1.*at least 0"),
        (lambda: hw.MotorEncoder(1e-6, cutoff=0.0), "MotorEncoder.cutoff is 0.*above 0"),
        (lambda: hw.TorqueSensor(noise=np.nan, offset=0.0), "TorqueSensor.noise is nan"),
        (lambda: hw.TorqueSaturation(0.0), "TorqueSaturation.share is 0"),
        (lambda: hw.Temperature(start=(3.0, 1.0)), "Temperature.start is"),
        (lambda: hw.ModelError(mass=(0.0, 1.0)), "ModelError.mass is"),
        (lambda: hw.PushTime((-1.0, 1.0)), "PushTime.start is"),
        (lambda: make(STICTION, hardware=Hardware(delay=hw.CommandDelay(1.5e-3))), "whole number of control_dt"),
        (lambda: make(STICTION, hardware="all"), "give a Hardware, or None"),
        (lambda: make(STICTION, sensor_model=1e-6), "give a SensorModel, or None"),
        (lambda: make(STICTION, sensors="laser"), "allowed are 'joint', 'motor', 'full'"),
    ],
)
def test_what_makes_no_sense(make_it, message):
    with pytest.raises(ValueError, match=message):
        make_it()
