"""The memory of the adaptive compensator: what it tells from friction, and whether there is anything to tell."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import expit
from scipy.stats import multivariate_normal

from baselines.rl.adaptive.memory import Memory
from baselines.rl.adaptive.rows import COLUMNS, INERTIA, PERIODS, Block, Rows, Scales
from baselines.rl.adaptive.weights import SHAPES, Weights

PERIOD = 1e-2


class TestMemory:
    def blocks(self, n=400):
        """A joint that swings under dry friction, viscous friction and ripple, with a zero and a wrong inertia."""
        t = PERIOD * np.arange(n)
        theta = 0.2 * np.sin(2.0 * t) + 0.1 * np.sin(5.3 * t)
        v = np.gradient(theta, PERIOD)
        a = np.gradient(v, PERIOD)
        ripple = 0.3 * np.sin(2.0 * np.pi * theta / self.period + 1.0)
        r = -5.0 * np.sign(v) - 2.0 * v + ripple + self.zero + self.error * self.inertia * a
        return [Block(*(np.full((1, 1), each[k]) for each in (r, v, a, np.zeros(n)))) for k in range(n)]

    zero, error, inertia, limit = 0.2, 0.06, 1.2, 150.0
    period = PERIODS[12] * 0.03 * limit / (4000.0 * inertia)
    precision = np.linspace(-1.0, 1.0, COLUMNS + 2)

    def weights_with(self, **given):
        """All others are 0."""
        zeros = {name: np.zeros(shape) for name, shape in SHAPES.items()}
        return Weights(**(zeros | {name: np.asarray(value, dtype=float) for name, value in given.items()}))

    def answer(self, made):
        ones = np.ones((1, 1))
        scales = Scales.of(self.inertia * ones, self.limit * ones, 0.0 * ones, PERIOD)
        rows, memory = Rows(scales), Memory(made, (1, 1))
        for block in self.blocks():
            row = rows.row(block)
            memory.weigh(row)
            memory.add(row)
        memory.choose()
        memory.gather()
        memory.explain()
        memory.solve(memory.trust(scales.zero / scales.friction))
        return memory, *memory.answer(scales)

    def test_it_tells_zero_and_inertia_from_friction_and_ripple(self):
        """Whatever the weights: rows that are trusted have one solution. The bank has the ripple's period."""
        memory, zero, error = self.answer(self.weights_with(trust_level=[3.0]))
        assert zero.item() == pytest.approx(self.zero, abs=0.05)
        assert error.item() == pytest.approx(self.error, abs=0.01)
        assert abs(memory.chosen.item() - 12) <= 2

    def test_the_odds_follow_from_the_densities_at_nothing(self):
        """Against SciPy: prior density over posterior density where zero and inertia are 0 (Savage and Dickey)."""
        some = {"trust_level": [-6.0], "precision": self.precision}
        sure, odd = self.weights_with(**some, odds=[30.0, 0.0]), self.weights_with(**some, odds=[1.0, -3.0])
        memory, zero, error = self.answer(sure)
        posterior = memory.posterior[0, 0]
        mean, covariance = posterior[:, 0], posterior[:, 1:]
        np.testing.assert_allclose([zero.item() / (6e-4 * self.limit), error.item() / INERTIA], mean, rtol=1e-9)
        before = multivariate_normal([0.0, 0.0], np.diag(np.exp(-self.precision[:2]))).logpdf([0.0, 0.0])
        after = multivariate_normal(mean, covariance).logpdf([0.0, 0.0])
        share = expit(1.0 + np.exp(-3.0) * (before - after))
        assert 0.1 < share < 0.99
        _, less, smaller = self.answer(odd)
        np.testing.assert_allclose([less / zero, smaller / error], share, rtol=1e-9)

    def test_what_looks_exact_is_taken_for_exact(self):
        """By the same weights, a motion with zero and error is corrected in full, and one without hardly at all."""
        even = self.weights_with(trust_level=[3.0])
        _, zero, error = self.answer(even)
        assert zero.item() == pytest.approx(self.zero, abs=0.05)
        assert error.item() == pytest.approx(self.error, abs=0.01)
        exact = TestMemory()
        exact.zero = exact.error = 0.0
        sure = self.weights_with(trust_level=[3.0], odds=[30.0, 0.0])
        (_, *believed), (_, *doubted) = exact.answer(sure), exact.answer(even)
        assert np.abs(doubted).max() > 0.0
        assert (np.abs(doubted) < 0.1 * np.abs(believed)).all()

    def test_who_trusts_nothing_learns_nothing(self):
        _, zero, error = self.answer(self.weights_with(trust_level=[-20.0]))
        assert abs(zero.item()) < 1e-3 * self.zero
        assert abs(error.item()) < 1e-3

    def test_nothing_is_learned_at_standstill(self):
        ones = np.ones((1, 1))
        rows = Rows(Scales.of(ones, 100.0 * ones, ones, PERIOD))
        assert rows.row(Block(5.0 * ones, 0.0 * ones, 0.0 * ones, ones)).side.item() == 0.0

    @pytest.mark.slow
    def test_training_computes_the_same(self):
        torch = pytest.importorskip("torch")
        from baselines.rl.adaptive.model import Model, episodes_of  # noqa: PLC0415

        model = Model(0)
        model.odds.data = torch.tensor([0.0, -3.0])  # else so much evidence makes the share 1
        _, zero, error = self.answer(model.weights())
        blocks = np.array([[part.item() for part in block] for block in self.blocks()], dtype=np.float32)[None]
        scales = np.array([[self.inertia, 0.03 * self.limit, 6e-4 * self.limit]], dtype=np.float32)
        with torch.no_grad():
            trained = model(episodes_of(blocks, scales, PERIOD), [len(blocks[0])])[0, 0].numpy()
        assert zero.item() / (6e-4 * self.limit) == pytest.approx(trained[0], abs=2e-3)
        assert error.item() / INERTIA == pytest.approx(trained[1], abs=2e-3)
