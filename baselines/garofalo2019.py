"""A sliding-mode (super-twisting) momentum observer.

G. Garofalo, N. Mansfeld, J. Jankowski, C. Ott, "Sliding Mode Momentum Observers for Estimation of External Torques and
Joint Acceleration", ICRA 2019, on the motor side, p = B theta' and p~ = p_hat - p:

    p_hat' = tau_m - tau_j - T_1 |p~|^(1/2) sgn p~ - T_2 p~ + s
    s'     = -S_1 sgn p~ - S_2 p~,      tau_f_hat = s

Where S_1 exceeds the rate |tau_f'|, s equals tau_f after a finite time, not only in the limit.

Discrete time: implicit Euler for p~ and s, the sign included (set-valued at 0), which has a solution in closed form. It
does not chatter: while it slides, p~ = 0 exactly and s is tau_f as its mean over the past period. tau_m is what was
applied over the past period.
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_gain
from fo_gym import JointInfo, Signals

Array = NDArray[np.float64]

__all__ = ["SuperTwistingObserver", "supertwisting"]


class SuperTwistingObserver:
    """tau_f_hat = s of the super-twisting momentum observer, with measured feedback.

    Args:
        S1: largest rate of friction that is followed exactly [N/s | N m/s], above 0.
        T1: [(N | N m) / (momentum)^(1/2)], above 0; 2 sqrt(S1) is a usual choice.
        S2: linear part [1/s^2], above 0.
        T2: linear part [1/s], above 0; 2 sqrt(S2) damps it critically.
    """

    feedback = "measured"
    search_space: ClassVar[dict[str, tuple[float, float]]] = {
        "S1": (10.0, 2000.0),
        "T1": (3.0, 100.0),
        "S2": (100.0, 40_000.0),
        "T2": (20.0, 400.0),
    }

    def __init__(self, S1: float, T1: float, S2: float, T2: float) -> None:
        self.S1 = check_gain(self, "S1", S1)
        self.T1 = check_gain(self, "T1", T1)
        self.S2 = check_gain(self, "S2", S2)
        self.T2 = check_gain(self, "T2", T2)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes without an estimate. The implicit step is stable at any control_dt."""
        self._inertia = joints.motor_inertia
        self._dt = joints.control_dt
        self._s = np.zeros((num_envs, joints.dof))
        self._predicted: Array | None = None

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        momentum = self._inertia * signals.theta_dot
        error = np.zeros_like(self._s)
        if self._predicted is not None:
            error = self._correct(self._predicted + self._dt * signals.tau_m - momentum)
        # What is known now of the coming period; the motor torque in it is known at its end.
        self._predicted = momentum + error + self._dt * (self._s - signals.tau_j)
        return self._s

    def _correct(self, predicted: Array) -> Array:
        """Advance s by one period; returns p~ at its end.

        `predicted` is p~ as it would be with s unchanged and no T_1, T_2. The implicit equations add up to

            (1 + T_2 dt + S_2 dt^2) p~ + T_1 dt |p~|^(1/2) sgn p~ + S_1 dt^2 sgn p~ = predicted

        a quadratic equation in |p~|^(1/2), whose solution is p~ = 0 where |predicted| <= S_1 dt^2.
        """
        dt = self._dt
        linear, root = 1.0 + self.T2 * dt + self.S2 * dt**2, self.T1 * dt
        excess = np.maximum(np.abs(predicted) - self.S1 * dt**2, 0.0)
        error = np.sign(predicted) * np.square((np.sqrt(root**2 + 4.0 * linear * excess) - root) / (2.0 * linear))
        sign = np.clip(predicted / (self.S1 * dt**2), -1.0, 1.0)
        self._s = self._s - dt * (self.S1 * sign + self.S2 * error)
        return error


def supertwisting(
    S1: float = 200.0, T1: float = 2.0 * math.sqrt(200.0), S2: float = 2500.0, T2: float = 100.0
) -> SuperTwistingObserver:
    """The super-twisting observer with gains of ours, its linear part as fast as the paper's low gains."""
    return SuperTwistingObserver(S1, T1, S2, T2)
