"""What a block of a joint's readings says: a row of a linear regression on what is not friction, and on friction.

The momentum of the motor tells the torque that is left when readings and beliefs are taken for true,

    r = B theta'' + tau_j - tau_m = tau_f + ripple + zero + (B - B_true) theta''

Everything on the right but the first two terms is not friction. One block cannot tell them apart. Over a motion with
reversals they differ: friction turns with the velocity, v; its ripple comes back with the position; the zero stays;
the error of inertia turns with the acceleration. A row holds these shapes, scaled by torques that do not change, so
that the coefficients do not change either:

    zero            1, in units of sqrt((Z limit)^2 + (W tau_j at the start)^2)    nulled at rest, where the load erred
    inertia         0.05 B theta''                                                in units of 5 % of B
    load            sgn(v) |tau_j|                                                dry friction grows with the load
    viscous         v
    curve           sgn(v) times hats over log |v|                                any curve over the velocity
    presliding      sgn(v) exp(-distance since the reversal / x), three x         any law's memory, roughly
    ripple          sin and cos of 2 pi theta / period, for each period of a bank
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FRICTION = 0.03
"""A torque that friction is about as large as, as a share of the torque limit: scales, no knowledge of a joint."""
ZERO, LOADED = 6e-4, 3e-3
"""Of the zero's unit: shares of the torque limit, and of the load at the start."""
INERTIA = 0.05
RATE, SLOW = 100.0, 30.0
"""A velocity in these units is B RATE v / torque; below 1 / SLOW of it hardly anything is learned."""
CURVE = np.linspace(np.log(0.02), np.log(8.0), 8)
"""Where hats have their peaks, logarithms of velocities in units of torque / (B RATE)."""
PRESLIDING = (0.03, 0.3, 2.0)
STIFFNESS = 4000.0
"""A distance in these units is B STIFFNESS x / torque."""
PERIODS = 12.5 * 1.075 ** np.arange(30)
"""The bank's periods, likewise."""
RIPPLE = 0.1

COLUMNS = 4 + len(CURVE) + len(PRESLIDING)
"""Of a row, without the ripple's."""
INPUTS = ("speed", "fine speed", "distance", "fine distance", "load", "acceleration")
"""What the weight of a row may depend on."""

__all__ = ["COLUMNS", "INPUTS", "PERIODS", "RIPPLE", "Block", "Row", "Rows", "Scales"]


class Block(NamedTuple):
    """Readings of one block, arrays of one shape.

    Attributes:
        torque: r, its mean [N | N m].
        velocity, acceleration: mean ones [m/s | rad/s], [m/s^2 | rad/s^2].
        tau_j: its mean [N | N m].
    """

    torque: Array
    velocity: Array
    acceleration: Array
    tau_j: Array


class Scales(NamedTuple):
    """What rows are scaled by, arrays like a block's.

    Attributes:
        inertia: B as it is believed.
        friction: FRICTION of the torque limit.
        zero: unit of the zero [N | N m].
        period: time of a block [s].
    """

    inertia: Array
    friction: Array
    zero: Array
    period: float

    @classmethod
    def of(cls, inertia: Array, limit: Array, tau_j: Array, period: float) -> Scales:
        """From the torque limit and the load at the start."""
        return cls(inertia, FRICTION * limit, np.sqrt((ZERO * limit) ** 2 + (LOADED * tau_j) ** 2), period)


class Row(NamedTuple):
    """What a block says, arrays with the axes of a block first.

    Attributes:
        columns: of all but the ripple, then the torque, (..., COLUMNS + 1).
        turned: position at the middle of the block as an angle, of a ripple of period 1, (...).
        inputs: of its weight, see INPUTS, (..., len(INPUTS)).
        side: of the motion: 0 at rest, else between -1 and 1, (...).
    """

    columns: Array
    turned: Array
    inputs: Array
    side: Array


class Rows:
    """Rows of consecutive blocks of a batch of joints. What it remembers: the way since a reversal, and the largest r.

    Args:
        scales: arrays of one shape, that of every block.
    """

    def __init__(self, scales: Scales) -> None:
        self.scales = scales
        self._largest = 2.0 / 3.0 * scales.friction
        self._way = np.zeros_like(scales.friction)
        self._theta = np.zeros_like(scales.friction)

    def row(self, block: Block) -> Row:
        """The next block's."""
        columns, turned, side = self.shapes(block)
        return Row(columns, turned, self.inputs(block), side)

    def shapes(self, block: Block) -> tuple[Array, Array, Array]:
        """Of the next block's row: columns, turned, side."""
        scales = self.scales
        inertia, unit = scales.inertia, scales.friction
        step = block.velocity * scales.period
        self._way = np.where(self._way * step >= 0.0, self._way + step, step)
        turned = (2.0 * np.pi * STIFFNESS) * inertia * (self._theta + 0.5 * step) / unit
        self._theta = self._theta + step
        self._largest = np.maximum(self._largest, np.abs(block.torque))
        side, way = np.sign(block.velocity), np.abs(self._way) * (STIFFNESS * inertia / unit)
        speed = np.abs(block.velocity) * (RATE * inertia / unit)
        columns = np.empty((*unit.shape, COLUMNS + 1))
        columns[..., 0] = scales.zero / unit
        columns[..., 1] = INERTIA * inertia * block.acceleration / unit
        columns[..., 2] = 0.1 * side * np.abs(block.tau_j) / unit
        columns[..., 3] = 0.3 * side * speed
        place = np.clip(np.log(speed + 1e-9), CURVE[0], CURVE[-1])[..., None]
        columns[..., 4 : 4 + len(CURVE)] = np.maximum(0.0, 1.0 - np.abs(place - CURVE) / (CURVE[1] - CURVE[0]))
        columns[..., 4 + len(CURVE) : COLUMNS] = np.exp(-way[..., None] / PRESLIDING)
        columns[..., 4:COLUMNS] *= side[..., None]
        columns[..., COLUMNS] = block.torque / unit
        return columns, turned, side * self._moving(block)

    def _moving(self, block: Block) -> Array:
        """Between 0 at rest and 1: at standstill a bristle holds any torque, and nothing can be learned."""
        squared = np.square(block.velocity * (SLOW * RATE) * self.scales.inertia / self._largest)
        return np.asarray(squared / (1.0 + squared))

    def inputs(self, block: Block) -> Array:
        """Of the weight of the row whose shapes came last: even functions, in units of the largest r so far."""
        largest, scales = self._largest, self.scales
        way = np.abs(self._way) * (STIFFNESS * scales.inertia / scales.friction)
        speed = np.abs(block.velocity) * (RATE * scales.inertia / largest)
        inputs = np.empty((*way.shape, len(INPUTS)))
        inputs[..., 0] = SLOW * speed
        inputs[..., 1] = speed
        inputs[..., 2] = way
        inputs[..., 3] = RATE * way
        inputs[..., 4] = np.abs(block.tau_j) / largest
        inputs[..., 5] = np.abs(block.acceleration) * scales.inertia / largest
        return np.asarray(np.arcsinh(inputs))
