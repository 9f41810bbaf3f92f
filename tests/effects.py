"""Effects of the hardware by themselves: two joints of one robot, without a plant."""

from __future__ import annotations

import numpy as np

from fo_gym.hardware import Effect, Episodes, HardwareDraw, Readings, Truth
from fo_gym.hardware.rehearsal import begun

DT = 1e-3
TORQUE_LIMIT = np.array([2.0, 3.0])


def joints(**values):
    """How two joints of one robot are: what is not given is 0."""
    given = {name: np.broadcast_to(np.asarray(value, dtype=float), (1, 2)) for name, value in values.items()}
    return Truth(**{name: given.get(name, np.zeros((1, 2))) for name in Truth._fields})


def begin(effect, *, tachometer=False, drawn=None, **truth):
    """The episode of an effect at its start."""
    draw = HardwareDraw(None, 1.0, None, {effect.name: drawn or {}}, {effect.name: 7})
    nothing = Episodes(DT, TORQUE_LIMIT, tachometer, np.zeros((1, 1)), joints(**truth), {}, {}, [])
    return begun(effect, nothing, [draw])


def measured(effect: Effect, episodes: Episodes, **truth) -> Readings:
    """What it makes of perfect readings of these joints, (dof,) each."""
    episodes.truth = joints(**truth)
    return Readings(*(array[0] for array in effect.measure(episodes.truth.readings, episodes)))
