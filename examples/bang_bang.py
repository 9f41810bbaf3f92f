"""A compensator of one's own: Coulomb friction in the direction of the desired motion, ten lines and no base class.

fo-gym evaluate examples/bang_bang.py:BangBang --env FJRStiction-v0
"""

import numpy as np

import fo_gym


class BangBang:
    """Push with a constant torque towards the target, as long as it is farther away than a dead zone."""

    feedback = "measured"

    def __init__(self, level: float = 1.0, dead_zone: float = 2e-4) -> None:
        self.level = level
        self.dead_zone = dead_zone

    def reset(self, joints: fo_gym.JointInfo, num_envs: int) -> None:
        """Nothing to remember."""

    def estimate(self, signals: fo_gym.Signals) -> np.ndarray:
        """tau_f_hat, (num_envs, dof): friction opposes the motion towards the target."""
        error = signals.theta_d - signals.theta
        return -self.level * np.sign(error) * (np.abs(error) > self.dead_zone)
