"""The hardware's effects: each by itself against its formula, that each one matters, and what all of them share."""

from __future__ import annotations

import copy
from dataclasses import fields, replace

import gymnasium as gym
import numpy as np
import pytest
from environments import IDS, every_env, make
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

import fo_gym
from fo_gym import Signals
from fo_gym import hardware as hw
from fo_gym.hardware import Hardware, HardwareDraw, Imperfections, Sensing, SensorModel

STICTION, REGULATION, SQUARE = IDS
DT = 1e-3
EFFECTS = [field.name for field in fields(Hardware)]
STILL = HardwareDraw(None, 1.0, np.zeros(2), np.zeros(2), np.zeros(2), None, 7)  # type: ignore[arg-type]


def sensing(model, tachometer=False, draw=STILL, theta=0.0):
    """Sensors of two joints of one robot, at rest at theta."""
    sensors = Sensing(model, 1, 2, DT, tachometer=tachometer)
    sensors.reset(np.array([0]), np.full((1, 2), theta), np.zeros((1, 2)), [draw])
    return sensors


def only(env_id, name):
    """The environment's own effects, all but one switched off."""
    own = make(env_id).task.hardware
    return replace(Hardware(), **{name: getattr(own, name)})


def drive(env, steps=400):
    """Observations of an environment under a fixed wave of estimates."""
    level = np.minimum(env.action_space.high, 3.0)
    return np.array([env.step(level * np.sin(0.02 * k))[0] for k in range(steps)])


class TestSensors:
    def test_the_encoder_counts_steps_and_its_velocity_is_their_filtered_difference(self):
        theta = np.cumsum(np.random.default_rng(0).normal(scale=1e-3, size=(300, 2)), axis=0)
        sensors = sensing(SensorModel(hw.MotorEncoder(resolution=np.array([1e-3, 2e-4]), cutoff=500.0)))
        seen = []
        for each in theta:
            sensors.sample(each[None], np.zeros((1, 2)), np.zeros((1, 2)))
            seen.append((sensors.theta[0].copy(), sensors.theta_dot[0].copy()))
        positions, velocities = map(np.array, zip(*seen, strict=True))
        steps = np.rint(theta / [1e-3, 2e-4]) * [1e-3, 2e-4]
        np.testing.assert_allclose(positions, steps, atol=1e-15)
        weight = 1.0 - np.exp(-500.0 * DT)
        difference = np.diff(np.vstack([np.zeros((1, 2)), steps]), axis=0) / DT
        np.testing.assert_allclose(velocities, lfilter([weight], [1, weight - 1], difference, axis=0), atol=1e-9)

    def test_the_torque_sensor_is_a_first_order_low_pass(self):
        """The step response at the ticks is 1 - exp(-w t)."""
        sensors = sensing(SensorModel(torque=hw.TorqueSensor(noise=0.0, offset=0.0, cutoff=300.0)))
        answer = []
        for _ in range(50):
            sensors.sample(np.zeros((1, 2)), np.zeros((1, 2)), np.full((1, 2), 4.0))
            answer.append(sensors.tau_j[0, 0])
        np.testing.assert_allclose(answer, 4.0 * (1 - np.exp(-300.0 * DT * np.arange(1, 51))), rtol=1e-12)

    def test_noise_is_white_and_offset_stays(self):
        draw = replace(STILL, torque_offset=np.array([0.3, -0.2]))
        sensors = sensing(SensorModel(torque=hw.TorqueSensor(noise=np.array([0.1, 0.5]), offset=1.0)), draw=draw)
        seen = []
        for _ in range(20_000):
            sensors.sample(np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((1, 2)))
            seen.append(sensors.tau_j[0].copy())
        noise = np.array(seen) - [0.3, -0.2]
        assert np.abs(noise.mean(axis=0) / [0.1, 0.5]).max() < 4 / np.sqrt(20_000)
        np.testing.assert_allclose(noise.std(axis=0), [0.1, 0.5], rtol=0.03)
        for joint in noise.T:
            assert abs(np.corrcoef(joint[1:], joint[:-1])[0, 1]) < 0.03

    def test_a_tachometer_measures_velocity_itself(self):
        sensors = sensing(SensorModel(hw.MotorEncoder(resolution=1.0)), tachometer=True)
        sensors.sample(np.full((1, 2), 0.4), np.full((1, 2), 0.123), np.zeros((1, 2)))
        assert sensors.theta_dot.tolist() == [[0.123, 0.123]]
        assert sensors.theta.tolist() == [[0.0, 0.0]]

    @every_env
    def test_every_look_sees_the_same(self, env_id):
        env = make(env_id, variant="hardware")
        obs, *_ = env.step(np.zeros(env.action_space.shape))
        for _ in range(3):
            np.testing.assert_array_equal(env.simulation.observation()[0], obs)
            env.joint_info, env.simulation.truth()
        signals = Signals.from_observation(obs, env.simulation.dof)
        assert (signals.tau_j != env.simulation.plant.tau_j[0]).any()


