"""PLACEHOLDER."""

from __future__ import annotations

from fo_gym.parameters import ImpedanceGains, PDGains
from fo_gym.robots import Robot


def designed_pd(robot: Robot) -> PDGains:
    """PLACEHOLDER."""
    raise NotImplementedError


def designed_impedance(robot: Robot) -> ImpedanceGains:
    """PLACEHOLDER."""
    raise NotImplementedError
