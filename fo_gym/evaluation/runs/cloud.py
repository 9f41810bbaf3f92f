"""The cloud: the nominal episode again from starts that nobody could tell apart, which shows what in it is chance.

The nominal variant draws nothing, so that its seeds are free to choose the start: seed 0 is the episode itself, every
other seed moves each motor and each link by `CLOUD` to one side or the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fo_gym.envs.vector import JointVectorEnv
from fo_gym.simulation.state import SimulationState

CLOUD = 1e-6
"""How far the starts of the nominal cloud are from the nominal one [m | rad].

A micrometre, or one step of the arm's encoders: no robot starts twice within it, so that what differs between two such
starts is no property of a compensator. It is far above the last bits of a position, and a hundredth of the motion that
counts as hunting.
"""

__all__ = ["CLOUD", "moved", "sides", "spread_out"]


def sides(generators: Sequence[np.random.Generator], dof: int) -> NDArray[np.float64]:
    """To which side links and motors of each episode are moved, -1 or 1, (n, 2, dof); each from its own generator."""
    return np.array([generator.choice([-1.0, 1.0], (2, dof)) for generator in generators])


def moved(state: SimulationState, to: NDArray[np.float64], shift: float) -> SimulationState:
    """The state with every link and every motor, its nominal one with it, moved by `shift` to one side or the other.

    Args:
        state: of a simulation.
        to: as `sides` gives them; 0 leaves where it is.
        shift: in joint units.
    """
    plant = state.plant
    q, theta = plant.q + shift * to[:, 0], plant.theta + shift * to[:, 1]
    return replace(state, plant=replace(plant, q=q, theta=theta), theta_n=state.theta_n + shift * to[:, 1])


def spread_out(env: JointVectorEnv, seeds: Sequence[int]) -> None:
    """Move the starts of nominal episodes, those of seed 0 excepted.

    Args:
        env: when its episodes are drawn and nothing has moved yet.
        seeds: one per episode.
    """
    simulation = env.simulation
    to = sides([np.random.default_rng(seed) for seed in seeds], simulation.dof)
    to[np.array(seeds) == 0] = 0.0
    if to.any():
        simulation.set_state(moved(simulation.get_state(), to, CLOUD))
