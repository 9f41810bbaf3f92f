"""A compensator, under the entry points `fo_gym.compensators`."""

import numpy as np


class Constant:
    """A constant estimate."""

    feedback = "measured"

    def __init__(self, level=0.5):
        self.level = level

    def reset(self, joints, num_envs):
        self.shape = (num_envs, joints.dof)

    def estimate(self, signals):
        return np.full(self.shape, -self.level)