class TestJoint:
    def imperfections(self, **effects):
        joint = Imperfections(Hardware(**effects), 1, 2, DT, np.array([2.0, 3.0]))
        draw = replace(STILL, ripple_phase=np.array([0.5, 1.0]), temperature=np.array([10.0, 20.0]))
        joint.reset(np.array([0]), np.array([[0.1, 0.2]]), [draw])
        return joint

    def test_commands_come_late_and_the_first_hold_the_joint(self):
        joint = self.imperfections(delay=hw.CommandDelay(3e-3))
        came = [joint.command(np.full((1, 2), float(k)))[0, 0] for k in range(1, 7)]
        assert came == [0.1, 0.1, 0.1, 1.0, 2.0, 3.0]

    def test_saturation_is_a_share_of_the_limit(self):
        joint = self.imperfections(saturation=hw.TorqueSaturation(0.5))
        assert joint.command(np.array([[5.0, -5.0]])).tolist() == [[1.0, -1.5]]

    def test_without_saturation_the_command_is_the_torque(self):
        assert self.imperfections().command(np.array([[50.0, -50.0]])).tolist() == [[50.0, -50.0]]

    def test_ripple_goes_round_with_the_motor(self):
        joint = self.imperfections(ripple=hw.GearRipple(amplitude=0.3, period=0.01))
        for theta in (0.0, 0.002, 0.0123):
            expected = 0.3 * np.sin(2 * np.pi * theta / 0.01 + np.array([0.5, 1.0]))
            np.testing.assert_allclose(joint.motor_torque(np.full((1, 2), theta))[0], expected, atol=1e-12)

    def test_load_and_temperature(self):
        joint = self.imperfections(load=hw.LoadFriction(0.1), temperature=hw.Temperature(rise=4.0, time=2.0))
        dry, added, viscous = joint.friction(np.array([1000]), np.array([[3.0, -5.0]]))
        temperature = np.array([10.0, 20.0]) + 4.0 * (1 - np.exp(-0.5))
        np.testing.assert_allclose(added[0], [0.3, 0.5])
        np.testing.assert_allclose(dry[0], np.exp(-0.005 * temperature))
        np.testing.assert_allclose(viscous[0], np.exp(-0.02 * temperature))

    def test_the_plants_friction_is_what_load_and_temperature_make_of_it(self):
        """f_c, f_s of the episode times dry plus added; sigma_2 times viscous; as the plant has them."""
        effects = Hardware(load=hw.LoadFriction(0.2), temperature=hw.Temperature(start=(15.0, 15.0), rise=0.0))
        env = make(REGULATION, variant="randomized", hardware=effects)
        plant, own = env.simulation.plant, env.simulation.scenarios[0].friction
        for _ in range(3):
            tau_j = plant.tau_j.copy()
            env.step(np.zeros(7))
            for name, column in (("f_c", 6), ("f_s", 7)):
                expected = getattr(own, name) * np.exp(-0.005 * 15.0) + 0.2 * np.abs(tau_j[0])
                np.testing.assert_allclose(plant._parameters[0, :, column], expected, rtol=1e-12)
            np.testing.assert_allclose(plant._parameters[0, :, 5], own.sigma_2 * np.exp(-0.02 * 15.0), rtol=1e-12)

    def test_link_friction_is_the_solvers(self):
        """The frictionless motor with a rough link, 0.4 s: control and damper are held over a period."""
        rough = hw.LinkFriction(coulomb=0.1, viscous=0.4, width=0.01)
        env = make(STICTION, friction=fo_gym.FRICTIONLESS, hardware=Hardware(link_friction=rough), duration=0.4)
        env.reset(seed=0, options={"target": [0.05]})
        ours = np.array([env.step([0.0])[4]["theta"][0] for _ in range(400)])

        def rates(_, x):
            q, w, theta, v = x
            spring = 3000.0 * (theta - q)
            drag = 0.1 * np.tanh(w / 0.01) + 0.4 * w
            return [w, spring - drag, v, -50.0 * (theta - 0.05) - 5.0 * v - spring]

        times = DT * np.arange(1, 401)
        theirs = solve_ivp(rates, (0, 0.4), np.zeros(4), t_eval=times, rtol=1e-9, atol=1e-12, method="LSODA").y[2]
        smooth = make(STICTION, friction=fo_gym.FRICTIONLESS, duration=0.4)
        smooth.reset(seed=0, options={"target": [0.05]})
        without = np.array([smooth.step([0.0])[4]["theta"][0] for _ in range(400)])
        assert np.abs(ours - theirs).max() < 3e-3 * np.abs(theirs).max()
        assert np.abs(ours - without).max() > 0.05 * np.abs(theirs).max()

    def test_ripple_moves_the_motor_by_its_torque(self):
        """A frictionless motor in balance under PD: K_p (theta - theta_d) = ripple."""
        ripple = hw.GearRipple(amplitude=0.2, period=1.0)
        env = make(STICTION, friction=fo_gym.FRICTIONLESS, hardware=Hardware(ripple=ripple))
        phase = env.simulation.scenarios[0].hardware.ripple_phase[0]
        for _ in range(15_000):
            *_, info = env.step([0.0])
        theta = info["theta"][0]
        assert 50.0 * (theta - 0.01) == pytest.approx(0.2 * np.sin(2 * np.pi * theta + phase), abs=1e-6)


