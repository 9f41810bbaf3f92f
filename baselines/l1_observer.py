"""An L1 adaptive friction observer.

A fast adaptive estimate sigma_hat of friction, of which a low-pass is applied: the adaptation gain can be as high as
the sampling allows, the bandwidth of what reaches the motor is K alone. The equations are those of program code
published beside a study of KAIST, and *unverified*: we could not compare them with a paper. With a predictor theta_p of
its own (not the suite's theta_n) and e = theta_p - theta:

    sigma_hat = -B G / (1 + G dt) ((1 + G_p dt) e' + G_p e)
    tau_f_hat = K / (s + K) sigma_hat
    B theta_p'' = tau_c - tau_j + sigma_hat - tau_f_hat

so that sigma_hat / tau_f is about (s + G_p) G / (s^2 + G s + G G_p), near 1 up to G. Discrete time, dt = control_dt:
the low-pass is exact for an input that is held over the past period, theta_p by the semi-implicit Euler step that
sigma_hat's form is derived from. The predictor moves with tau_m = tau_c - tau_f_hat as the motor got it.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_gain
from fo_gym import JointInfo, Signals

Array = NDArray[np.float64]

_LARGEST_STEP = 0.5

__all__ = ["L1Observer", "l1"]


class L1Observer:
    """tau_f_hat = K / (s + K) sigma_hat with measured feedback.

    Args:
        G: adaptation gain [1/s], above 0.
        Gp: weight of the position error [1/s], above 0.
        K: cut-off of the low-pass [1/s], above 0.
    """

    feedback = "measured"
    search_space: ClassVar[dict[str, tuple[float, float]]] = {
        "G": (1e3, 1e5),
        "Gp": (20.0, 400.0),
        "K": (20.0, 400.0),
    }

    def __init__(self, G: float, Gp: float, K: float) -> None:
        self.G = check_gain(self, "G", G)
        self.Gp = check_gain(self, "Gp", Gp)
        self.K = check_gain(self, "K", K)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes, the predictor on the motor. Raises ValueError where Gp is too fast for the sampling."""
        dt = joints.control_dt
        if self.Gp * dt > _LARGEST_STEP:
            raise ValueError(
                f"L1Observer: Gp = {self.Gp} 1/s is too fast for an estimate every {dt} s; "
                f"keep Gp at most {_LARGEST_STEP / dt:.6g} 1/s, or sample faster"
            )
        self._inertia = joints.motor_inertia
        self._dt = dt
        self._gain = self.G / (1.0 + self.G * dt)
        self._share = -np.expm1(-self.K * dt)
        self._filtered, self._rest = np.zeros((2, num_envs, joints.dof))
        self._theta: Array | None = None

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        dt = self._dt
        if self._theta is None:
            self._theta, self._theta_dot = signals.theta.copy(), signals.theta_dot.copy()
        else:
            self._theta_dot = self._theta_dot + dt * (signals.tau_m + self._rest) / self._inertia
            self._theta = self._theta + dt * self._theta_dot
        e, e_dot = self._theta - signals.theta, self._theta_dot - signals.theta_dot
        sigma = -self._inertia * self._gain * ((1.0 + self.Gp * dt) * e_dot + self.Gp * e)
        self._filtered = self._filtered + self._share * (sigma - self._filtered)
        self._rest = sigma - signals.tau_j  # what moves the predictor over the coming period, beside the motor torque
        return self._filtered


def l1(G: float = 1e4, Gp: float = 100.0, K: float = 150.0) -> L1Observer:
    """The L1 observer with the gains of the published code, at the upper end of its K of 120 to 150 1/s."""
    return L1Observer(G, Gp, K)
