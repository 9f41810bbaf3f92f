"""The random streams of an episode's draws: one after the other as published, or one for each name."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from environments import every_env, make

from fo_gym import generators
from fo_gym.generators import Streams
from fo_gym.hardware import Effect, Hardware
from fo_gym.tasks.draw import draw_scenario
from fo_gym.tasks.randomization import Randomization

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"


@pytest.fixture
def named(monkeypatch):
    """Every draw has a stream of its own."""
    monkeypatch.setattr(generators, "NAMED_STREAMS", True)


@dataclass(frozen=True)
class Another(Effect):
    """Draws what nobody drew before."""

    noisy = True

    def draw(self, dof: int, generator: np.random.Generator) -> dict[str, Any]:
        return {"much": generator.uniform(size=100)}


def flat(value: Any, name: str = "") -> dict[str, Any]:
    """All numbers of a draw, by where they are."""
    parts = value if isinstance(value, dict) else getattr(value, "__dict__", None)
    if parts is None:
        return {name: np.asarray(value)} if value is not None else {}
    return {key: number for part, inner in parts.items() for key, number in flat(inner, f"{name}.{part}").items()}


def draws(env_id, seed, **changes):
    """The numbers of an episode of the hardware variant, with changes of the hardware."""
    simulation = make(env_id, variant="hardware").simulation
    robot = replace(simulation.robot, hardware=replace(simulation.robot.hardware, **changes))
    return flat(draw_scenario(robot, simulation.task, "hardware", np.random.default_rng(seed)))


class TestPublished:
    def test_every_name_is_the_environments_generator(self):
        rng = np.random.default_rng(3)
        streams = Streams(rng)
        assert streams("friction") is streams("push") is rng

    def test_draws_come_one_after_the_other(self):
        """The regulation's, from the raw numbers of the generator in the order that is documented."""
        simulation = make(REGULATION).simulation
        scenario = draw_scenario(simulation.robot, simulation.task, "randomized", np.random.default_rng(5))
        raw, spread, robot = np.random.default_rng(5), simulation.task.randomization, simulation.robot

        def factor(name, size=7):
            low, high = np.log(getattr(spread, name))
            return np.exp(low + (high - low) * raw.random(size))

        def check(ours, expected):
            np.testing.assert_allclose(ours, expected, rtol=1e-12)

        friction, joints = scenario.friction, scenario.joints
        check(friction.f_c, robot.friction.f_c * factor("friction"))
        excess = robot.friction.f_s / robot.friction.f_c - 1.0
        check(friction.f_s / friction.f_c, 1.0 + excess * factor("stiction"))
        check(friction.sigma_0, robot.friction.sigma_0 * factor("bristle"))
        check(friction.sigma_2, robot.friction.sigma_2 * factor("viscous"))
        check(friction.v_s, robot.friction.v_s * factor("stribeck"))
        check(joints.motor_inertia, robot.flexible.motor_inertia * factor("motor_inertia"))
        check(joints.stiffness, robot.flexible.stiffness * factor("stiffness"))
        check(scenario.mass_scale, factor("mass", 1)[0])
        check(scenario.q_start, robot.home + spread.start * (2.0 * raw.random(7) - 1.0))
        share = raw.uniform(*spread.step, 7) * raw.choice([-1.0, 1.0], 7)
        check(scenario.target, simulation.task.reference.target(robot.home, share))
        strength = raw.uniform(*spread.push) * raw.choice([-1.0, 1.0])
        check(scenario.push.torque, simulation.task.random_push.torque * strength)
        check(scenario.push.time, raw.uniform(*spread.push_time))

    @every_env
    def test_another_effect_comes_after_the_shipped_ones(self, env_id):
        usual, more = draws(env_id, 4), draws(env_id, 4, others=(Another(),))
        assert set(more) - set(usual) == {".hardware.drawn.Another.much", ".hardware.noise_seeds.Another"}
        for name, number in usual.items():
            np.testing.assert_array_equal(more[name], number, err_msg=name)


@pytest.mark.usefixtures("named")
class TestNamed:
    def test_each_stream_leaves_the_others_alone(self):
        one, other = Streams(np.random.default_rng(3)), Streams(np.random.default_rng(3))
        assert one("push") is one("push")
        first = one("friction").random(5), one("push").random(5)
        other("new").random(1000)
        second = other("push").random(5), other("friction").random(5)
        np.testing.assert_array_equal(first, second[::-1])
        assert len({*first[0], *first[1]}) == 10

    def test_streams_are_of_one_episode(self):
        """The next episode of the same environment has others, and so has another seed."""
        rng = np.random.default_rng(3)
        numbers = {Streams(each)("push").random() for each in (rng, rng, np.random.default_rng(4))}
        assert len(numbers) == 3

    @every_env
    def test_a_draw_more_or_less_changes_no_other(self, env_id):
        usual = draws(env_id, 4)
        for changes in ({"others": (Another(),)}, {"model_error": None}, {"temperature": None, "ripple": None}):
            changed = draws(env_id, 4, **changes)
            shared = [name for name in usual if name in changed and ".believed" not in name]
            assert len(shared) > 15
            for name in shared:
                np.testing.assert_array_equal(changed[name], usual[name], err_msg=f"{name} with {changes}")

    def test_every_draw_has_a_name_of_its_own(self, monkeypatch):
        """The ranges of the randomization by their fields, the effects by theirs, and each once."""
        asked = []
        monkeypatch.setattr(Streams, "__call__", lambda self, name: asked.append(name) or np.random.default_rng(0))
        draws(REGULATION, 4)
        effects = ["ModelError", "TorqueSensor", "GearRipple", "Temperature", "PushTime", "TorqueSensor noise"]
        ranges = [field.name for field in fields(Randomization)]
        assert sorted(asked[-len(ranges) - len(effects) :]) == sorted([*ranges, *effects])

    @every_env
    def test_draws_fill_their_ranges(self, env_id):
        simulation = make(env_id).simulation
        rng, spread = np.random.default_rng(0), simulation.task.randomization
        drawn = [draw_scenario(simulation.robot, simulation.task, "randomized", rng) for _ in range(300)]
        for values, (low, high) in (
            (np.array([each.mass_scale for each in drawn]), spread.mass),
            (np.array([each.push.time for each in drawn]), spread.push_time),
            (np.array([each.friction.f_c for each in drawn]) / simulation.robot.friction.f_c, spread.friction),
        ):
            margin = 0.05 * (high - low)
            assert low <= values.min() <= low + margin
            assert high - margin <= values.max() <= high

    @every_env
    def test_a_batch_is_its_environments_and_a_seed_its_episodes(self, env_id):
        batch = gym.make_vec(env_id, num_envs=2, variant="hardware")
        first, _ = batch.reset(seed=5)
        again, _ = batch.reset(seed=5)
        np.testing.assert_array_equal(again, first)
        for i in range(2):
            np.testing.assert_array_equal(gym.make(env_id, variant="hardware").reset(seed=5 + i)[0], first[i])
        assert (batch.reset()[0] != first).any()

    def test_it_is_another_episode_than_the_published(self, monkeypatch):
        """Else nothing is switched."""
        named = draws(STICTION, 4)
        monkeypatch.setattr(generators, "NAMED_STREAMS", False)
        assert named[".friction.f_c"] != draws(STICTION, 4)[".friction.f_c"]


def test_the_published_draws_are_on() -> None:
    """To switch changes every drawn episode, and with them what is published."""
    assert generators.NAMED_STREAMS is False
    assert Hardware().others == ()
