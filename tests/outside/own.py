"""An environment in a file of one's own: a reference of its own kind, for any arm."""

from dataclasses import dataclass

import numpy as np

import fo_gym
from fo_gym.robots.poses import joint_range


@dataclass(frozen=True, eq=False)
class Reach(fo_gym.Step):
    """A step by a share of the way from home to the upper end of each joint's range."""

    def fitted_to(self, robot):
        _, high = joint_range(robot.link_side.model)
        return fo_gym.Step(size=self.size * (np.minimum(high, 3.0) - robot.home), time=self.time)


def reach(robot):
    return fo_gym.Task(Reach(size=0.05), duration=0.2)


fo_gym.register("Own-v0", "miro_like", reach)
