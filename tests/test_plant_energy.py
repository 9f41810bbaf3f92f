"""No energy from nowhere, over random episodes of every environment; and the account would show it."""

from __future__ import annotations

import numpy as np
import pytest
from energy_search import CASES, Account, search

from fo_gym.simulation.settings import Settings
from fo_gym.simulation.simulation import Simulation
from fo_gym.tasks.stiction import stiction

RISE = 1e-4
"""Of the energy turned over. A search of 1e9 joint micro-steps (energy_search.py) found 1e-6 at most."""


def swing(sigma_2: float) -> float:
    """Largest rise in half a second of a wave on the single link, with that viscous friction."""
    simulation = Simulation("single_link", stiction, 1, Settings(action_mode="torque"))
    simulation.reset(np.array([0]), [np.random.default_rng(0)])
    simulation.plant._friction["sigma_2"] = sigma_2
    account, worst = Account(simulation), 0.0
    account.begin(np.array([0]))
    for k in range(500):
        simulation.step(np.full((1, 1), 5.0 * np.sin(0.02 * k)))
        worst = max(worst, float(account.rise().max()))
    return worst


def test_the_account_shows_friction_that_pushes() -> None:
    assert swing(0.4) < RISE
    assert swing(-20.0) > 10.0 * RISE


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_no_energy_from_nowhere(case: str) -> None:
    """A million joint micro-steps; sigma_1 = 0 is among the cases, at the step that follows it."""
    found = search(case, 1e6, joints=128)
    assert found.micro_steps >= 1e6
    assert found.finite
    assert found.rise < RISE
