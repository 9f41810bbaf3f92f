"""The weights in torch, and what follows from them for whole episodes: what `Memory` computes, with its gradient."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from baselines.rl.adaptive.memory import BANK, LEAST, SOFT, SOFTER, STRETCH
from baselines.rl.adaptive.rows import COLUMNS, PERIODS, RIPPLE, Block, Rows, Scales
from baselines.rl.adaptive.weights import LOG_WEIGHT, SHAPES, Weights

ROW = COLUMNS + 1
_SINES, _COSINES = slice(ROW, ROW + BANK), slice(ROW + BANK, ROW + 2 * BANK)

__all__ = ["Episodes", "Model", "episodes_of"]

Episodes = tuple[Tensor, Tensor, Tensor, Tensor]
"""The parts of `Row`, (n, blocks, ...) each."""


def episodes_of(blocks: NDArray[np.float32], scales: NDArray[np.float32], period: float) -> Episodes:
    """The rows of joints' episodes, from their blocks (n, blocks, 4) and scales (n, 3)."""
    inertia, friction, zero = scales.astype(np.float64).T
    rows = Rows(Scales(inertia, friction, zero, period))
    made = [rows.row(Block(*block.astype(np.float64).T)) for block in blocks.transpose(1, 0, 2)]
    columns, turned, inputs, side = (
        torch.from_numpy(np.stack([part.astype(np.float32) for part in parts], axis=1))
        for parts in zip(*made, strict=True)
    )
    return columns, turned, inputs, side


