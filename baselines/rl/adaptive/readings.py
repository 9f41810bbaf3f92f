"""What readings and commands of the past say of the loop: how late commands are, and how stiff the controller is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WATCHED = 1.0
"""Time over which the delay of commands is watched [s]."""
EXACT = 1e-3
"""Share of what moves tau_c that a joint's own position and velocity may leave unexplained."""

__all__ = ["ControllerStiffness", "DelayedTorque"]


class DelayedTorque:
    """The control torque as the motors get it: late by the delay that fits the torques which were applied.

    The delay is the one of 0, 1, ... control periods for which sum |tau_m - what was commanded then| is least.

    Args:
        delays: how many are told apart.
        shape: (num_envs, dof).
        ticks: over which it is watched; it stays from then on.
    """

    def __init__(self, delays: int, shape: tuple[int, int], ticks: int) -> None:
        self._commands = np.zeros((delays, *shape))
        self._torques = np.zeros((delays, *shape))
        self._misfit = np.zeros((delays, shape[0]))
        self._rows, self._tick, self._ticks = np.arange(shape[0]), 0, ticks
        self.delay = np.zeros(shape[0], dtype=np.intp)

    def now(self, tau_c: Array, tau_m: Array) -> Array:
        """This tick's tau_c and applied tau_m; the torque that reaches the motors now."""
        if len(self._commands) < self._tick < self._ticks:
            self._misfit += np.abs(tau_m - self._commands).sum(axis=-1)
            self.delay = self._misfit.argmin(axis=0)
        if self._tick == 0:
            self._torques[:] = tau_c
        self._torques[1:] = self._torques[:-1]
        self._torques[0] = tau_c
        self._tick += 1
        return np.asarray(self._torques[self.delay, self._rows])

    def commanded(self, tau_m: Array) -> None:
        """What is commanded at this tick."""
        if self._tick >= self._ticks:
            return
        self._commands[1:] = self._commands[:-1]
        self._commands[0] = tau_m


class ControllerStiffness:
    """K_p and K_d of the controller, where each joint has its own: tau_c = -K_p (theta - theta_d) - K_d theta' + const.

    From differences between blocks over which the target rests, by least squares. Where more than `EXACT` of the
    differences of tau_c is left unexplained the joints are coupled, and both are 0.

    Args:
        shape: (num_envs, dof).

    Attributes:
        kp, kd: [N/m | N m/rad], [N s/m | N m s/rad], (num_envs, dof).
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        self.kp, self.kd = np.zeros(shape), np.zeros(shape)
        self._sums = np.zeros((6, *shape))
        self._before: tuple[Array, Array, Array, Array] | None = None

    def block(self, theta: Array, theta_dot: Array, tau_c: Array, theta_d: Array) -> None:
        """Take the signals at the end of a block."""
        now = (theta - theta_d, theta_dot.copy(), tau_c.copy(), theta_d.copy())
        if self._before is not None:
            rests = now[3] == self._before[3]
            x, v, y = (np.where(rests, now[i] - self._before[i], 0.0) for i in range(3))
            self._sums += np.stack([x * x, x * v, v * v, -x * y, -v * y, y * y])
            self._solve()
        self._before = now

    def _solve(self) -> None:
        xx, xv, vv, xy, vy, yy = self._sums
        determinant = xx * vv - xv**2
        known = determinant > 1e-6 * xx * vv
        divisor = np.where(known, determinant, 1.0)
        kp, kd = (vv * xy - xv * vy) / divisor, (xx * vy - xv * xy) / divisor
        exact = known & (yy - kp * xy - kd * vy <= EXACT * yy) & (kp > 0.0) & (kd >= 0.0)
        self.kp, self.kd = np.where(exact, kp, 0.0), np.where(exact, kd, 0.0)
