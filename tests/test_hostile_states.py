"""States that belong elsewhere, or are none: refused with the field's name, and the environment is as it was."""

from __future__ import annotations

import copy
import math
from dataclasses import fields, replace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hostile import Attack, check_refused
from pendulum import MakeRobot, drive, plant_of

import fo_gym
from fo_gym.plant import PlantState
from fo_gym.simulation.state import SimulationState

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"
NO_STATES: tuple[Any, ...] = (None, 1, "state", (), (None,), [1, 2], [1, 2, 3], {"q": 1})


def running(env_id: str, num_envs: int | None = None, **settings: Any) -> Any:
    """An environment, or a vector, after two steps."""
    env: Any = (
        gym.make(env_id, **settings).unwrapped if num_envs is None else gym.make_vec(env_id, num_envs, **settings)
    )
    env.reset(seed=3)
    for _ in range(2):
        env.step(np.zeros(env.action_space.shape))
    return env


def spoilt(name: str, array: np.ndarray[Any, Any]) -> list[Attack]:
    """Values that are no such array."""
    values = (
        None,
        "x",
        1.0,
        array[:0],
        array[..., None],
        array.astype(complex),
        array.astype(bool),
        array.astype(object),
    )
    values += (
        (np.where(np.ones(array.shape, bool), math.nan, array),)
        if array.dtype.kind == "f"
        else (array + 0.5, array - 1000)
    )
    return [(name, value, lambda value: value) for value in values]


def replaced(state: Any, path: tuple[str, ...], value: Any) -> Any:
    """The state with a part of a part replaced, where the last may be a key."""
    name, *rest = path
    if isinstance(state, dict):
        return {**state, name: replaced(state[name], tuple(rest), value) if rest else value}
    inner = replaced(getattr(state, name), tuple(rest), value) if rest else value
    return replace(state, **{name: inner})


def array_fields(state: SimulationState) -> dict[tuple[str, ...], Any]:
    """All arrays of a state, by their path."""
    found = {(each.name,): getattr(state, each.name) for each in fields(state)}
    found |= {("plant", each.name): getattr(state.plant, each.name) for each in fields(state.plant)}
    found |= {("hardware", "readings", name): value for name, value in state.hardware.readings.items()}
    for effect, memory in state.hardware.memory.items():
        found |= {("hardware", "memory", effect, name): value for name, value in memory.items()}
    return {path: value for path, value in found.items() if isinstance(value, np.ndarray)}


@pytest.mark.parametrize("num_envs", [None, 2])
@pytest.mark.parametrize("env_id", [STICTION, REGULATION])
def test_every_field(env_id: str, num_envs: int | None) -> None:
    """Each array of the state spoilt in turn: the message names it, and nothing has changed."""
    env = running(env_id, num_envs, variant="hardware")
    whole = env.get_state()
    state, rest = whole[0], whole[1:]
    expected = env.simulation.observation()
    arrays = array_fields(state)
    assert len(arrays) > 15
    cases: list[Attack] = [
        (path[-1], value, lambda value, path=path: env.set_state((replaced(state, path, value), *rest)))
        for path, array in arrays.items()
        for _, value, _ in spoilt(path[-1], array)
    ]

    def with_part(name: str, value: Any) -> Any:
        return replace(state, **{name: value}), *rest

    cases += [
        ("state" if name == "plant" else name, value, lambda value, name=name: env.set_state(with_part(name, value)))
        for name in ("plant", "hardware", "origin", "scenarios")
        for value in (None, 1, "x", ())
    ]
    cases += [("state", value, env.set_state) for value in NO_STATES]
    cases += [
        ("random generator", value, lambda value: env.set_state((state, value, *rest[1:])))
        for value in (None, 1, {}, [{}], {"state": 1})
    ]
    check_refused(cases)
    np.testing.assert_array_equal(env.simulation.observation(), expected)
    zero = np.zeros(env.action_space.shape)
    twin = running(env_id, num_envs, variant="hardware")
    np.testing.assert_array_equal(env.step(zero)[0], twin.step(zero)[0])
    np.testing.assert_array_equal(env.reset()[0], twin.reset()[0])


