"""The random streams of an episode's draws, one for each name."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import gymnasium as gym
import numpy as np
from environments import every_env, make

from fo_gym.generators import Streams
from fo_gym.hardware import Effect
from fo_gym.tasks.draw import draw_scenario
from fo_gym.tasks.randomization import Randomization

REGULATION = "FJRRegulation-v0"


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


def test_each_stream_leaves_the_others_alone():
    one, other = Streams(np.random.default_rng(3)), Streams(np.random.default_rng(3))
    assert one("push") is one("push")
    first = one("friction").random(5), one("push").random(5)
    other("new").random(1000)
    second = other("push").random(5), other("friction").random(5)
    np.testing.assert_array_equal(first, second[::-1])
    assert len({*first[0], *first[1]}) == 10


def test_streams_are_of_one_episode():
    """The next episode of the same environment has others, and so has another seed."""
    rng = np.random.default_rng(3)
    numbers = {Streams(each)("push").random() for each in (rng, rng, np.random.default_rng(4))}
    assert len(numbers) == 3


@every_env
def test_a_draw_more_or_less_changes_no_other(env_id):
    usual = draws(env_id, 4)
    for changes in ({"others": (Another(),)}, {"model_error": None}, {"temperature": None, "ripple": None}):
        changed = draws(env_id, 4, **changes)
        shared = [name for name in usual if name in changed and ".believed" not in name]
        assert len(shared) > 15
        for name in shared:
            np.testing.assert_array_equal(changed[name], usual[name], err_msg=f"{name} with {changes}")


def test_every_draw_has_a_name_of_its_own(monkeypatch):
    """The ranges of the randomization by their fields, the effects by theirs, and each once."""
    asked = []
    monkeypatch.setattr(Streams, "__call__", lambda _, name: asked.append(name) or np.random.default_rng(0))
    draws(REGULATION, 4)
    hardware = make(REGULATION, variant="hardware").simulation.robot.hardware
    effects = [f"effect {effect.name}" for effect in hardware.effects]
    effects += [f"noise of {effect.name}" for effect in hardware.effects if effect.noisy]
    ranges = [field.name for field in fields(Randomization) if not field.name.startswith("hand")]  # no hand here
    assert sorted(asked[-len(ranges) - len(effects) :]) == sorted([*ranges, *effects])


@every_env
def test_a_batch_is_its_environments_and_a_seed_its_episodes(env_id):
    batch = gym.make_vec(env_id, num_envs=2, variant="hardware")
    first, _ = batch.reset(seed=5)
    again, _ = batch.reset(seed=5)
    np.testing.assert_array_equal(again, first)
    for i in range(2):
        np.testing.assert_array_equal(gym.make(env_id, variant="hardware").reset(seed=5 + i)[0], first[i])
    assert (batch.reset()[0] != first).any()
