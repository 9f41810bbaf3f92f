"""Friction that depends on the load, on any law."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import fo_gym
from fo_gym import hardware as hw
from fo_gym.hardware import Hardware
from fo_gym.robots import robot_of

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
