"""PLACEHOLDER."""

from __future__ import annotations

from typing import Any

from fo_gym.robots import Robot


def fitted_square(robot: Robot, duration: float, side: Any, first: Any, second: Any) -> Any:
    """PLACEHOLDER."""
    return 0.15, (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)
