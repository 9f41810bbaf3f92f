"""Networks of random weights and what they are shown, for the tests of the learned compensators."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

import fo_gym
from baselines.rl import Design
from baselines.rl.loop import FEATURES
from baselines.rl.network import Network
from fo_gym import Signals

DT, DOF, ENVS = 1e-3, 3, 4
RESIDUAL, DIRECT = Design(), Design(residual=False, bound=2.0)
LAYERS = (len(FEATURES), 5, 1)


def joints(limit=1e-3, control_dt=DT):
    """Joints whose torque limit is so low that the floor of the friction scale does not matter."""
    inertia = np.linspace(0.5, 1.5, ENVS * DOF).reshape(ENVS, DOF)
    return fo_gym.JointInfo(DOF, inertia, np.full((ENVS, DOF), 3e3), np.full((ENVS, DOF), limit), control_dt)


def history(ticks=20, seed=0, factor=1.0):
    rng = np.random.default_rng(seed)
    return [Signals.from_observation(factor * rng.normal(size=(ENVS, 8 * DOF + 1)), DOF) for _ in range(ticks)]


def network(seed=0, squash="clip", scale=1.0):
    rng = np.random.default_rng(seed)
    shapes = pairwise(LAYERS)
    return Network(tuple(scale * rng.normal(size=shape).astype(np.float32).astype(float) for shape in shapes), squash)


def run(compensator, signals, info=None):
    compensator.reset(info or joints(), ENVS)
    return np.array([compensator.estimate(each).copy() for each in signals])
