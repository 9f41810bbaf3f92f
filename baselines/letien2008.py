"""Le Tien's friction observer with measured feedback.

L. Le Tien, A. Albu-Schaeffer, A. De Luca, G. Hirzinger, "Friction Observer and Compensation for Control of Robots
with Joint Torque Measurement", IROS 2008; as compared in arXiv:1907.00553.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_bandwidth, check_gain, check_share
from fo_gym import JointInfo, Signals

Array = NDArray[np.float64]

__all__ = ["LeTienObserver", "letien_high", "letien_low"]


class LeTienObserver:
    """tau_f_hat = -gain B L e', e' = theta_n' - theta': the first-order low-pass L / (s + L) of tau_f.

    The controller gets the measured motor, so theta_n is an open integrator that runs away; only its velocity counts.

    Args:
        L: bandwidth [1/s], above 0.
        gain: share of the estimate that is applied, in (0, 1]; its authors are said to advise 0.99 for passivity.
    """

    feedback = "measured"
    search_space: ClassVar[dict[str, tuple[float, float]]] = {"L": (20.0, 400.0)}

    def __init__(self, L: float, gain: float = 1.0) -> None:
        self.L = check_gain(self, "L", L)
        self.gain = check_share(self, "gain", gain)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes. Raises ValueError where L is too fast for the sampling."""
        check_bandwidth(self, self.L, joints)
        self._inertia = joints.motor_inertia

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        return -self.gain * self._inertia * self.L * (signals.theta_n_dot - signals.theta_dot)


# Gains of arXiv:1907.00553, section V; a keyword replaces one of them.


def letien_low(L: float = 50.0, gain: float = 1.0) -> LeTienObserver:
    """Le Tien's observer with the paper's low gain."""
    return LeTienObserver(L, gain)


def letien_high(L: float = 100.0, gain: float = 1.0) -> LeTienObserver:
    """Le Tien's observer with the paper's high gain."""
    return LeTienObserver(L, gain)
