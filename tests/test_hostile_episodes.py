"""Seeds, options and actions: what is refused names itself, and leaves the episode as it was."""

from __future__ import annotations

import math
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hostile import NO_ARRAYS, NO_NUMBERS, Attack, check_refused

from fo_gym.generators import MAX_SEED
from fo_gym.sb3 import make_vec_env

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"
NO_SEEDS = (*NO_NUMBERS, 1.0, 1.5, math.nan, -1, np.int64(-1), np.float64(2.0), "0", MAX_SEED + 1, 10**5000)
NO_OPTIONS: tuple[Any, ...] = (5, True, "target", [], ["target"], {"target"}, np.zeros(7))


def both() -> tuple[Any, Any]:
    """An environment, and a vector of three, in the middle of an episode with draws."""
    env = gym.make(REGULATION, variant="hardware").unwrapped
    vector = gym.make_vec(REGULATION, num_envs=3, variant="hardware")
    for each in (env, vector):
        each.reset(seed=1)
        each.step(np.zeros(each.action_space.shape))
    return env, vector


@pytest.fixture(scope="module")
def pair() -> tuple[Any, Any]:
    return both()


def check_unchanged(pair: tuple[Any, Any]) -> None:
    """Both go on as if nothing had been tried: the step, and the draws of the next episode."""
    for each, fresh in zip(pair, both(), strict=True):
        zero = np.zeros(each.action_space.shape)
        np.testing.assert_array_equal(each.step(zero)[0], fresh.step(zero)[0])
        np.testing.assert_array_equal(each.reset()[0], fresh.reset()[0])
        each.reset(seed=1)
        each.step(zero)


def test_seeds(pair: tuple[Any, Any]) -> None:
    env, vector = pair
    cases: list[Attack] = [
        ("seed", value, lambda value, each=each: each.reset(seed=value)) for each in pair for value in NO_SEEDS
    ]
    cases += [("seed", value, lambda value: env.reset(seed=value)) for value in ([1], (1,), np.array([1]))]
    cases += [("seed[1]", value, lambda value: vector.reset(seed=[0, value, 2])) for value in NO_SEEDS]
    cases += [
        ("seed", value, lambda value: vector.reset(seed=value))
        for value in ("123", b"123", {1, 2, 3}, {0: 1, 1: 2, 2: 3}, iter([1, 2, 3]), np.zeros((3, 1), int), np.array(1))
    ]
    cases += [("seed", value, lambda value: make_vec_env(STICTION, 2, seed=value)) for value in (*NO_SEEDS, [1, 2])]
    cases += [("seed[0]", 0.0, lambda _: vector.reset(seed=np.zeros(3)))]
    cases += [("seed has 2 values", "3", lambda _: vector.reset(seed=[1, 2]))]
    check_refused(cases)
    check_unchanged(pair)


def test_seeds_of_numpy_and_of_gymnasium_itself_are_taken() -> None:
    env, vector = gym.make(STICTION), gym.make_vec(STICTION, num_envs=2)
    env.reset()
    drawn = env.unwrapped.np_random_seed
    for seed in (np.int64(3), np.uint8(3), drawn, MAX_SEED):
        env.reset(seed=seed)
        vector.reset(seed=seed)
        assert env.unwrapped.np_random_seed == seed
    vector.reset(seed=np.array([1, 2]))
    vector.reset(seed=(1, None))


def test_options(pair: tuple[Any, Any]) -> None:
    dof = 7
    good = {"time": 1.0, "duration": 0.5, "torque": np.ones(dof)}

    def options(value: Any, each: Any) -> object:
        return each.reset(seed=5, options=value)

    cases: list[Attack] = []
    for each in pair:
        cases += [("options", value, lambda value, each=each: options(value, each)) for value in NO_OPTIONS]
        cases += [
            ("unknown reset options", key, lambda key, each=each: options({key: np.zeros(dof)}, each))
            for key in ("goal", "Target", "", 1, None, ("push", 1))
        ]
        cases += [
            ("'target'", value, lambda value, each=each: options({"target": value}, each))
            for value in (*NO_ARRAYS, 0.1, np.zeros(6), np.zeros((1, 7)), np.full(dof, math.nan), [math.inf] * dof)
        ]
        for name, values in (
            ("time", (*NO_NUMBERS, None, -1.0, math.nan, math.inf)),
            ("duration", (*NO_NUMBERS, None, -1.0, 0.0, math.nan, math.inf)),
            ("torque", (*NO_ARRAYS, 1.0, np.ones(6), np.full(dof, math.nan))),
        ):
            cases += [
                (
                    f"push {name}",
                    value,
                    lambda value, each=each, name=name: options({"push": {**good, name: value}}, each),
                )
                for value in values
            ]
        cases += [
            ("'push'", value, lambda value, each=each: options({"push": value}, each))
            for value in (None, 1.0, "push", [], {}, {"time": 1.0}, {**good, "sign": 1})
        ]
    cases += [
        ("reset_mask", value, lambda value: options({"reset_mask": value}, pair[1]))
        for value in (True, [True] * 3, np.ones(3), np.ones(2, bool), np.ones((3, 1), bool), None, "all")
    ]
    cases += [("reset_mask", np.zeros(3, bool), lambda value: options({"reset_mask": value}, pair[1]))]
    check_refused(cases)
    check_unchanged(pair)


