"""What an episode leaves behind: the record from which every metric is computed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.tasks.hand import Hand
from fo_gym.tasks.scenario import Push

Array = NDArray[np.float64]

__all__ = ["Episode", "Motion", "Push"]


@dataclass(frozen=True)
class Motion:
    """Where the motors and the tool were, tick by tick, and how a hand pulled.

    Attributes:
        theta: motor positions, (ticks, dof), m or rad.
        tool: tool position in the world, (ticks, 3), m; None where the task has no tool path.
        f_hand: mean force of the hand on the tool, (periods, 3), N; None where no hand guides it.
        lost: work that friction, and what compensates it, took from the motors beyond the controller without friction
            on this motion, (tau_free - tau_m - tau_dist)' (theta[k+1] - theta[k]), (periods,), J; tau_free is the
            control torque for the true theta and theta_dot at the beginning of the period. None where no hand guides
            the tool.
    """

    theta: Array
    tool: Array | None
    f_hand: Array | None = None
    lost: Array | None = None

    @property
    def scored(self) -> Array:
        """The signal y that the friction rejection ratio compares, (ticks, size)."""
        return self.theta if self.tool is None else self.tool


@dataclass(frozen=True, eq=False)
class Episode:
    """One episode of one competitor, with the two references that its score needs.

    `ticks` = `periods` + 1. Arrays over ticks hold values at the ticks 0..N; arrays over periods hold
    what was applied, or averaged, from tick k to tick k + 1.

    Attributes:
        dt: time between two ticks, s (control_dt x decimation).
        joint_unit: "m" or "rad".
        motion: theta and tool of the competitor.
        ideal: the same episode without anything that disturbs the motors.
        none: the same episode without compensation.
        theta_dot, q, q_dot, theta_n, theta_n_dot: over ticks, (ticks, dof).
        theta_d: desired motor position, (ticks, dof).
        tool_d: desired tool position, (ticks, 3), m, or None.
        tau_f_hat: estimate that was applied, (periods, dof), N or N m.
        tau_f: true friction torque, mean over each period, (periods, dof); it opposes motion.
        tau_dist: true disturbance of the motors, mean over each period, (periods, dof): tau_f, and what gears and other
            effects add. It is what an estimate is compared with, since no observer can tell one from the other.
        tau_m, tau_ext: motor torque and external torque as applied, means over the periods, (periods, dof).
        torque_limit: (dof,), N or N m.
        step_time: when the target last jumped, s; None where the reference moves smoothly.
        limit_cycle_window: (start, end) in s where a limit cycle is looked for, or None.
        motion_window: (start, end) in s where the reference moves along its path, or None.
        push: the external push of the episode, or None.
        stored: energy in the joints when the push begins, J; NaN without one.
        termination: "" or why the episode ended early ("joint_limit" | "non_finite"). After the end
            every array holds its last finite value.
        hand: the hand that guides the tool, or None.
        damped: work that the controller without friction takes on this motion and does not store, (periods,), J:
            (tau_held - tau_free)' (theta[k+1] - theta[k]), where tau_held is the control torque for the true theta at
            rest, the mean of both ends of the period. None where no hand guides the tool.
    """

    dt: float
    joint_unit: str
    motion: Motion
    ideal: Motion
    none: Motion
    theta_dot: Array
    q: Array
    q_dot: Array
    theta_n: Array
    theta_n_dot: Array
    theta_d: Array
    tool_d: Array | None
    tau_f_hat: Array
    tau_f: Array
    tau_dist: Array
    tau_m: Array
    tau_ext: Array
    torque_limit: Array
    step_time: float | None
    limit_cycle_window: tuple[float, float] | None
    motion_window: tuple[float, float] | None
    push: Push | None
    stored: float
    termination: str
    hand: Hand | None = None
    damped: Array | None = None

    @property
    def duration(self) -> float:
        """Length of the episode, s."""
        return self.dt * (len(self.motion.theta) - 1)

    @property
    def moved_until(self) -> float:
        """When the reference last jumped or moved along its path, s; 0 where it never does."""
        return max(self.step_time or 0.0, self.motion_window[1] if self.motion_window else 0.0)

    def ticks(self, start: float, end: float) -> slice:
        """Ticks from `start` to `end` (both in s, both included)."""
        return slice(round(start / self.dt), round(end / self.dt) + 1)
