"""Compensators that say more than their estimate, and some that say it wrongly, for tests/test_diagnostics.py."""

from __future__ import annotations

import numpy as np

from baselines import PIDObserver


class Half(PIDObserver):
    """It tells half of its estimate, and its environments' numbers."""

    def __init__(self) -> None:
        super().__init__(L=100.0, Lp=20.0, Li=100.0)

    def estimate(self, signals):
        self.told = super().estimate(signals)
        return self.told

    @property
    def diagnostics(self):
        return {"half": 0.5 * self.told, "where": np.broadcast_to(np.arange(len(self.told))[:, None], self.told.shape)}


class Twice(Half):
    """It tells something of its first two estimates, and nothing of the others."""

    def reset(self, joints, num_envs):
        super().reset(joints, num_envs)
        self.ticks = 0

    def estimate(self, signals):
        self.ticks += 1
        return super().estimate(signals)

    @property
    def diagnostics(self):
        return super().diagnostics if self.ticks <= 2 else {}


class Short(Half):
    @property
    def diagnostics(self):
        return {"half": np.zeros(3)}


class Listed(Half):
    @property
    def diagnostics(self):
        return [1.0]


class Worded(Half):
    @property
    def diagnostics(self):
        return {"half": "much"}