def test_steps_out_of_turn() -> None:
    """Before the first reset, and of a batch that was closed: Gymnasium's own errors."""
    env, vector = gym.make(STICTION).unwrapped, gym.make_vec(STICTION, num_envs=2)
    for each in (env, vector):
        with pytest.raises(gym.error.ResetNeeded, match="before the first reset"):
            each.step(np.zeros(each.action_space.shape))
    vector.reset()
    vector.close()
    for call in (vector.reset, lambda: vector.step(np.zeros((2, 1)))):
        with pytest.raises(gym.error.ClosedEnvironmentError, match="make a new one"):
            call()


def test_a_target_outside_the_joint_range_names_joint_range_and_value(pair: tuple[Any, Any]) -> None:
    for each in pair:
        low, high = each.simulation.limits.low, each.simulation.limits.high
        for j, value in ((1, high[1] + 1e-3), (6, low[6] - 1.0)):
            target = np.zeros(7)
            target[j] = value
            told = rf"'target' is {value:g} at joint 'joint{j + 1}'.*give a value from {low[j]:g} to {high[j]:g}"
            with pytest.raises(ValueError, match=told):
                each.reset(options={"target": target})
        each.reset(seed=1, options={"target": high})
        each.reset(seed=1)
        each.step(np.zeros(each.action_space.shape))
    with pytest.raises(ValueError, match=r"'target' is 0\.51 at joint 'joint'.*from -0\.5 to 0\.5"):
        gym.make(STICTION).reset(options={"target": [0.51]})
    with pytest.raises(ValueError, match="takes no 'target'"):
        gym.make(SQUARE).reset(options={"target": np.zeros(7)})


def test_a_push_beyond_the_episode_is_refused() -> None:
    env = gym.make(STICTION, duration=1.0)
    for time, duration in ((1.0, 0.5), (30.0, 0.5), (0.5, 0.6), (0.0, 1e300)):
        told = rf"push time is {time:g} s and its duration {duration:g} s, but the episode ends after 1 s; push earlier"
        with pytest.raises(ValueError, match=told.replace("+", r"\+")):
            env.reset(options={"push": {"time": time, "duration": duration, "torque": [1.0]}})
    env.reset(options={"push": {"time": 0.5, "duration": 0.5, "torque": [1.0]}})


def test_actions(pair: tuple[Any, Any]) -> None:
    """What is no array of numbers stays none in any shape; NaN names its place."""
    cases: list[Attack] = []
    for each in pair:
        shape = each.action_space.shape
        bad = [
            np.zeros(shape, dtype) for dtype in (complex, bool, "datetime64[s]", "timedelta64[s]", "U4", "S4", object)
        ]
        bad += [
            np.zeros(shape, [("a", float)]),
            np.ma.masked_array(np.zeros(shape), mask=True),
            np.zeros(shape).astype(str),
        ]
        bad += [np.zeros(shape[:-1]), np.zeros((*shape, 1)), np.zeros(0), *NO_ARRAYS]
        cases += [("action", value, lambda value, each=each: each.step(value)) for value in bad]
        for value in (math.nan, math.inf, -math.inf):
            action = np.zeros(shape)
            action[..., 3] = value
            place = [3] if len(shape) == 1 else [0, 3]
            cases += [(f"action{place} is {value}", str(value), lambda _, each=each, action=action: each.step(action))]
    check_refused(cases)
    check_unchanged(pair)


def test_actions_of_other_real_types_are_taken(pair: tuple[Any, Any]) -> None:
    for each in pair:
        shape = each.action_space.shape
        results = []
        for action in (np.ones(shape), np.ones(shape, np.float32), np.ones(shape, int), np.ones(shape).tolist()):
            each.reset(seed=1)
            results.append(each.step(action)[0])
        for result in results:
            np.testing.assert_array_equal(result, results[0])
        each.reset(seed=1)
        each.step(np.zeros(shape))
