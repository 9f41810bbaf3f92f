"""Episodes in which a hand guides the tool, and what they score, in closed form."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from metric_episodes import DT, PERIODS, TIME, columns

from fo_gym.tasks.hand import Hand

HAND = Hand(1.0, 3, 0.5, 0.5, 0.1, 0.15, 0.1, 1000.0, 30.0, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
WAY, SPEED = HAND.at(TIME)
HELD = HAND.let_go > PERIODS


def pull(friction: float, damping: float = 50.0) -> np.ndarray:
    """Force of HAND on an arm that follows it, under 200 N/m, a damper [N s/m] and dry friction [N]."""
    midway, slow = (WAY[1:] + WAY[:-1]) / 2, np.abs(np.diff(WAY)) < 1e-12
    resistance = damping * (SPEED[1:] + SPEED[:-1]) / 2 + friction * np.where(slow, 0.0, np.sign(np.diff(WAY)))
    return HELD[:, None] * columns(200.0 * midway + resistance, 0.3, -0.2)


def gone(x: float, y: float) -> np.ndarray:
    """The tool follows HAND, and is at (x, y, 0) from a second after it let go [m]."""
    free = (HAND.let_go + 1.0 < TIME)[:, None]
    return np.where(free, [x, y, 0.0], columns(WAY, 0.0, 0.0))


GUIDED: dict[str, Any] = {"tool": gone(0.003, 0.004), "tool_ideal": gone(0.0, 0.0), "tool_none": gone(0.0, 0.0)}
GUIDED |= {"tool_d": 0.0 * TIME[:, None], "hand": HAND, "pulls": (pull(6.0), pull(0.0), pull(24.0))}
HOLDS = np.where((PERIODS > 0.9999) & (PERIODS < 7.5999), DT, 0.0)  # from the grip until it has let go
GUIDED |= {"losses": (6.0 * HOLDS, 0.0 * HOLDS, 24.0 * HOLDS), "damped": 0.0 * HOLDS}
DAMPED = 50.0 * float(np.sum((SPEED[1:] + SPEED[:-1]) / 2 * np.diff(WAY)))
SPENT = 0.5 * 200.0 * 0.15**2 + DAMPED
"""Work of the hand on the ideal arm: what the spring holds and the damper took, up to a thousandth."""
BURST = DT * np.where(np.abs(PERIODS - 5.4999) < 0.5, -2.0, 1.0)
"""What friction takes where the compensation gives 2 J within a second, else 1 J/s."""


def fed(energy: Any) -> dict[str, Any]:
    """GUIDED with this in place of what friction takes of the arm."""
    return {**GUIDED, "losses": (energy, *GUIDED["losses"][1:])}


HAND_CLOSED_FORM: list[tuple[str, float, dict[str, Any]]] = [
    ("hand_work_j", SPENT + 6.0 * 0.45, GUIDED),
    ("hand_work_j", SPENT - 2.0 * 0.45, {**GUIDED, "pulls": (pull(-2.0), pull(0.0), pull(24.0))}),
    ("hand_friction_work_ratio", 0.25, GUIDED),
    ("hand_friction_work_ratio", 0.5, fed(-12.0 * HOLDS + 9.0 * (HOLDS == 0.0))),
    ("apparent_friction_n", 6.0, GUIDED),
    ("apparent_friction_n", 4.0, {**GUIDED, "pulls": (pull(2.0, 70.0), pull(0.0), pull(24.0))}),
    ("apparent_friction_n", 3.0, {**GUIDED, "pulls": (pull(-3.0), pull(0.0), pull(24.0))}),
    ("return_error_mm", 5.0, GUIDED),
    ("hand_energy_created_j", 2.0, fed(BURST)),
    ("hand_energy_created_j", 1.5, {**fed(BURST), "damped": 0.5 * DT + 0.0 * PERIODS}),
    ("hand_energy_created_j", 0.0, fed(np.abs(BURST))),
    ("hand_passivity_violation_ratio", 1.0, fed(BURST)),
    ("hand_passivity_violation_ratio", 0.0, fed(0.009 * SPENT / 2.0 * BURST)),
]

HAND_DOES_NOT_APPLY: list[tuple[str, dict[str, Any]]] = [
    ("hand_work_j", {**GUIDED, "hand": replace(HAND, grip=20.0)}),
    ("hand_friction_work_ratio", {**GUIDED, "losses": (HOLDS, HOLDS, 0.0 * HOLDS)}),
    ("apparent_friction_n", {**GUIDED, "hand": replace(HAND, strokes=1)}),
    ("apparent_friction_n", {**GUIDED, "tool": 0.1}),
    ("return_error_mm", {**GUIDED, "hand": replace(HAND, rest=12.0)}),
    ("hand_energy_created_j", {**GUIDED, "hand": None}),
    ("hand_passivity_violation_ratio", {**GUIDED, "hand": None}),
]
