"""The full state can be read, set and copied, and the plant goes on exactly."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pendulum import FRICTION, JOINTS, POSE, MakeRobot, drive, plant_of, varied

from fo_gym.friction import FRICTIONLESS


def test_set_state_continues_exactly(pendulum: MakeRobot) -> None:
    """In the same plant, after it has moved on and been reset."""
    plant = varied(pendulum())
    kept = plant.get_state()
    expected = drive(plant, 200, start=200)
    assert plant.time == pytest.approx([0.4] * 3)
    plant.reset(np.arange(3), -POSE)
    plant.set_state(kept)
    assert plant.time == pytest.approx([0.2] * 3)
    np.testing.assert_array_equal(drive(plant, 200, start=200), expected)


def test_state_is_a_copy(pendulum: MakeRobot) -> None:
    plant = varied(pendulum())
    kept = plant.get_state()
    before = copy.deepcopy(kept)
    drive(plant, 5)
    plant.set_state(kept)
    drive(plant, 5)
    for name in ("q", "q_dot", "theta", "theta_dot", "z", "q_dot_before", "time"):
        np.testing.assert_array_equal(getattr(kept, name), getattr(before, name))


@pytest.mark.parametrize("duplicate", [lambda plant: pickle.loads(pickle.dumps(plant)), copy.deepcopy])
def test_copies_continue_exactly(pendulum: MakeRobot, duplicate: Callable[[Any], Any]) -> None:
    """Parameters, masses and time included; original and copy share nothing."""
    plant = varied(pendulum())
    twin = duplicate(plant)
    expected = drive(plant, 200, start=200)
    assert twin.time == pytest.approx([0.2] * 3)
    np.testing.assert_array_equal(drive(twin, 200, start=200), expected)
    np.testing.assert_array_equal(twin.tau_f, plant.tau_f)
    twin.configure(np.arange(3), joints=JOINTS, friction=FRICTION, mass_scale=2.0)
    twin.reset(np.arange(3), POSE)
    again = duplicate(plant)
    np.testing.assert_array_equal(drive(again, 5, start=400), drive(plant, 5, start=400))


@pytest.mark.parametrize("name", ["q", "q_dot", "theta", "theta_dot", "z", "q_dot_before"])
def test_state_of_another_shape_is_refused(pendulum: MakeRobot, name: str) -> None:
    plant = plant_of(pendulum(), num_envs=2)
    with pytest.raises(ValueError, match=rf"PlantState\.{name} .*\(3, 2\)"):
        plant.set_state(replace(plant.get_state(), **{name: np.zeros((3, 2))}))


def test_environments_stand_alone(pendulum: MakeRobot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Environment 1 of three, alone: the same to the bit, whatever becomes of its neighbours, lost ones included."""
    monkeypatch.chdir(tmp_path)  # MuJoCo logs lost states to the working directory
    alone, plant = plant_of(pendulum()), plant_of(pendulum(), num_envs=3)
    plant.configure(np.array([0]), joints=JOINTS, friction=FRICTIONLESS, mass_scale=0.6)
    plant.q[2] = np.nan
    for k in range(200):
        push = np.array([[2.0 * np.cos(0.03 * k), -1.0]])
        torque = np.array([[8.0 * np.sin(0.05 * k), 1.0]])
        alone.step(torque, push)
        plant.step(np.repeat(torque, 3, axis=0), np.repeat(push, 3, axis=0))
    np.testing.assert_array_equal(plant.get_state().theta[1], alone.get_state().theta[0])
    np.testing.assert_array_equal(plant.get_state().z[1], alone.get_state().z[0])
    assert np.isnan(plant.theta[2]).all()
    assert np.abs(plant.theta[0] - plant.theta[1]).max() > 1e-3
