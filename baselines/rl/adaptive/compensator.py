"""The adaptive compensator: the PID-type observer, around a nominal motor that learns what is not friction."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_bandwidth
from baselines.rl.adaptive.design import AdaptiveDesign
from baselines.rl.adaptive.memory import Memory
from baselines.rl.adaptive.readings import WATCHED, ControllerStiffness, DelayedTorque
from baselines.rl.adaptive.rows import Block, Row, Rows, Scales
from baselines.rl.adaptive.storage import load_weights
from baselines.rl.adaptive.weights import Weights
from fo_gym import JointInfo, Signals

Array = NDArray[np.float64]

SHIPPED = Path(__file__).parents[1] / "weights" / "rl-adaptive"
"""Folder of the training whose weights come with the package."""

_PARTS = 10
"""Of the work of a block, one a tick."""
_ANSWER, _CHOOSE = 2, 20
"""Blocks between two answers, and between two choices of a joint's period of the ripple, one joint after the other."""

__all__ = ["SHIPPED", "AdaptiveCompensator", "rl_adaptive"]


class AdaptiveCompensator:
    """The PID-type observer of arXiv:1907.00553, around a nominal motor that allows for what is not friction.

        tau_f_hat = -min(B, B^) L (e' + L_p e + L_i int e) + K_p e + K_d e',     e = theta_n - theta
        B^ theta_n'' = tau_c(late) - K_p e - K_d e' - (tau_j - zero),      B^ = (1 - error) B

    The controller gets the measured motor; K_p and K_d, which this compensator sees in tau_c, make of that what it
    would say of the nominal motor: with zero = error = 0 this is nominal feedback, wherever each joint has a gain of
    its own. `late` is the delay of commands, which shows in the torques that were applied. What is learned never
    raises the gains, neither as such nor over B^: with B alone, or B^ alone, fast joints and late commands may swing.

    `zero`, of the torque sensor, and `error`, of what is believed of B, are not friction, and an observer takes them
    for it. They are learned slowly, from blocks of readings: see `Rows` for what a block says, `Memory` for what all of
    them say together. Both are the same for any joint and robot. The work of a block is spread over its ticks.

    Args:
        design: gains, time of a block, bounds.
        weights: what was learned; None learns nothing: the observer beneath.

    Attributes:
        zero, error: as estimated, (num_envs, dof) [N | N m] and [1].
    """

    feedback = "measured"
    learned = True

    def __init__(self, design: AdaptiveDesign, weights: Weights | None) -> None:
        self.design, self.weights = design, weights

    @classmethod
    def load(cls, weights: str | Path) -> AdaptiveCompensator:
        """From a file NAME.safetensors with its card. Raises ValueError where they cannot be trusted or used."""
        return cls(*load_weights(Path(weights)))

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes. Raises ValueError where control_dt does not suit the observer or the blocks."""
        check_bandwidth(self, self.design.L, joints)
        self._ticks, self._dt = joints.ticks("it learns", self.design.period, _PARTS), joints.control_dt
        shape = (num_envs, joints.dof)
        self._believed = np.broadcast_to(joints.motor_inertia, shape).copy()
        self._limit = np.broadcast_to(joints.torque_limit, shape).copy()
        self._late = DelayedTorque(self.design.delays(self._dt), shape, round(WATCHED / self._dt))
        self._stiffness = ControllerStiffness(shape)
        self._memory = None if self.weights is None else Memory(self.weights, shape)
        self.zero, self.error, self._acceleration = np.zeros((3, *shape))
        self._inertia, self._gain = self._believed, self.design.L * self._believed
        self._integral, self._sum = np.zeros(shape), np.zeros(shape)
        self._tau_j_sum = np.zeros(shape)
        self._tick = 0

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        if self._tick == 0:
            self._begin(signals)
        else:
            self._read(signals)
        late = self._late.now(signals.tau_c, signals.tau_m)
        e, e_dot = self._theta_n - signals.theta, self._theta_n_dot - signals.theta_dot
        spring = self._stiffness.kp * e + self._stiffness.kd * e_dot
        estimate = spring - self._gain * (e_dot + self.design.Lp * e + self.design.Li * self._integral)
        estimate = np.minimum(np.maximum(estimate, -self._limit), self._limit)
        self._integral += self._dt * e
        self._driving = late - spring
        self._late.commanded(signals.tau_c - estimate)
        self._tick += 1
        return estimate

    @property
    def correction(self) -> Array:
        """What they change in what is taken for friction, -zero - error B theta_n'', (num_envs, dof) [N | N m]."""
        return -self.zero - self.error * self._believed * self._acceleration

    @property
    def diagnostics(self) -> dict[str, Array]:
        """What it has learned that is not friction, as torques: the zero, and the correction."""
        return {"zero": self.zero, "correction": self.correction}

    def _begin(self, signals: Signals) -> None:
        """The nominal motor starts from the measured one; so does the first block."""
        self._theta_n, self._theta_n_dot = signals.theta.copy(), signals.theta_dot.copy()
        self._tau_j = signals.tau_j.copy()
        self._start = signals.theta.copy(), signals.theta_dot.copy()
        self._scales = Scales.of(self._believed, self._limit, signals.tau_j, self.design.period)
        self._rows = Rows(self._scales)

    def _read(self, signals: Signals) -> None:
        """Take the past period's readings: the nominal motor moves; at the ends of blocks, and after them, learn."""
        phase = self._tick % self._ticks
        # tau_m acted from the tick before to this one, and so did tau_j, whose readings are at the ticks. To hold the
        # first of them over the period, as others do, would feed the fast modes of springs.
        tau_j = 0.5 * (self._tau_j + signals.tau_j)
        self._move(tau_j)
        self._sum += signals.tau_m
        self._tau_j_sum += tau_j
        self._tau_j[:] = signals.tau_j
        if phase == 0:
            self._end_block(signals)
        elif phase == 1 and self._tick > self._ticks:
            self._stiffness.block(*self._start, *self._commanded)
        if self._memory is not None and self._tick > self._ticks:
            self._learn(self._memory, phase, self._tick // self._ticks)

    def _move(self, tau_j: Array) -> None:
        """The nominal motor, over the past period."""
        acceleration = (self._driving - tau_j + self.zero) / self._inertia
        self._theta_n += self._dt * self._theta_n_dot + (0.5 * self._dt**2) * acceleration
        self._theta_n_dot += self._dt * acceleration
        self._acceleration = acceleration

    def _end_block(self, signals: Signals) -> None:
        theta, theta_dot = self._start
        velocity = (signals.theta - theta) / self.design.period
        acceleration = (signals.theta_dot - theta_dot) / self.design.period
        tau_j, tau_m = self._tau_j_sum / self._ticks, self._sum / self._ticks
        self._block = Block(self._believed * acceleration + tau_j - tau_m, velocity, acceleration, tau_j)
        self._sum[:] = self._tau_j_sum[:] = 0.0
        self._start = signals.theta.copy(), signals.theta_dot.copy()
        self._commanded = signals.tau_c.copy(), signals.theta_d.copy()

    def _learn(self, memory: Memory, phase: int, block: int) -> None:
        """One part of what a block has to be done with, by the tick within it."""
        answers = block % _ANSWER == 0
        if phase == 2:
            self._shapes = self._rows.shapes(self._block)
        elif phase == 3:
            columns, turned, side = self._shapes
            self._row = Row(columns, turned, self._rows.inputs(self._block), side)
            memory.weigh(self._row)
        elif phase == 4:
            memory.add(self._row)
        elif phase == 5:
            memory.choose(slice(block % _CHOOSE, None, _CHOOSE))
        elif phase == 6 and answers:
            memory.gather()
        elif phase == 7 and answers:
            memory.explain()
        elif phase == 8 and answers:
            self._trust = memory.trust(self._scales.zero / self._scales.friction)
        elif phase == 9 and answers:
            memory.solve(self._trust)
        elif phase == 9:  # of the block after the one whose rows were solved
            self._believe(*memory.answer(self._scales))

    def _believe(self, zero: Array, error: Array) -> None:
        """From now on, within the bounds."""
        bound, most = self.design.largest_zero * self._limit, self.design.largest_error
        self.zero = np.minimum(np.maximum(zero, -bound), bound)
        self.error = np.minimum(np.maximum(error, -most), most)
        self._inertia = (1.0 - self.error) * self._believed
        self._gain = self.design.L * np.minimum(self._inertia, self._believed)


def rl_adaptive(weights: str | Path = SHIPPED / "policy.safetensors") -> AdaptiveCompensator:
    """The adaptive compensator, trained on the single link and on random chains."""
    return AdaptiveCompensator.load(weights)
