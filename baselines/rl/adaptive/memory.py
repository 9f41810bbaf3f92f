"""The memory of a joint: the sums of a Bayesian linear regression over its rows, and what follows from them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.rl.adaptive.rows import COLUMNS, INERTIA, PERIODS, RIPPLE, Row, Scales
from baselines.rl.adaptive.weights import SUMMARY, Weights

Array = NDArray[np.float64]

BANK = len(PERIODS)
LEAST = 1e-6
"""Of a mean square, and of a determinant beside its diagonal, so that they have logarithms."""
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

    A joint whose signals are exact is no unlikely corner of that prior, but a case of its own, in which zero and
    inertia are 0. The evidence against that case is the Savage-Dickey ratio of their densities there:

        evidence = log p(0) - log p(0 | rows) = (m^T C^-1 m + log(det C det P)) / 2

    with their posterior mean m and covariance C, and their prior precision P. What is answered is m times the share
    1 / (1 + exp(-odds_0 - exp(odds_1) evidence)). The odds were learned, for what errors cost: no calibrated
    probability.

    Args:
        weights: what was learned.
        shape: of the batch, (num_envs, dof).

    Attributes:
        chosen: place in the bank of each joint's period, (num_envs, dof).
        posterior: of zero and inertia, in units: its mean, then its covariance, (num_envs, dof, 2, 3).
    """

    def __init__(self, weights: Weights, shape: tuple[int, ...]) -> None:
        self.weights = weights
        self._prior = np.diag(np.exp(weights.precision))
        self._softer, self._soft = SOFTER * self._prior, SOFT * self._prior[:COLUMNS, :COLUMNS]
        self._mean = weights.mean
        # Of sums over pairs of columns what is read: all with those of a row and the torque, and each period's own.
        self._sums = np.zeros((*shape, COLUMNS + 1, COLUMNS + 1 + 2 * BANK))
        self._own = np.zeros((*shape, 3, BANK))
        self._sides = np.zeros((*shape, 3))
        self.chosen = np.zeros(shape, dtype=np.intp)
        self._row = np.zeros((*shape, COLUMNS + 1 + 2 * BANK))
        self._system = np.zeros((*shape, COLUMNS + 2, COLUMNS + 2)), np.zeros((*shape, COLUMNS + 2))
        self._sought = np.zeros((*shape, COLUMNS + 2, 3))
        self._sought[..., 0, 1] = self._sought[..., 1, 2] = 1.0
        self.solve(np.zeros(shape))

    def weigh(self, row: Row) -> None:
        """Say what a row is worth."""
        self._weight = self.weights.weight(row.inputs) * np.abs(row.side)

    def add(self, row: Row) -> None:
        """Add it to the sums, as it was weighed."""
        mine, weight = self._row, self._weight
        mine[..., : COLUMNS + 1] = row.columns
        mine[..., COLUMNS] -= row.columns[..., 2:COLUMNS] @ self._mean
        angle = row.turned[..., None] / PERIODS
        sine, cosine = mine[..., COLUMNS + 1 : -BANK], mine[..., -BANK:]
        np.sin(angle, out=sine)
        np.cos(angle, out=cosine)
        mine[..., COLUMNS + 1 :] *= RIPPLE
        weighted = mine * weight[..., None]
        self._sums += weighted[..., : COLUMNS + 1, None] * mine[..., None, :]
        self._own[..., 0, :] += weighted[..., COLUMNS + 1 : -BANK] * sine
        self._own[..., 1, :] += weighted[..., -BANK:] * cosine
        self._own[..., 2, :] += weighted[..., COLUMNS + 1 : -BANK] * cosine
        self._sides[..., 0] += weight
        self._sides[..., 1] += weight * (row.side > 0.0)
        self._sides[..., 2] += weight * (row.side < 0.0)

    def choose(self, joints: slice = slice(None)) -> None:
        """Choose these joints' period of the ripple: the one that explains most of what the other columns leave."""
        sums, own = self._sums[:, joints], self._own[:, joints]
        known = sums[..., :COLUMNS, :COLUMNS] + self._soft
        solved = np.linalg.solve(known, sums[..., :COLUMNS, COLUMNS:])
        bank, torque = sums[..., :COLUMNS, COLUMNS + 1 :], solved[..., :1]
        left = sums[..., COLUMNS, COLUMNS + 1 :] - np.sum(bank * torque, axis=-2)
        both = np.sum(bank * solved[..., 1:], axis=-2)
        a = own[..., 0, :] - both[..., :BANK] + SOFTER
        b = own[..., 1, :] - both[..., BANK:] + SOFTER
        c = own[..., 2, :] - np.sum(bank[..., :BANK] * solved[..., 1 + BANK :], axis=-2)
        s, t = left[..., :BANK], left[..., BANK:]
        explained = (b * s**2 - 2.0 * c * s * t + a * t**2) / np.maximum(a * b - c**2, LEAST)
        self.chosen[:, joints] = np.argmax(explained, axis=-1)

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

    def explain(self) -> None:
        """Find what the rows so far leave unexplained, however they are trusted."""
        matrix, right = self._system
        coefficients = _solved(matrix + self._softer, right)
        explained = np.sum(coefficients * right, axis=-1)
        self._left = np.maximum((self._sums[..., COLUMNS, COLUMNS] - explained) / (self._sides[..., 0] + 1.0), LEAST)

    def trust(self, zero: Array) -> Array:
        """In the rows so far, (num_envs, dof), by what they leave unexplained, how much they weigh, and on which sides.

        Args:
            zero: unit of the zero as a share of FRICTION of the torque limit, which a row's first column is.
        """
        weight, plus, minus = np.moveaxis(np.log1p(self._sides), -1, 0)
        total = self._sums[..., COLUMNS, COLUMNS] / (self._sides[..., 0] + 1.0)
        summary = np.empty((*self._left.shape, len(SUMMARY)))
        summary[..., 0] = np.log(self._left)
        summary[..., 1] = np.log(np.maximum(total, LEAST))
        summary[..., 2] = weight
        summary[..., 3] = plus + minus
        summary[..., 4] = np.abs(plus - minus)
        summary[..., 5] = np.log(zero)
        return self.weights.trust(STRETCH * summary) / self._left

    def solve(self, trust: Array) -> None:
        """Find the posterior of zero and inertia, with so much trust in the rows so far, (num_envs, dof)."""
        matrix, right = self._system
        self._sought[..., 0] = right * trust[..., None]
        self.posterior = np.linalg.solve(matrix * trust[..., None, None] + self._prior, self._sought)[..., :2, :]

    def answer(self, scales: Scales) -> tuple[Array, Array]:
        """The zero [N | N m], and the share of B by which it is believed too large, (num_envs, dof) each."""
        zero, inertia = self.posterior[..., 0, 0], self.posterior[..., 1, 0]
        share = self._share(zero, inertia, self.posterior[..., 1:])
        return share * zero * scales.zero, share * inertia * INERTIA

    def _share(self, zero: Array, inertia: Array, covariance: Array) -> Array:
        """What is answered of the posterior mean, (num_envs, dof), 0 to 1."""
        a, b, c = covariance[..., 0, 0], covariance[..., 1, 1], covariance[..., 0, 1]
        area = np.maximum(a * b - c**2, LEAST * a * b)  # above 0, however alike the two look
        squared = (b * zero**2 - 2.0 * c * zero * inertia + a * inertia**2) / area
        evidence = 0.5 * (squared + np.log(area * self._prior[0, 0] * self._prior[1, 1]))
        return self.weights.share(evidence)


def _solved(matrix: Array, right: Array) -> Array:
    return np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0])
