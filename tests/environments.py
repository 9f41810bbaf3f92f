"""What the tests of the environments share."""

from __future__ import annotations

import re
import warnings

import gymnasium as gym
import numpy as np
import pytest

import fo_gym

IDS = tuple(fo_gym.ENVIRONMENTS)
SQUARE_ID = "FJRSquare-v0"
TOOL_IDS = (SQUARE_ID, "FJRInteraction-v0")
"""Where the tool is what follows the reference."""
# Deliberate: actions are torques in physical units, observations are in physical units and unbounded, all in float64.
GYMNASIUM_TOLERATED = {
    "For Box action spaces, we recommend using a symmetric and normalized space (range=[-1, 1] or [0, 1]). "
    "See https://stable-baselines3.readthedocs.io/en/master/guide/rl_tips.html for more information.",
    "A Box observation space minimum value is -infinity. This is probably too low.",
    "A Box observation space maximum value is infinity. This is probably too high.",
}
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


def told_by(checker, env):
    """What a checker of environments warns of, each in plain text."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        checker(env, skip_render_check=True)
    return {re.sub(r"\x1b\[\d+m", "", str(warning.message)).removeprefix("WARN: ") for warning in caught}
