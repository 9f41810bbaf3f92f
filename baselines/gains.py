"""The check that every observer gain passes."""

from __future__ import annotations

from fo_gym import JointInfo
from fo_gym.checks import POSITIVE, number

__all__ = ["check_bandwidth", "check_gain"]


def check_gain(owner: object, name: str, value: float) -> float:
    """The gain as a float. Raises ValueError where it is no number, or not finite and above 0."""
    return number(f"{type(owner).__name__}: {name}", value, POSITIVE)


def check_bandwidth(owner: object, bandwidth: float, joints: JointInfo) -> None:
    """An observer that samples at control_dt needs L control_dt well below 1; from 1 on it rings or diverges.

    Raises:
        ValueError: L control_dt is 1 or more.
    """
    if bandwidth * joints.control_dt >= 1.0:
        raise ValueError(
            f"{type(owner).__name__}: L = {bandwidth} 1/s is too fast for an estimate every {joints.control_dt} s; "
            f"keep L below {1.0 / joints.control_dt:.6g} 1/s, or sample faster"
        )
