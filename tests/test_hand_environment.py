"""What an environment makes of a hand: the torques it gives the joints, and what is kept of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import gymnasium as gym
import mujoco
import numpy as np
import pytest
from arms import miro

import fo_gym
from fo_gym.friction import FRICTIONLESS
from fo_gym.tasks.hand import Hand
from fo_gym.tasks.interaction import interaction

ID = "FJRInteraction-v0"
SOON = {"grip": 0.02, "strokes": 1, "turn": 0.05, "rest": 0.0, "release": 0.02, "stroke": 0.03, "speed": 0.2}
"""A hand that grips and lets go within 0.24 s."""


def task_of(robot: Any) -> fo_gym.Task:
    return replace(interaction(robot), hand=Hand(**SOON))  # type: ignore[arg-type]


def make(num_envs: int | None = None, variant: str = "randomized", **settings: Any) -> Any:
    if num_envs is None:
        return gym.make(ID, task=task_of, variant=variant, **settings).unwrapped
    return gym.make_vec(ID, num_envs, task=task_of, variant=variant, **settings)


def test_tau_ext_is_that_of_mujoco() -> None:
    """J^T f at the links' place of the tick, for every tick of a hand that grips and lets go."""
    envs = make(2)
    envs.reset(seed=3)
    model = miro().link_side.model
    data, tool = mujoco.MjData(model), model.site("tool")
    pulled = 0
    for _ in range(300):
        q = envs.simulation.plant.q.copy()
        *_, info = envs.step(np.zeros((2, 7)))
        for i in range(2):
            data.qpos[:] = q[i]
            mujoco.mj_fwdPosition(model, data)
            expected = np.zeros(7)
            force, place = info["f_hand"][i][:, None], data.site("tool").xpos[:, None]
            mujoco.mj_applyFT(model, data, force, np.zeros((3, 1)), place, int(tool.bodyid[0]), expected)
            np.testing.assert_allclose(info["tau_ext"][i], expected, rtol=1e-9, atol=1e-12)
        pulled += int(np.all(np.any(info["f_hand"], axis=1)))
    assert 180 < pulled < 240


@pytest.mark.parametrize("variant", ["randomized", "hardware"])
def test_a_hand_in_a_batch_is_as_alone(variant: str) -> None:
    envs, alone = make(3, variant), [make(variant=variant) for _ in range(3)]
    batch, _ = envs.reset(seed=5)
    for i, each in enumerate(alone):
        np.testing.assert_array_equal(each.reset(seed=5 + i)[0], batch[i])
    for k in range(280):
        action = 10.0 * np.sin(0.1 * k + np.arange(7))
        batch, *_, infos = envs.step(np.tile(action, (3, 1)))
        for i, each in enumerate(alone):
            obs, *_, info = each.step(action)
            np.testing.assert_array_equal(obs, batch[i])
            np.testing.assert_array_equal(info["f_hand"], infos["f_hand"][i])


@pytest.mark.parametrize("at", [10, 20, 21, 120, 235, 260])
def test_a_state_brings_its_hand_with_it(at: int) -> None:
    """Before the grip, at it, while it guides, while it lets go, and after."""
    one, other = make(2), make(2)
    one.reset(seed=1)
    other.reset(seed=9)
    for _ in range(at):
        one.step(np.full((2, 7), 0.5))
    for _ in range(50):
        other.step(np.zeros((2, 7)))
    other.set_state(one.get_state())
    for name, value in one.simulation.truth().items():
        np.testing.assert_array_equal(other.simulation.truth()[name], value)
    for _ in range(100):
        expected, found = (each.step(np.full((2, 7), -0.5)) for each in (one, other))
        np.testing.assert_array_equal(found[0], expected[0])
        np.testing.assert_array_equal(found[-1]["f_hand"], expected[-1]["f_hand"])


def test_a_state_without_its_hand_is_refused() -> None:
    env = make()
    env.reset(seed=0)
    state, generator = env.get_state()
    without = replace(state.scenarios[0], hand=None)
    for name, value, message in (
        ("hands", None, r"SimulationState\.hands is None; give a HandState"),
        ("hands", replace(state.hands, force=np.zeros(3)), r"HandState\.force"),
        ("scenarios", (without,), r"scenarios\[0\]\.hand is missing"),
        ("scenarios", (replace(without, hand=Hand()),), r"scenarios\[0\]\.hand is .*nothing left open"),
    ):
        with pytest.raises(ValueError, match=message):
            env.set_state((replace(state, **{name: value}), generator))
    other = gym.make("FJRSquare-v0").unwrapped
    other.reset(seed=0)
    plain, _ = other.get_state()
    assert plain.hands is None
    with pytest.raises(ValueError, match=r"scenarios\[0\]\.hand is given|hands is given"):
        other.set_state((replace(plain, hands=state.hands), generator))


def test_the_force_of_a_step_is_the_mean_of_its_ticks() -> None:
    slow, fast = make(decimation=10, friction=FRICTIONLESS), make(friction=FRICTIONLESS)
    slow.reset(seed=2)
    fast.reset(seed=2)
    for _ in range(12):
        *_, info = slow.step(np.zeros(7))
        forces = [fast.step(np.zeros(7))[-1]["f_hand"] for _ in range(10)]
        np.testing.assert_allclose(info["f_hand"], np.mean(forces, axis=0), rtol=1e-12, atol=1e-14)


def test_a_push_and_a_hand_add_up() -> None:
    push = {"time": 0.0, "duration": 0.2, "torque": np.arange(7.0)}
    env = make(variant="nominal")
    env.reset(seed=0, options={"push": push})
    for tick in range(60):
        jacobian = env.simulation.plant.body.links.tool_pose(env.simulation.plant.q).jacobian[0, :3]
        *_, info = env.step(np.zeros(7))
        pushed = push["torque"] * np.sin(np.pi * (tick + 0.5) * 1e-3 / 0.2) ** 2
        np.testing.assert_allclose(info["tau_ext"], pushed + jacobian.T @ info["f_hand"], rtol=1e-9, atol=1e-12)
    assert np.any(info["f_hand"])


def test_only_where_there_is_a_hand_does_info_tell_of_one() -> None:
    assert make(variant="nominal").reset(seed=0)[1]["f_hand"].shape == (3,)
    assert "f_hand" not in gym.make("FJRSquare-v0").reset(seed=0)[1]
