"""The checks that observer gains pass."""

from __future__ import annotations

import numpy as np

from fo_gym import JointInfo
from fo_gym.checks import POSITIVE, Value, number, real, shown

__all__ = ["check_bandwidth", "check_gain", "check_gains", "check_share"]


def check_gain(owner: object, name: str, value: float) -> float:
    """The gain as a float. Raises ValueError where it is no number, or not finite and above 0."""
    return number(f"{type(owner).__name__}: {name}", value, POSITIVE)


def check_gains(owner: object, name: str, value: Value) -> Value:
    """The gain as a float, or as an array of its own that broadcasts against (num_envs, dof).

    Raises:
        ValueError: it is neither number nor array, or not finite and above 0.
    """
    if not isinstance(value, np.ndarray):
        return check_gain(owner, name, value)
    gains = real(f"{type(owner).__name__}: {name}", value)
    if not POSITIVE.holds(gains):
        raise ValueError(f"{type(owner).__name__}: {name} is {shown(value)}; every value must be {POSITIVE}")
    return gains.copy()


def check_share(owner: object, name: str, value: float) -> float:
    """The gain as a float. Raises ValueError where it is not in (0, 1]: more than all would over-compensate."""
    share = check_gain(owner, name, value)
    if share > 1.0:
        raise ValueError(
            f"{type(owner).__name__}: {name} is {value}; above 1 it over-compensates, so it must be at most 1"
        )
    return share


def check_bandwidth(owner: object, bandwidth: Value, joints: JointInfo, name: str = "L") -> None:
    """An observer that samples at control_dt needs L control_dt well below 1; from 1 on it rings or diverges.

    Of several the fastest counts.

    Raises:
        ValueError: L control_dt is 1 or more.
    """
    fastest = float(np.max(bandwidth))
    if fastest * joints.control_dt >= 1.0:
        raise ValueError(
            f"{type(owner).__name__}: {name} = {fastest} 1/s is too fast for an estimate every "
            f"{joints.control_dt} s; keep {name} below {1.0 / joints.control_dt:.6g} 1/s, or sample faster"
        )