class Model(nn.Module):
    """`Weights` that can be trained, named alike."""

    row_in: nn.Parameter
    row_bias: nn.Parameter
    row_out: nn.Parameter
    row_level: nn.Parameter
    trust_in: nn.Parameter
    trust_bias: nn.Parameter
    trust_out: nn.Parameter
    trust_level: nn.Parameter
    mean: nn.Parameter
    precision: nn.Parameter
    odds: nn.Parameter

    def __init__(self, seed: int) -> None:
        super().__init__()
        generator = torch.Generator().manual_seed(seed)
        start = {name: torch.zeros(shape) for name, shape in SHAPES.items()}
        for name in ("row_in", "row_out", "trust_in", "trust_out"):
            shape = SHAPES[name]
            start[name] = torch.randn(shape, generator=generator) / shape[0] ** 0.5
        start["row_level"] -= 1.0
        start["trust_level"] -= 2.0
        start["precision"][2:] -= 1.0
        start["odds"][0] += 1.0
        for name, value in start.items():
            setattr(self, name, nn.Parameter(value))

    def weights(self) -> Weights:
        """In NumPy."""
        return Weights(**{name: getattr(self, name).detach().numpy().astype(np.float64) for name in SHAPES})

    def forward(self, episodes: Episodes, ends: Sequence[int]) -> Tensor:
        """Coefficients of zero and inertia, (n, len(ends), 2), after so many blocks."""
        columns, turned, inputs, side = episodes
        angle = turned[..., None] / torch.from_numpy(PERIODS.astype(np.float32))
        left = columns[..., COLUMNS:] - (columns[..., 2:COLUMNS] @ self.mean)[..., None]
        row = torch.cat([columns[..., :COLUMNS], left, RIPPLE * torch.sin(angle), RIPPLE * torch.cos(angle)], dim=-1)
        hidden = torch.tanh(inputs @ self.row_in + self.row_bias)
        weight = torch.exp(torch.clamp(hidden @ self.row_out + self.row_level, *LOG_WEIGHT)) * side.abs()
        sides = torch.stack([weight, weight * (side > 0), weight * (side < 0)], dim=-1)
        sums, weighed, sum_, weigh, begin = [], [], torch.zeros(()), torch.zeros(()), 0
        for end in ends:
            part = row[:, begin:end]
            sum_ = sum_ + (part * weight[:, begin:end, None]).transpose(1, 2) @ part
            weigh = weigh + sides[:, begin:end].sum(1)
            sums.append(sum_)
            weighed.append(weigh)
            begin = end
        return self._answer(torch.stack(sums, 1), torch.stack(weighed, 1), columns[:, :1, 0])

    def _answer(self, sums: Tensor, sides: Tensor, unit: Tensor) -> Tensor:
        precision = torch.exp(self.precision)
        with torch.no_grad():
            period = _chosen(sums, precision)
        place = torch.stack([ROW + period, ROW + BANK + period], dim=-1)
        fixed = torch.arange(COLUMNS).expand(*period.shape, COLUMNS)
        columns = torch.cat([fixed, place], dim=-1)
        across = torch.gather(sums, -1, columns[..., None, :].expand(*sums.shape[:-1], COLUMNS + 2))
        matrix = torch.gather(across, -2, columns[..., :, None].expand(*columns.shape, COLUMNS + 2))
        right, total = across[..., COLUMNS, :], sums[..., COLUMNS, COLUMNS]
        loose = torch.linalg.solve(matrix + torch.diag(SOFTER * precision), right)
        weight, plus, minus = sides.unbind(-1)
        left = torch.clamp((total - (loose * right).sum(-1)) / (weight + 1.0), min=LEAST)
        plus, minus = torch.log1p(plus), torch.log1p(minus)
        summary = [
            torch.log(left),
            torch.log(torch.clamp(total / (weight + 1.0), min=LEAST)),
            torch.log1p(weight),
            plus + minus,
            (plus - minus).abs(),
            torch.log(unit).expand_as(left),
        ]
        hidden = torch.tanh(STRETCH * torch.stack(summary, dim=-1) @ self.trust_in + self.trust_bias)
        trust = torch.exp(torch.clamp(hidden @ self.trust_out + self.trust_level, -20.0, 20.0)) / left
        trusted = matrix * trust[..., None, None] + torch.diag(precision)
        sought = torch.eye(COLUMNS + 2)[:, :2].expand(*right.shape, 2)
        solved = torch.linalg.solve(trusted, torch.cat([(right * trust[..., None])[..., None], sought], dim=-1))
        return solved[..., :2, 0] * self._share(solved[..., :2, 0], solved[..., :2, 1:])[..., None]

    def _share(self, mean: Tensor, covariance: Tensor) -> Tensor:
        """What is answered of the posterior mean, as `Memory` computes it."""
        zero, inertia = mean.unbind(-1)
        a, b, c = covariance[..., 0, 0], covariance[..., 1, 1], covariance[..., 0, 1]
        area = torch.maximum(a * b - c**2, LEAST * a * b)
        squared = (b * zero**2 - 2.0 * c * zero * inertia + a * inertia**2) / area
        evidence = 0.5 * (squared + torch.log(area) + self.precision[:2].sum())
        return torch.sigmoid(self.odds[0] + torch.exp(self.odds[1]) * evidence)


def _chosen(sums: Tensor, precision: Tensor) -> Tensor:
    """Places of the ripples' periods in the bank, as `Memory.choose` finds them."""
    known = sums[..., :COLUMNS, :COLUMNS] + torch.diag(SOFT * precision[:COLUMNS])
    bank, torque = sums[..., :COLUMNS, ROW:], sums[..., :COLUMNS, COLUMNS:ROW]
    solved = torch.linalg.solve(known, torch.cat([bank, torque], dim=-1))
    left = sums[..., COLUMNS, ROW:] - (bank * solved[..., -1:]).sum(-2)
    both = (bank * solved[..., :-1]).sum(-2)
    own = torch.diagonal(sums, dim1=-2, dim2=-1)
    mixed = torch.diagonal(sums[..., _SINES, _COSINES], dim1=-2, dim2=-1)
    a, b = own[..., _SINES] - both[..., :BANK] + SOFTER, own[..., _COSINES] - both[..., BANK:] + SOFTER
    c = mixed - (bank[..., :BANK] * solved[..., BANK : 2 * BANK]).sum(-2)
    s, t = left[..., :BANK], left[..., BANK:]
    return torch.argmax((b * s**2 - 2.0 * c * s * t + a * t**2) / torch.clamp(a * b - c**2, min=LEAST), dim=-1)