def test_scenarios_of_another_robot_or_task() -> None:
    env = running(REGULATION, variant="hardware")
    state, generator = env.get_state()
    scenario = state.scenarios[0]
    draw = scenario.hardware
    assert draw is not None
    name = "SimulationState.scenarios[0]"
    wrong_draws = (
        replace(draw, drawn={}),
        replace(draw, drawn={**draw.drawn, "TorqueSensor": {"offset": np.zeros(3)}}),
        replace(draw, noise_seeds={"TorqueSensor": -1}),
        replace(draw, noise_seeds={}),
        replace(draw, push_time=-1.0),
    )
    bad: dict[str, tuple[Any, ...]] = {
        "q_start": (np.zeros(6), None, "x", np.full(7, math.nan)),
        "target": (np.zeros(6), None, "x"),
        "mass_scale": (0.0, True, None, math.nan),
        "friction": (None, 1.0, draw.believed),
        "joints": (None, 1.0, scenario.friction),
        "push": (1.0, "push"),
        "hardware": (None, 1.0, *wrong_draws),
    }

    def with_part(field: str, value: Any) -> Any:
        return replace(state, scenarios=(replace(scenario, **{field: value}),)), generator

    check_refused(
        (name, value, lambda value, field=field: env.set_state(with_part(field, value)))
        for field, values in bad.items()
        for value in values
        if not isinstance(value, type(draw))
    )
    for wrong in bad["hardware"][2:]:
        with pytest.raises(ValueError, match=r"scenarios\[0\]\.hardware\.(drawn|noise_seeds|push_time).* is"):
            env.set_state(with_part("hardware", wrong))


OTHERS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("robot", STICTION, {}),
    ("task", SQUARE, {}),
    ("variant", REGULATION, {"variant": "hardware"}),
    ("variant", REGULATION, {"variant": "randomized"}),
    ("hardware", REGULATION, {"hardware": fo_gym.Hardware()}),
    ("control_dt", REGULATION, {"control_dt": 2e-3}),
    ("decimation", REGULATION, {"decimation": 2}),
)


def test_states_of_other_environments_both_ways() -> None:
    """A hardware episode's in a nominal environment and the reverse, another task, robot, period or size."""
    nominal = running(REGULATION)
    before = copy.deepcopy(nominal.simulation.observation())
    for name, env_id, settings in OTHERS:
        other = running(env_id, **settings)
        for to, of in ((nominal, other), (other, nominal)):
            told = (
                f"the state is of an environment whose {name} is .*; here it is .*: make the environment with the same"
            )
            with pytest.raises(ValueError, match=told):
                to.set_state(of.get_state())
    np.testing.assert_array_equal(nominal.simulation.observation(), before)
    three, two = running(STICTION, 3), running(STICTION, 2)
    with pytest.raises(ValueError, match="num_envs is 3; here it is 2"):
        two.simulation.set_state(three.simulation.get_state())
    with pytest.raises(ValueError, match="give a list of 2 states of random generators"):
        two.set_state(three.get_state())
    shorter = running(REGULATION, duration=0.01)
    nominal.set_state(shorter.get_state())
    for _ in range(20):
        nominal.step(np.zeros(7))
    with pytest.raises(ValueError, match=r"SimulationState.ticks is .*22.*from 0 to 10"):
        shorter.set_state(nominal.get_state())


def test_plants(pendulum: MakeRobot) -> None:
    plant = plant_of(pendulum(), num_envs=2)
    drive(plant, 5)
    state = plant.get_state()
    cases: list[Attack] = [
        (
            f"PlantState.{each.name}",
            value,
            lambda value, name=each.name: plant.set_state(replace(state, **{name: value})),
        )
        for each in fields(PlantState)
        for _, value, _ in spoilt(each.name, getattr(state, each.name))
    ]
    cases += [("state", value, plant.set_state) for value in NO_STATES]
    cases += [("PlantState.time", np.full(2, 1.5e-3), lambda value: plant.set_state(replace(state, time=value)))]
    cases += [("PlantState.time", np.full(2, -1e-3), lambda value: plant.set_state(replace(state, time=value)))]
    check_refused(cases)
    for name, value in vars(plant.get_state()).items():
        np.testing.assert_array_equal(value, getattr(state, name))
