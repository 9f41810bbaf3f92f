"""Effects of others: what they do is what they say, and all that holds for the shipped ones holds for them."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field, replace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from environments import every_env, make

import fo_gym
from fo_gym import ENVIRONMENTS
from fo_gym import hardware as hw
from fo_gym.hardware import Effect, FrictionChange, Hardware
from fo_gym.robots import Robot, robot_of

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"


@dataclass(frozen=True)
class Drift(Effect):
    """A torque sensor whose zero drifts, at a rate per episode, and is set anew now and then, a little wrong."""

    largest: float = 0.5
    period: float = 5e-3
    noisy = True

    def draw(self, dof, generator):
        return {"rate": generator.uniform(-self.largest, self.largest, dof)}

    def begin(self, episodes):
        return {"zero": np.zeros_like(episodes.truth.tau_j), "since": np.zeros_like(episodes.time)}

    def measure(self, readings, episodes):
        memory = episodes.memory
        due = episodes.time >= memory["since"] + self.period - 1e-9
        memory["zero"] = np.where(due, 0.01 * episodes.standard_normal(), memory["zero"])
        memory["since"] = np.where(due, episodes.time, memory["since"])
        drift = episodes.drawn["rate"] * (episodes.time - memory["since"]) + memory["zero"]
        return readings._replace(tau_j=readings.tau_j + drift)


@dataclass(frozen=True)
class Weak(Effect):
    """Motors that give a share of what they are told."""

    share: float

    def command(self, tau_m, episodes):
        return self.share * tau_m


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


def replace_name(effect, name):
    """The effect under another name."""
    return type(name, (type(effect),), {})(**vars(effect))


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


class Broken(Effect):
    """Gives what the test tells it to."""

    def __init__(self, **answers):
        self.answers = answers

    def draw(self, dof, generator):
        return self.answers.get("draw", {})

    def begin(self, episodes):
        return self.answers.get("begin", {})

    def measure(self, readings, episodes):
        episodes.memory.update(self.answers.get("remember", {}))
        return self.answers.get("measure", readings)

    def command(self, tau_m, episodes):
        return self.answers.get("command", tau_m)

    def motor_torque(self, episodes):
        return self.answers.get("motor_torque", 0.0)

    def friction(self, episodes):
        return self.answers.get("friction", FrictionChange())


@pytest.mark.parametrize(
    ("answers", "message"),
    [
        ({"draw": {"x": "much"}}, "Broken.draw, x is 'much'"),
        ({"begin": {"x": np.zeros(3)}}, r"Broken.begin, x is of shape \(3,\); it must have 1 rows"),
        ({"remember": {"x": np.zeros(3)}}, "Broken, memory is .*give a mapping"),
        ({"measure": None}, "Broken.measure is None; give a Readings"),
        ({"measure": hw.Readings(0.0, np.zeros((1, 7)), np.zeros((1, 7)))}, r"Broken.measure, theta is of shape \(\)"),
        ({"command": np.zeros(7)}, r"Broken.command is of shape \(7,\); it must be of shape \(1, 7\)"),
        ({"motor_torque": np.zeros(6)}, r"Broken.motor_torque is of shape \(6,\); it must be of shape \(1, 7\)"),
        ({"friction": (1.0, 0.0, 1.0)}, "Broken.friction is .*; give a FrictionChange"),
        ({"friction": FrictionChange(dry=None)}, "Broken.friction, dry is None"),
    ],
)
def test_what_an_effect_must_not_give(answers, message):
    """It is told when the environment is made, and by the hook's name."""
    with pytest.raises(ValueError, match=message):
        gym.make(REGULATION, hardware=Hardware(others=(Broken(**answers),)))


def test_noise_is_for_those_that_say_so():
    class Silent(Drift):
        noisy = False

    with pytest.raises(ValueError, match="the effect draws noise; give its class noisy = True"):
        gym.make(STICTION, hardware=Hardware(others=(Silent(),)))


def test_the_truth_cannot_be_written_into():
    class Vandal(Effect):
        def measure(self, readings, episodes):
            readings.theta[:] = 0.0
            return readings

    with pytest.raises(ValueError, match="read-only"):
        gym.make(STICTION, hardware=Hardware(others=(Vandal(),)))


@pytest.mark.parametrize(
    ("others", "message"),
    [
        (Weak(0.5), r"Hardware.others is Weak\(share=0.5\); give a tuple"),
        ((hw.Hardware(),), r"Hardware.others\[0\] is Hardware.*; give a Effect"),
        ((Weak(0.5), Weak(0.2)), "Hardware has 2 effects named 'Weak'; give each of them a `name` of its own"),
        ((replace_name(Weak(0.5), ""),), r"Hardware.others\[0\].name is ''; give a text that is not empty"),
    ],
)
def test_what_is_no_effect(others, message):
    with pytest.raises(ValueError, match=message):
        Hardware(others=others)


# --- Load on any law --------------------------------------------------------------------------------------------------

M6 = {"gain": 0.1, "motor": 0.05, "stiction_load": 0.2, "stiction_motor": 0.03, "quadratic_load": 0.01}
"""Of a gear, of the order of those that were identified (arXiv:2410.08650, MX-106)."""


@pytest.mark.parametrize("law", [fo_gym.LuGre, fo_gym.ElastoPlastic, fo_gym.MaxwellSlip, fo_gym.Dahl])
def test_load_acts_on_every_law_by_both_torques(law: Any) -> None:
    """Friction as the plant has it is that of model M6 for the torques of motor and joint, written here anew."""
    load = hw.LoadFriction(**M6, quadratic_motor=0.02)
    friction = law.like(robot_of("single_link").friction)
    env = gym.make("FJRStiction-v0", friction=friction, hardware=Hardware(load=load), action_mode="torque")
    env.reset(seed=0)
    plant: Any = env.unwrapped.simulation.plant  # type: ignore[attr-defined]
    seen = set()
    for tau_m in [6.0] * 40 + [-2.0] * 40 + [0.5] * 40:
        tau_j = plant.tau_j.item()
        env.step(np.array([tau_m]))
        both = abs(0.05 * tau_m + 0.1 * tau_j)
        square = 0.01 * tau_j**2 if abs(tau_m) > abs(tau_j) else 0.02 * tau_m**2
        more = abs(0.03 * tau_m + 0.2 * tau_j) + (square if tau_m * tau_j > 0.0 else 0.0)
        seen.add((tau_m * tau_j > 0.0, abs(tau_m) > abs(tau_j)))
        assert plant._friction["f_c"].item() == pytest.approx(1.0 + both, rel=1e-12)
        if law is not fo_gym.Dahl:
            assert plant._friction["f_s"].item() == pytest.approx(1.5 + both + more, rel=1e-12)
    assert len(seen) == 4, "a case of the model was not met"
