"""The memory of a joint: the sums of a Bayesian linear regression over its rows, and what follows from them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.rl.adaptive.rows import COLUMNS, INERTIA, PERIODS, RIPPLE, Row, Scales
from baselines.rl.adaptive.weights import Weights

Array = NDArray[np.float64]

BANK = len(PERIODS)
LEAST = 1e-6
"""Of a mean square, so that it has a logarithm."""
SOFT, SOFTER = 0.1, 0.01
"""Shares of the prior's precision, where a period is chosen, and where it is measured what rows leave unexplained."""
STRETCH = 0.3
"""Of the logarithms in a summary, which brings them to about one."""

__all__ = ["BANK", "LEAST", "SOFT", "SOFTER", "STRETCH", "Memory"]


class Memory:
    """Sums over the rows x of a batch of joints: of w x x^T, and of w, on both sides of the motion apart.

    With the prior N(mean, 1 / precision) of the coefficients and a trust k in the rows, their posterior mean solves

        (k sum w x x^T + precision) (c - mean) = k sum w x (y - x . mean)

    The ripple's two columns are those of the period in the bank that explains most of what the others leave.

    Args:
        weights: what was learned.
        shape: of the batch, (num_envs, dof).

    Attributes:
        chosen: place in the bank of each joint's period, (num_envs, dof).
    """

    def __init__(self, weights: Weights, shape: tuple[int, ...]) -> None:
        self.weights = weights
        self._precision = np.exp(weights.precision)
        self._mean = weights.mean
        # Of sums over pairs of columns what is read: all with those of a row and the torque, and each period's own.
        self._sums = np.zeros((*shape, COLUMNS + 1, COLUMNS + 1 + 2 * BANK))
        self._own = np.zeros((*shape, 3, BANK))
        self._sides = np.zeros((*shape, 3))
        self.chosen = np.zeros(shape, dtype=np.intp)
        self._system = np.zeros((*shape, COLUMNS + 2, COLUMNS + 2)), np.zeros((*shape, COLUMNS + 2))

    def add(self, row: Row) -> None:
        """Take a row."""
        columns = row.columns.copy()
        columns[..., COLUMNS] -= columns[..., 2:COLUMNS] @ self._mean
        angle = row.turned[..., None] / PERIODS
        sine, cosine = RIPPLE * np.sin(angle), RIPPLE * np.cos(angle)
        weight = self.weights.weight(row.inputs) * np.abs(row.side)
        weighted = columns * weight[..., None]
        self._sums += weighted[..., None] * np.concatenate([columns, sine, cosine], axis=-1)[..., None, :]
        own = sine * weight[..., None]
        self._own[..., 0, :] += own * sine
        self._own[..., 1, :] += np.square(cosine) * weight[..., None]
        self._own[..., 2, :] += own * cosine
        self._sides[..., 0] += weight
        self._sides[..., 1] += np.where(row.side > 0.0, weight, 0.0)
        self._sides[..., 2] += np.where(row.side < 0.0, weight, 0.0)

    def choose(self) -> None:
        """Choose each joint's period of the ripple: the one that explains most of what the other columns leave."""
        known = self._sums[..., :COLUMNS, :COLUMNS] + np.diag(SOFT * self._precision[:COLUMNS])
        bank = self._sums[..., :COLUMNS, COLUMNS + 1 :]
        torque = self._sums[..., :COLUMNS, COLUMNS, None]
        solved = np.linalg.solve(known, np.concatenate([bank, torque], axis=-1))
        left = self._sums[..., COLUMNS, COLUMNS + 1 :] - np.sum(bank * solved[..., -1:], axis=-2)
        sine, cosine = bank[..., :BANK], solved[..., BANK:-1]
        both = np.sum(bank * solved[..., :-1], axis=-2)
        a = self._own[..., 0, :] - both[..., :BANK] + SOFTER
        b = self._own[..., 1, :] - both[..., BANK:] + SOFTER
        c = self._own[..., 2, :] - np.sum(sine * cosine, axis=-2)
        s, t = left[..., :BANK], left[..., BANK:]
        self.chosen = np.argmax((b * s**2 - 2.0 * c * s * t + a * t**2) / np.maximum(a * b - c**2, LEAST), axis=-1)

    def gather(self) -> None:
        """Put together the equations with the chosen periods."""
        matrix, right = self._system
        i, j = np.ogrid[: self.chosen.shape[0], : self.chosen.shape[1]]
        matrix[..., :COLUMNS, :COLUMNS] = self._sums[..., :COLUMNS, :COLUMNS]
        right[..., :COLUMNS] = self._sums[..., :COLUMNS, COLUMNS]
        for place, first in ((COLUMNS, COLUMNS + 1), (COLUMNS + 1, COLUMNS + 1 + BANK)):
            column = self._sums[i, j, :, first + self.chosen]
            matrix[..., :COLUMNS, place] = matrix[..., place, :COLUMNS] = column[..., :COLUMNS]
            right[..., place] = column[..., COLUMNS]
            matrix[..., place, place] = self._own[i, j, place - COLUMNS, self.chosen]
        matrix[..., COLUMNS, COLUMNS + 1] = matrix[..., COLUMNS + 1, COLUMNS] = self._own[i, j, 2, self.chosen]

    def trust(self, zero: Array) -> Array:
        """In the rows so far, (num_envs, dof), by what they leave unexplained, how much they weigh, and on which sides.

        Args:
            zero: unit of the zero as a share of FRICTION of the torque limit, which a row's first column is.
        """
        matrix, right = self._system
        coefficients = _solved(matrix + np.diag(SOFTER * self._precision), right)
        total = self._sums[..., COLUMNS, COLUMNS]
        weight, plus, minus = (self._sides[..., side] for side in range(3))
        left = np.maximum((total - np.sum(coefficients * right, axis=-1)) / (weight + 1.0), LEAST)
        plus, minus = np.log1p(plus), np.log1p(minus)
        summary = np.stack(
            [
                np.log(left),
                np.log(np.maximum(total / (weight + 1.0), LEAST)),
                np.log1p(weight),
                plus + minus,
                np.abs(plus - minus),
                np.log(zero),
            ],
            axis=-1,
        )
        return self.weights.trust(STRETCH * summary) / left

    def answer(self, trust: Array, scales: Scales) -> tuple[Array, Array]:
        """The zero [N | N m], and the share of B by which it is believed too large, (num_envs, dof) each."""
        matrix, right = self._system
        trusted = matrix * trust[..., None, None] + np.diag(self._precision)
        coefficients = _solved(trusted, right * trust[..., None])
        return coefficients[..., 0] * scales.zero, coefficients[..., 1] * INERTIA


def _solved(matrix: Array, right: Array) -> Array:
    return np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0])
