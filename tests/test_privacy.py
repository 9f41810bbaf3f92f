"""What a compensator gets to see, and that writing into it changes nothing."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from answering import DOF, STICTION, Answering, arrays, assert_same, episodes, silent

from fo_gym import LuGre, Signals
from fo_gym.signals import SIGNALS

PRIVATE = ("q", "q_dot", "z", "tau_f", "tau_dist")


def contents(thing: Any, path: str) -> dict[str, Any]:
    """All plain values that can be reached from `thing` by attributes, by the way that leads there."""
    if is_dataclass(thing):
        names = {*(field.name for field in fields(thing)), *vars(thing)}
        return {k: v for name in names for k, v in contents(getattr(thing, name), f"{path}.{name}").items()}
    if isinstance(thing, np.ndarray) and thing.base is not None:
        return {path: thing, **contents(thing.base, f"{path}.base")}
    return {path: thing}


@pytest.mark.parametrize("env_id", DOF)
def test_no_compensator_sees_the_truth(env_id: str) -> None:
    truth: dict[str, list[np.ndarray]] = {name: [] for name in PRIVATE}
    seen: dict[str, list[Any]] = {}

    def look(signals: Signals, _: int) -> np.ndarray:
        for path, value in (contents(signals, "signals") | contents(spy.joints, "joints")).items():
            seen.setdefault(path, []).append(np.copy(value) if isinstance(value, np.ndarray) else value)
        return silent(signals, 0)

    spy = Answering(look)
    env = gym.make_vec(env_id, num_envs=2, variant="randomized", duration=0.1)
    _, info = env.reset(seed=[7, 8])
    for _ in range(100):
        for name in PRIVATE:
            truth[name].append(info[name])
        _, _, _, _, info = env.step(np.zeros((2, DOF[env_id])))
    episodes(env_id, (7, 8)).record(spy, "spy")

    expected = {f"signals.{name}" for name in (*SIGNALS, "time", "reference", "available", "truth")}
    expected |= {f"joints.{name}" for name in ("dof", "motor_inertia", "stiffness", "torque_limit", "control_dt")}
    expected |= {f"joints.identified.{field.name}" for field in fields(LuGre)}
    assert {path for path in seen if not path.endswith(".base")} == expected
    assert not any(value is not None for value in seen["signals.truth"])
    simulation = env.unwrapped.simulation
    secrets = {name: np.array(values) for name, values in truth.items()}
    for field in ("sigma_0", "sigma_1", "sigma_2", "f_c", "f_s", "v_s"):
        secrets[field] = np.array([getattr(each.friction, field) for each in simulation.scenarios])
    secrets["M"] = simulation.plant.body.dense_inertia(info["q"])
    for path, values in seen.items():
        if isinstance(values[0], np.ndarray):
            for name, secret in secrets.items():
                shared = np.intersect1d(np.array(values), secret[secret != 0.0])
                # At rest without gravity the spring is relaxed: motor and link are where they started.
                at_rest = np.intersect1d(values[0], secret) if name == "q" else []
                assert set(shared) <= set(at_rest), f"{name} in {path}"
    env.close()


def test_it_does_see_what_it_should() -> None:
    """The search above finds a value that is there."""
    signals = Signals.from_observation(np.array([np.arange(10.0)]), 1)
    found = contents(signals, "signals")
    assert found["signals.tau_c"] == 6.0
    assert found["signals.tau_c.base"].shape == (1, 10)


@pytest.mark.parametrize("env_id", DOF)
def test_writing_into_what_it_sees_changes_nothing(env_id: str) -> None:
    def vandalize(signals: Signals, _: int) -> np.ndarray:
        for thing in (*contents(signals, "").values(), *contents(vandal.joints, "").values()):
            if isinstance(thing, np.ndarray) and thing.flags.writeable:
                thing[...] = 1.2345678
        return np.zeros((vandal.num_envs, vandal.joints.dof))

    vandal = Answering(vandalize)
    batch = episodes(env_id, (7, 8))
    assert_same(arrays(batch.record(vandal, "vandal")), arrays(batch.record(Answering(silent), "silent")))


def test_writing_into_an_old_answer_changes_nothing() -> None:
    buffer = np.zeros((1, 1))

    def reuse(_: Signals, tick: int) -> np.ndarray:
        buffer[:] = 0.01 * tick
        return buffer

    fresh = Answering(lambda _, tick: np.full((1, 1), 0.01 * tick))
    batch = episodes(STICTION)
    assert_same(arrays(batch.record(Answering(reuse), "reuse")), arrays(batch.record(fresh, "fresh")))
