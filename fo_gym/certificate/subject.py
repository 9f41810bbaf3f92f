"""What a reproduction puts to the test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fo_gym.compensators import Compensator, make_compensator

__all__ = ["Subject"]


@dataclass(frozen=True)
class Subject:
    """The code as it is run; the defaults are what is published, anything else is an experiment with it.

    Attributes:
        control_dt: control period of the paper's simulations [s]; they are in continuous time.
        physics_dt: micro-step of the plant [s]; None means min(2e-4, control period).
        make: from a compensator's name to a new one.
        quick: fewer random cases; the statements and their tolerances stay.
    """

    control_dt: float = 1e-4
    physics_dt: float | None = None
    make: Callable[[str], Compensator] = make_compensator
    quick: bool = False

    def count(self, full: int) -> int:
        """How many random cases are run where `full` are published."""
        return max(3, full // 5) if self.quick else full
