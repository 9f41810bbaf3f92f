"""Effects of others: what they do is what they say, and all that holds for the shipped ones holds for them."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field, replace

import gymnasium as gym
import numpy as np
import pytest
from environments import every_env, make
from own_effects import Drift, Weak, replace_name

import fo_gym
from fo_gym import ENVIRONMENTS
from fo_gym import hardware as hw
from fo_gym.hardware import Effect, FrictionChange, Hardware
from fo_gym.robots import Robot, robot_of

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"


@dataclass(frozen=True)
class Constant(Effect):
    """A constant torque on the motors, bearings that are viscous, and friction that is another."""

    torque: float = 0.0
    damping: float = 0.0
    change: FrictionChange = field(default_factory=FrictionChange)

    def motor_torque(self, episodes):
        return self.torque

    def link_damping(self, episodes):
        return self.damping

    def friction(self, episodes):
        return self.change


@dataclass(frozen=True)
class Rumour(Effect):
    """What is believed, and when the push comes."""

    def believe(self, joints, mass, drawn):
        return replace(joints, stiffness=2.0 * joints.stiffness), 0.5 * mass

    def pushed_at(self, time, drawn):
        return 7.5


def wave(env, steps):
    """Observations under a fixed wave of estimates."""
    level = np.minimum(env.action_space.high, 3.0)
    return np.array([env.step(level * np.sin(0.02 * k))[0] for k in range(steps)])


class TestWhatTheyDo:
    @every_env
    def test_a_reading_is_changed_by_what_was_drawn(self, env_id):
        env = make(env_id, hardware=Hardware(others=(Drift(period=1.0),)))
        env.reset(seed=3)
        rate = env.simulation.scenarios[0].hardware.drawn["Drift"]["rate"]
        for k in range(1, 20):
            env.step(np.zeros(env.action_space.shape))
            simulation = env.simulation
            drift = simulation.hardware_model.readings.tau_j - simulation.plant.tau_j
            np.testing.assert_allclose(drift, [rate * k * 1e-3], atol=1e-12)
        assert np.abs(rate).max() > 0.0

    def test_commands(self):
        env = make(STICTION, action_mode="torque", hardware=Hardware(others=(Weak(0.25),)))
        *_, info = env.step([2.0])
        assert info["tau_m"].tolist() == [0.5]

    def test_they_act_one_after_the_other(self):
        """After the shipped ones: what is clipped to 4 N is halved, and halved again."""
        others = Weak(0.5), replace_name(Weak(0.5), "WeakAgain")
        env = make(
            STICTION, action_mode="torque", hardware=Hardware(saturation=hw.TorqueSaturation(0.4), others=others)
        )
        *_, info = env.step([10.0])
        assert info["tau_m"].tolist() == [1.0]

    def test_a_motor_torque_is_balanced_by_the_controller(self):
        """Without friction: K_p (theta - theta_d) = torque."""
        arguments = {"friction": fo_gym.FRICTIONLESS, "decimation": 100}
        env = make(STICTION, hardware=Hardware(others=(Constant(torque=0.2),)), **arguments)
        for _ in range(150):
            *_, info = env.step([0.0])
        assert 50.0 * (info["theta"][0] - 0.01) == pytest.approx(0.2, abs=1e-6)

    @every_env
    def test_a_damper_is_that_of_viscous_bearings(self, env_id):
        bearings = hw.LinkFriction(coulomb=0.0, viscous=0.4, width=0.01)
        ours = make(env_id, hardware=Hardware(others=(Constant(damping=0.4),)))
        shipped = make(env_id, hardware=Hardware(link_friction=bearings))
        np.testing.assert_array_equal(wave(ours, 100), wave(shipped, 100))
        assert (wave(ours, 20) != wave(make(env_id), 20)).any()

    @every_env
    def test_friction_is_that_of_other_parameters(self, env_id):
        own = make(env_id).simulation.robot.friction
        less = replace(own, f_c=0.5 * own.f_c + 0.1, f_s=0.5 * own.f_s + 0.1, sigma_2=2.0 * own.sigma_2)
        change = Constant(change=FrictionChange(dry=0.5, added=0.1, viscous=2.0))
        changed, other = make(env_id, hardware=Hardware(others=(change,))), make(env_id, friction=less)
        np.testing.assert_array_equal(wave(changed, 100), wave(other, 100))

    @every_env
    def test_beliefs_and_pushes(self, env_id):
        env = make(env_id, variant="randomized", hardware=Hardware(others=(Rumour(),)))
        (scenario,) = env.simulation.scenarios
        np.testing.assert_array_equal(env.joint_info.stiffness, 2.0 * scenario.joints.stiffness)
        assert scenario.believed_mass == 0.5
        if "hand" not in ENVIRONMENTS[env_id].tags:  # which is not pushed
            assert scenario.push.time == 7.5


class TestWhatHoldsForAll:
    @every_env
    def test_a_saved_state_goes_on_exactly(self, env_id):
        """Memory, noise and draws of another's effect are part of it."""
        arguments = {"variant": "hardware", "hardware": Hardware(delay=hw.CommandDelay(2e-3), others=(Drift(),))}
        env, other = make(env_id, **arguments), make(env_id, **arguments)
        wave(env, 23)
        state = copy.deepcopy(env.get_state())
        onward = wave(env, 23)
        other.reset(seed=99)
        other.set_state(state)
        np.testing.assert_array_equal(wave(other, 23), onward)
        hidden = state[0].hardware
        assert set(hidden.memory) == {"CommandDelay", "Drift"}
        assert np.any(hidden.memory["Drift"]["zero"])
        for spoilt in ({**hidden.memory, "Drift": {}}, {"CommandDelay": hidden.memory["CommandDelay"]}):
            with pytest.raises(ValueError, match=r"SimulationState.hardware.memory.* is .*; give a mapping with .*"):
                other.set_state((replace(state[0], hardware=replace(hidden, memory=spoilt)), *state[1:]))
        with pytest.raises(ValueError, match=r"whose hardware is .*; here it is"):
            make(env_id, variant="hardware").set_state(state)

    @every_env
    def test_a_batch_is_its_environments_to_the_bit(self, env_id):
        """Also where some of them begin anew while the others go on."""
        arguments = {"variant": "hardware", "hardware": Hardware(others=(Drift(),)), "duration": 0.05}
        batch = gym.make_vec(env_id, num_envs=2, autoreset_mode=gym.vector.AutoresetMode.DISABLED, **arguments)
        singles = [gym.make(env_id, **arguments) for _ in range(2)]
        batch.reset(seed=5)
        for i, env in enumerate(singles):
            env.reset(seed=5 + i)
        action = 0.01 * batch.action_space.high
        for k in range(30):
            if k == 12:
                obs, _ = batch.reset(options={"reset_mask": np.array([False, True])})
                np.testing.assert_array_equal(obs[1], singles[1].reset()[0])
            obs = batch.step(action)[0]
            np.testing.assert_array_equal(obs, [env.step(each)[0] for env, each in zip(singles, action, strict=True)])

    @every_env
    def test_the_shipped_effects_stay_as_they_are(self, env_id):
        """What the motors do is the same to the bit; only the torque sensor's readings are others."""
        own = make(env_id, variant="hardware").simulation.robot.hardware
        usual = make(env_id, variant="hardware", action_mode="torque")
        more = make(env_id, variant="hardware", action_mode="torque", hardware=replace(own, others=(Drift(),)))
        for k in range(30):
            action = 0.1 * usual.action_space.high * np.sin(0.1 * k)
            (first, *_, truth), (second, *_, again) = usual.step(action), more.step(action)
            np.testing.assert_equal(again, truth)
            dof = usual.simulation.dof
            np.testing.assert_array_equal(first[: 2 * dof], second[: 2 * dof])
        assert (first != second).any()

    def test_a_robot_has_them_in_its_fingerprint_and_its_toml_refuses_them(self, tmp_path):
        """Their numbers and their source decide how it moves; a file of numbers cannot hold them."""
        robot = robot_of("miro_like")

        def having(*others):
            return replace(robot, hardware=replace(robot.hardware, others=others))

        robots = [robot, having(Weak(0.5)), having(Weak(0.25)), having(replace_name(Weak(0.5), "Other"))]
        robots.append(having(Weak(0.5), Drift()))
        assert len({each.fingerprint for each in robots}) == len(robots)
        assert having(Weak(0.5)).fingerprint == robots[1].fingerprint
        for each in robots[1:]:
            with pytest.raises(ValueError, match=r"hardware.others is .*; a robot.toml holds numbers alone"):
                each.to_toml(tmp_path / "robot.toml")
        robot.to_toml(tmp_path / "robot.toml")
        assert Robot.from_toml(tmp_path / "robot.toml").hardware.others == ()

    def test_compensators_are_evaluated_on_them(self):
        arguments = {"variant": "hardware", "seeds": 1, "duration": 0.05}
        rows = fo_gym.evaluate("pd-high", STICTION, hardware=Hardware(others=(Drift(), Weak(0.9))), **arguments)
        assert (rows["status"] == "ok").all()
