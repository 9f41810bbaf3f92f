"""The hardware's effects, each by itself against its formula."""

from __future__ import annotations

import numpy as np
import pytest
from effects import DT, begin, joints, measured
from environments import every_env, make
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

import fo_gym
from fo_gym import Signals
from fo_gym import hardware as hw
from fo_gym.hardware import Hardware

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"


def drawn_zero(**shares):
    """What two joints drew of their torque sensors; what is not given is 0."""
    return {name: np.asarray(shares.get(name, [0.0, 0.0])) for name in ("offset", "drift", "load", "average")}


class TestSensors:
    def test_the_encoder_counts_steps_and_its_velocity_is_their_filtered_difference(self):
        theta = np.cumsum(np.random.default_rng(0).normal(scale=1e-3, size=(300, 2)), axis=0)
        encoder = hw.MotorEncoder(resolution=np.array([1e-3, 2e-4]), cutoff=500.0)
        episodes = begin(encoder)
        seen = [measured(encoder, episodes, theta=each) for each in theta]
        steps = np.rint(theta / [1e-3, 2e-4]) * [1e-3, 2e-4]
        np.testing.assert_allclose([each.theta for each in seen], steps, atol=1e-15)
        weight = 1.0 - np.exp(-500.0 * DT)
        difference = np.diff(np.vstack([np.zeros((1, 2)), steps]), axis=0) / DT
        expected = lfilter([weight], [1, weight - 1], difference, axis=0)
        np.testing.assert_allclose([each.theta_dot for each in seen], expected, atol=1e-9)

    @pytest.mark.parametrize("resolution", [0.0, 1e-3])
    def test_one_resolution_for_all_joints_is_the_same_for_each(self, resolution):
        one, each = hw.MotorEncoder(resolution, 300.0), hw.MotorEncoder(np.full(2, resolution), 300.0)
        episodes = begin(one), begin(each)
        for theta in np.random.default_rng(0).normal(size=(20, 2)):
            first, second = (measured(*pair, theta=theta) for pair in zip((one, each), episodes, strict=True))
            np.testing.assert_array_equal(first, second)

    def test_the_torque_sensor_is_a_first_order_low_pass(self):
        """The step response at the ticks is 1 - exp(-w t)."""
        sensor = hw.TorqueSensor(noise=0.0, offset=0.0, cutoff=300.0)
        episodes = begin(sensor, drawn=drawn_zero())
        answer = [measured(sensor, episodes, tau_j=4.0).tau_j[0] for _ in range(50)]
        np.testing.assert_allclose(answer, 4.0 * (1 - np.exp(-300.0 * DT * np.arange(1, 51))), rtol=1e-12)

    def test_noise_is_white_and_offset_stays(self):
        sensor = hw.TorqueSensor(noise=np.array([0.1, 0.5]), offset=1.0)
        episodes = begin(sensor, drawn=drawn_zero(offset=[0.3, -0.2]))
        seen = [measured(sensor, episodes).tau_j for _ in range(20_000)]
        noise = np.array(seen) - [0.3, -0.2]
        assert np.abs(noise.mean(axis=0) / [0.1, 0.5]).max() < 4 / np.sqrt(20_000)
        np.testing.assert_allclose(noise.std(axis=0), [0.1, 0.5], rtol=0.03)
        for joint in noise.T:
            assert abs(np.corrcoef(joint[1:], joint[:-1])[0, 1]) < 0.03

    def test_a_zero_that_was_nulled_is_off_by_the_averages_noise_the_loads_error_and_the_drift(self):
        """Not by the offset; against the mean of so many readings, less the load as it is known."""
        sensor = hw.TorqueSensor(noise=0.5, offset=9.0, nulled=0.4, load_error=0.1, drift=0.2)
        drawn = drawn_zero(offset=[7.0, -5.0], drift=[0.1, 0.2], load=[0.02, -0.05], average=[1.0, -2.0])
        load = np.array([10.0, 4.0])
        memory = begin(sensor, drawn=drawn, tau_j=load).memory
        known = load * (1.0 + drawn["load"])
        average = load + drawn["offset"] + 0.5 / np.sqrt(400) * drawn["average"]
        np.testing.assert_allclose(memory["zero"][0], drawn["offset"] + drawn["drift"] - (average - known), atol=1e-12)
        raw = begin(sensor.raw, drawn=drawn, tau_j=load).memory
        np.testing.assert_allclose(raw["zero"][0], drawn["offset"] + drawn["drift"])

    @every_env
    def test_the_raw_tier_is_the_same_but_for_the_nulling(self, env_id):
        """Same draws; the calibrated zero is off by far less than the raw one, and not by nothing."""
        own = make(env_id, variant="hardware").simulation.robot.hardware
        envs = [make(env_id, variant="hardware", hardware=each) for each in (own, own.raw)]
        first, second = (env.simulation.scenarios[0].hardware.drawn["TorqueSensor"] for env in envs)
        for name, value in first.items():
            np.testing.assert_array_equal(value, second[name])
        zeros: list[list[np.ndarray]] = [[], []]
        for env, found in zip(envs, zeros, strict=True):
            for seed in range(8):
                env.reset(seed=seed)
                found.append(env.simulation.hardware_model.get_state().memory["TorqueSensor"]["zero"])
        calibrated, raw = (np.mean(np.abs(found) / own.sensors.torque.offset) for found in zeros)
        assert 0.0 < calibrated < 0.5 * raw

    def test_a_tachometer_measures_velocity_itself(self):
        encoder = hw.MotorEncoder(resolution=1.0)
        readings = measured(encoder, begin(encoder, tachometer=True), theta=0.4, theta_dot=0.123)
        assert readings.theta_dot.tolist() == [0.123, 0.123]
        assert readings.theta.tolist() == [0.0, 0.0]

    @every_env
    def test_without_sensors_the_readings_are_the_truth(self, env_id):
        """To the last bit."""
        env = make(env_id, variant="randomized", hardware=Hardware())
        rng = np.random.default_rng(0)
        for _ in range(20):
            env.step(0.1 * env.action_space.high * rng.uniform(-1.0, 1.0, env.action_space.shape))
            for name, array in env.simulation.hardware_model.readings._asdict().items():
                np.testing.assert_array_equal(array, getattr(env.simulation.plant, name), err_msg=name)

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
    def test_commands_come_late_and_the_first_hold_the_joint(self):
        delay = hw.CommandDelay(3e-3)
        episodes = begin(delay, tau_j=[0.1, 0.2])
        came = [delay.command(np.full((1, 2), float(k)), episodes)[0, 0] for k in range(1, 7)]
        assert came == [0.1, 0.1, 0.1, 1.0, 2.0, 3.0]

    def test_without_delay_the_command_is_the_torque(self):
        delay = hw.CommandDelay(0.0)
        assert delay.command(np.array([[50.0, -50.0]]), begin(delay)).tolist() == [[50.0, -50.0]]

    def test_saturation_is_a_share_of_the_limit(self):
        saturation = hw.TorqueSaturation(0.5)
        assert saturation.command(np.array([[5.0, -5.0]]), begin(saturation)).tolist() == [[1.0, -1.5]]

    def test_ripple_goes_round_with_the_motor(self):
        ripple, phase = hw.GearRipple(amplitude=0.3, period=0.01), np.array([0.5, 1.0])
        episodes = begin(ripple, drawn={"phase": phase})
        for theta in (0.0, 0.002, 0.0123):
            episodes.truth = joints(theta=theta)
            expected = 0.3 * np.sin(2 * np.pi * theta / 0.01 + phase)
            np.testing.assert_allclose(ripple.motor_torque(episodes)[0], expected, atol=1e-12)

    def test_load_and_temperature(self):
        load, warm = hw.LoadFriction(0.1), hw.Temperature(rise=4.0, time=2.0)
        start = np.array([10.0, 20.0])
        episodes = begin(warm, drawn={"start": start}, tau_j=[3.0, -5.0])
        episodes.time = np.array([[1.0]])
        loaded = load.friction(begin(load, tau_j=[3.0, -5.0]))
        dry, added, viscous, stiction = loaded.then(warm.friction(episodes))
        temperature = start + 4.0 * (1 - np.exp(-0.5))
        np.testing.assert_allclose(added[0], [0.3, 0.5])
        np.testing.assert_array_equal(stiction, 0.0)
        np.testing.assert_allclose(dry[0], np.exp(-0.01 * temperature))
        np.testing.assert_allclose(viscous[0], np.exp(-0.03 * temperature))

    def test_the_plants_friction_is_what_load_and_temperature_make_of_it(self):
        """f_c, f_s of the episode times dry plus added; sigma_2 times viscous; as the plant has them."""
        effects = Hardware(load=hw.LoadFriction(0.2), temperature=hw.Temperature(start=(15.0, 15.0), rise=0.0))
        env = make(REGULATION, variant="randomized", hardware=effects)
        plant, own = env.simulation.plant, env.simulation.scenarios[0].friction
        for _ in range(3):
            tau_j = plant.tau_j.copy()
            env.step(np.zeros(7))
            for name in ("f_c", "f_s"):
                expected = getattr(own, name) * np.exp(-0.01 * 15.0) + 0.2 * np.abs(tau_j[0])
                np.testing.assert_allclose(plant._friction[name][0], expected, rtol=1e-12)
            np.testing.assert_allclose(plant._friction["sigma_2"][0], own.sigma_2 * np.exp(-0.03 * 15.0), rtol=1e-12)

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
        env = make(STICTION, friction=fo_gym.FRICTIONLESS, hardware=Hardware(ripple=ripple), decimation=100)
        phase = env.simulation.scenarios[0].hardware.drawn["GearRipple"]["phase"][0]
        for _ in range(150):
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
