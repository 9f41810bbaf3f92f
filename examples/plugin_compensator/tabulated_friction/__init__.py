"""A learned friction compensator: a table of friction against speed, and an observer for what it does not know."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import fo_gym

TABLE = Path(__file__).with_name("table.npz")
"""What `learn.py` wrote: plain arrays, which are loaded without unpickling."""

__all__ = ["TABLE", "TabulatedFriction"]


class TabulatedFriction:
    """tau_f_hat = -B (table(|theta_n'|) sign(theta_n') + L (e' + L_p e)), e = theta_n - theta.

    The table is looked up at the speed that the motor would have without friction, so that it pushes before the motor
    moves; a PD-type observer estimates the rest.

    Args:
        table: an .npz file with `speed` (n,), rising from 0 [m/s or rad/s], and `friction` (n,), per motor inertia.
        L: bandwidth of the observer [1/s].
        Lp: [1/s].
    """

    feedback = "nominal"
    learned = True  # `learn.py` trained it

    def __init__(self, table: str | Path = TABLE, L: float = 100.0, Lp: float = 20.0) -> None:
        with np.load(table, allow_pickle=False) as arrays:
            self.speed, self.friction = arrays["speed"], arrays["friction"]
        self.L, self.Lp = L, Lp

    def reset(self, joints: fo_gym.JointInfo, num_envs: int) -> None:
        """Start new episodes; only the motor inertia is remembered."""
        self.inertia = joints.motor_inertia

    def estimate(self, signals: fo_gym.Signals) -> np.ndarray:
        """tau_f_hat, (num_envs, dof), N or N m."""
        known = np.interp(np.abs(signals.theta_n_dot), self.speed, self.friction) * np.sign(signals.theta_n_dot)
        e = signals.theta_n - signals.theta
        e_dot = signals.theta_n_dot - signals.theta_dot
        return -self.inertia * (known + self.L * (e_dot + self.Lp * e))
