"""What the figures of the reproduction share: thinned lines, and the gains as they are written beside them."""

from __future__ import annotations

import numpy as np

from fo_gym.reproduction.figures.style import KINDS, gains_label, thin


def test_thinning_keeps_extremes_and_ends() -> None:
    time = np.linspace(0.0, 20.0, 200_001)
    values = np.sin(time)
    values[[12_345, 150_001]] = 7.0, -5.0
    few, kept = thin(time, values, bins=100)
    assert len(few) == len(kept) <= 2 * 100 + 2
    assert (kept.max(), kept.min()) == (7.0, -5.0)
    assert (few[kept.argmax()], few[kept.argmin()]) == (time[12_345], time[150_001])
    assert (few[0], few[-1]) == (0.0, 20.0)
    assert np.all(np.diff(few) > 0)


def test_thinning_leaves_short_traces_alone() -> None:
    time = np.arange(200.0)
    assert thin(time, time, bins=100)[1] is time


def test_gains_are_those_that_the_observer_has() -> None:
    assert [gains_label("high", kind).count("=") for kind in KINDS] == [3, 2, 1]
    assert "25" in gains_label("low", "pid")
