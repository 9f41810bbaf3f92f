"""The micro-step of an environment: the default for what is shipped, "auto" for the rest, whoever is beside it."""

from __future__ import annotations

from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest
from environments import IDS, drive, every_env, make

import fo_gym

DRAWS = 100
# A bristle without damping that is 100 times harder than the paper's.
HARD = {"sigma_0": 1e7, "sigma_1": 0.0}


@every_env
def test_default_and_auto_follow_every_draw(env_id: str) -> None:
    """Both are accepted at reset; "auto" is chosen before anything is drawn, and no draw is faster than it allows."""
    for physics_dt in (None, "auto"):
        env = gym.make_vec(env_id, num_envs=DRAWS, variant="randomized", physics_dt=physics_dt).unwrapped
        env.reset(seed=0)
        simulation = env.simulation
        starts = np.array([scenario.q_start for scenario in simulation.scenarios])
        assert simulation.plant.physics_dt <= simulation.plant.advise(np.arange(DRAWS), starts).physics_dt.min()


def test_auto_is_the_longest_that_follows_the_ranges() -> None:
    """The paper's friction damping, sqrt(1e5) + 0.4, at its fastest: a range's ends, and a tenth of headroom."""
    nominal = make("FJRStiction-v0", physics_dt="auto").simulation.plant
    assert nominal.steps == int(np.ceil(1e-3 * (1e5**0.5 + 0.4) / (0.9 * 0.125))) == 3
    drawn = make("FJRStiction-v0", physics_dt="auto", variant="randomized").simulation.plant
    assert drawn.steps == int(np.ceil(1e-3 * (2e5**0.5 + 0.8) / 0.75 / (0.9 * 0.125))) == 6
    still = fo_gym.Randomization(**dict.fromkeys(("bristle", "viscous", "motor_inertia"), (1.0, 1.0)))
    undrawn = make("FJRStiction-v0", physics_dt="auto", variant="randomized", randomization=still)
    assert undrawn.simulation.plant.steps == nominal.steps


@pytest.mark.parametrize("env_id", IDS[:2])
def test_auto_runs_what_the_default_refuses_and_alone_is_as_in_a_batch(env_id: str) -> None:
    friction = replace(make(env_id).simulation.robot.friction, **HARD)
    arguments = {"friction": friction, "variant": "randomized", "duration": 1.0}
    with pytest.raises(ValueError, match=r"the ringing of its bristle.*use a physics_dt of at most"):
        gym.make(env_id, **arguments)
    batch = gym.make_vec(env_id, num_envs=3, physics_dt="auto", **arguments)
    observation, _ = batch.reset(seed=5)
    env = make(env_id, physics_dt="auto", **arguments)
    alone, _ = env.reset(seed=6)
    np.testing.assert_array_equal(observation[1], alone)
    for k in range(20):
        action = np.float64(0.3 * env.action_space.high * np.sin(0.3 * k))
        observation, *_ = batch.step(np.stack([0.0 * action, action, -action]))
        alone, *_ = env.step(action)
        np.testing.assert_array_equal(observation[1], alone)
    assert np.isfinite(drive(env)).all()
