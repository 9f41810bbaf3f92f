"""What the tests of the environments share."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest

import fo_gym

IDS = tuple(fo_gym.ENVIRONMENTS)
SQUARE_ID = "FJRSquare-v0"
every_env = pytest.mark.parametrize("env_id", IDS)


def make(env_id, **arguments):
    """The environment itself, reset."""
    env = gym.make(env_id, **arguments).unwrapped
    env.reset(seed=0)
    return env


def drive(env, steps=100, amplitude=1.0):
    """Observations (steps, size) under sinusoids of the largest action, another frequency for every joint."""
    phase = np.arange(1, env.simulation.dof + 1) * 0.05
    return np.array([env.step(amplitude * env.action_space.high * np.sin(k * phase))[0] for k in range(steps)])
