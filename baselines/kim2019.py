"""PID- and PD-type friction observers with nominal feedback.

M. J. Kim, F. Beck, C. Ott, A. Albu-Schaeffer, "Model-free Friction Observers for Flexible Joint Robots with Torque
Measurements", arXiv:1907.00553. With e = theta_n - theta, the lag of the motor behind the nominal, friction-free one:

    PID-type   tau_f_hat = -B L (e' + L_p e + L_i int e)     a (3,2)-order low-pass of tau_f
    PD-type    tau_f_hat = -B L (e' + L_p e)                 a (2,1)-order low-pass of tau_f

In discrete time the integral is the sum of control_dt times the past ticks' e.

Gains are numbers, or arrays that broadcast against (num_envs, dof): one value for each joint or environment.

The two with measured feedback are the ablation: the same low-passes of tau_f, without what makes them come to rest.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_bandwidth, check_gains
from fo_gym import JointInfo, Signals
from fo_gym.checks import Value

Array = NDArray[np.float64]

__all__ = [
    "MeasuredPDObserver",
    "MeasuredPIDObserver",
    "PDObserver",
    "PIDObserver",
    "pd",
    "pd_high",
    "pd_low",
    "pd_measured",
    "pid",
    "pid_high",
    "pid_low",
    "pid_measured",
]


class PDObserver:
    """tau_f_hat = -B L (e' + L_p e), e = theta_n - theta.

    tau_f_hat / tau_f = L (s + L_p) / (s^2 + L s + L L_p). At rest e = -tau_f / (B L L_p): it stops off the target.

    Args:
        L: bandwidth [1/s], above 0.
        Lp: [1/s], above 0.
    """

    feedback = "nominal"
    array_gains = True
    search_space: ClassVar[dict[str, tuple[float, float]]] = {"L": (20.0, 400.0), "Lp": (4.0, 80.0)}

    def __init__(self, L: Value, Lp: Value) -> None:
        self.L = check_gains(self, "L", L)
        self.Lp = check_gains(self, "Lp", Lp)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes. Raises ValueError where L is too fast for the sampling."""
        check_bandwidth(self, self.L, joints)
        self._gain = joints.motor_inertia * self.L

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        e = signals.theta_n - signals.theta
        e_dot = signals.theta_n_dot - signals.theta_dot
        return -self._gain * (e_dot + self.Lp * e)


class PIDObserver:
    """tau_f_hat = -B L (e' + L_p e + L_i int e), e = theta_n - theta.

    tau_f_hat / tau_f = L (s^2 + L_p s + L_i) / (s^3 + L s^2 + L L_p s + L L_i). No error remains at rest, but the
    integral may hunt with stiction.

    Args:
        L: bandwidth [1/s], above 0.
        Lp: [1/s], above 0.
        Li: [1/s^2], above 0, with Lp^2 > 2 Li (the paper's condition, for its Q > 0).
    """

    feedback = "nominal"
    array_gains = True
    search_space: ClassVar[dict[str, tuple[float, float]]] = {
        "L": (20.0, 400.0),
        "Lp": (4.0, 80.0),
        "Li": (1.0, 1600.0),
    }

    def __init__(self, L: Value, Lp: Value, Li: Value) -> None:
        self.L = check_gains(self, "L", L)
        self.Lp = check_gains(self, "Lp", Lp)
        self.Li = check_gains(self, "Li", Li)
        for lp, li in np.broadcast(self.Lp, self.Li):
            if not lp**2 > 2.0 * li:
                raise ValueError(
                    f"PIDObserver: Lp^2 = {lp**2:g} is not above 2 Li = {2 * li:g}; "
                    f"raise Lp above {np.sqrt(2 * li):.4g} or lower Li below {lp**2 / 2:.4g}"
                )

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes with an empty integral. Raises ValueError where L is too fast for the sampling."""
        check_bandwidth(self, self.L, joints)
        self._gain = joints.motor_inertia * self.L
        self._dt = joints.control_dt
        self._integral = np.zeros((num_envs, joints.dof))

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        e = signals.theta_n - signals.theta
        e_dot = signals.theta_n_dot - signals.theta_dot
        estimate = -self._gain * (e_dot + self.Lp * e + self.Li * self._integral)
        self._integral += self._dt * e
        return estimate


class MeasuredPDObserver(PDObserver):
    """PDObserver with measured feedback: theta follows theta_d itself, and nothing ties theta_n to the target."""

    feedback = "measured"


class MeasuredPIDObserver(PIDObserver):
    """PIDObserver with measured feedback: theta follows theta_d itself, and nothing ties theta_n to the target."""

    feedback = "measured"


# Gains of arXiv:1907.00553, section V; a keyword replaces one of them. In both of its sets L_p = L/5 and L_i = L^2/100.


def pid(L: Value = 100.0, Lp: Value | None = None, Li: Value | None = None) -> PIDObserver:
    """PID-type observer with any L, and what is not given in the proportions of the paper's gains."""
    return PIDObserver(L, L / 5.0 if Lp is None else Lp, L**2 / 100.0 if Li is None else Li)


def pd(L: Value = 100.0, Lp: Value | None = None) -> PDObserver:
    """PD-type observer with any L, and what is not given in the proportions of the paper's gains."""
    return PDObserver(L, L / 5.0 if Lp is None else Lp)


def pid_low(L: float = 50.0, Lp: float = 10.0, Li: float = 25.0) -> PIDObserver:
    """PID-type observer with the paper's low gains."""
    return PIDObserver(L, Lp, Li)


def pid_high(L: float = 100.0, Lp: float = 20.0, Li: float = 100.0) -> PIDObserver:
    """PID-type observer with the paper's high gains."""
    return PIDObserver(L, Lp, Li)


def pd_low(L: float = 50.0, Lp: float = 10.0) -> PDObserver:
    """PD-type observer with the paper's low gains."""
    return PDObserver(L, Lp)


def pd_high(L: float = 100.0, Lp: float = 20.0) -> PDObserver:
    """PD-type observer with the paper's high gains."""
    return PDObserver(L, Lp)


def pid_measured(L: float = 100.0, Lp: float = 20.0, Li: float = 100.0) -> MeasuredPIDObserver:
    """PID-type observer with the paper's high gains and measured feedback."""
    return MeasuredPIDObserver(L, Lp, Li)


def pd_measured(L: float = 100.0, Lp: float = 20.0) -> MeasuredPDObserver:
    """PD-type observer with the paper's high gains and measured feedback."""
    return MeasuredPDObserver(L, Lp)