class TestModelError:
    @every_env
    def test_what_is_believed_is_told_and_used(self, env_id):
        effects = Hardware(model_error=hw.ModelError((1.2, 1.2), (0.8, 0.8), (0.9, 0.9)))
        env, honest = make(env_id, hardware=effects), make(env_id)
        np.testing.assert_allclose(env.joint_info.motor_inertia, 1.2 * honest.joint_info.motor_inertia)
        np.testing.assert_allclose(env.joint_info.stiffness, 0.8 * honest.joint_info.stiffness)
        np.testing.assert_array_equal(env.simulation.plant.stiffness, honest.simulation.plant.stiffness)
        told, true = (Signals.from_observation(e.simulation.observation()[0], e.simulation.dof) for e in (env, honest))
        # theta_d = q_d + g(q_d) / K_j: the link steps at the first tick, the arms begin where they are.
        scenario = env.simulation.scenarios[0]
        q_d = scenario.target if env_id == STICTION else scenario.q_start
        gravity = honest.simulation.plant.body.gravity(q_d[None])[0]
        np.testing.assert_allclose(true.theta_d, q_d + gravity / honest.joint_info.stiffness, rtol=1e-9)
        np.testing.assert_allclose(told.theta_d, q_d + 0.9 * gravity / env.joint_info.stiffness, rtol=1e-9)

    def test_the_nominal_motor_has_the_believed_inertia(self):
        effects = Hardware(model_error=hw.ModelError((1.25, 1.25), (1.0, 1.0), (1.0, 1.0)))
        env = make(STICTION, hardware=effects)
        before = Signals.from_observation(env.simulation.observation()[0], 1)
        obs, *_ = env.step([0.0])
        after = Signals.from_observation(obs, 1)
        assert after.theta_n_dot[0] == pytest.approx(DT * (before.tau_c[0] - before.tau_j[0]) / 1.25, rel=1e-12)


class TestTogether:
    @pytest.mark.parametrize("name", EFFECTS)
    @every_env
    def test_each_effect_can_be_switched_alone_and_matters(self, env_id, name):
        """Against the same episode without effects: the motion of 0.4 s, or of the push, is another one."""
        own = getattr(make(env_id).task.hardware, name)
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
        own = make(env_id).task.hardware
        full = make(env_id, variant="hardware").simulation.scenarios[0]
        for name in ("load", "ripple", "temperature", "delay"):
            less = make(env_id, variant="hardware", hardware=replace(own, **{name: None})).simulation.scenarios[0]
            for field in ("torque_offset", "ripple_phase", "temperature", "noise_seed", "believed_mass", "push_time"):
                np.testing.assert_array_equal(getattr(less.hardware, field), getattr(full.hardware, field))
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
