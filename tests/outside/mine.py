"""A compensator in a file of one's own, which data are said to have trained, with a gain to tune."""

from typing import ClassVar

import numpy as np


class Mine:
    feedback = "measured"
    learned = True
    search_space: ClassVar = {"level": (0.2, 5.0)}

    def __init__(self, level=1.0):
        self.level = level

    def reset(self, joints, num_envs):
        pass

    def estimate(self, signals):
        return -self.level * np.sign(signals.theta_d - signals.theta)
