"""What one episode is made of: parameters, start, target and push."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.hardware import HardwareDraw
from fo_gym.parameters import FlexibleJoint, LuGre

Array = NDArray[np.float64]

__all__ = ["Push", "Scenario", "with_options"]


@dataclass(frozen=True)
class Push:
    """An external torque on the link side, tau(t) = torque * sin^2(pi (t - time) / duration).

    Attributes:
        time: start, s.
        duration: length of the pulse, s, above zero.
        torque: peak, (dof,), N or N m, positive along the joint axis.
    """

    time: float
    duration: float
    torque: Array

    def __post_init__(self) -> None:
        if not (np.isfinite(self.time) and self.time >= 0):
            raise ValueError(f"push time is {self.time}; it must be a finite time >= 0 s")
        if not (np.isfinite(self.duration) and self.duration > 0):
            raise ValueError(f"push duration is {self.duration}; it must be finite and above 0 s")
        if not np.all(np.isfinite(self.torque)):
            raise ValueError(f"push torque is {self.torque}; every value must be finite")


@dataclass(frozen=True, eq=False)
class Scenario:
    """One episode of one environment.

    Attributes:
        friction: LuGre parameters.
        joints: motors and springs.
        mass_scale: factor on the masses of the robot file.
        q_start: links at reset, (dof,), m or rad.
        target: desired links after the step, (dof,), m or rad; None where a path is followed.
        push: external push, or None.
        hardware: what was drawn of the hardware's effects, or None where there are none.
    """

    friction: LuGre
    joints: FlexibleJoint
    mass_scale: float
    q_start: Array
    target: Array | None
    push: Push | None
    hardware: HardwareDraw | None = None

    @property
    def believed(self) -> FlexibleJoint:
        """Motors and springs as controller, nominal motor and compensator know them."""
        return self.joints if self.hardware is None else self.hardware.believed

    @property
    def believed_mass(self) -> float:
        """Factor on the true masses in what the controller knows."""
        return 1.0 if self.hardware is None else self.hardware.believed_mass


def _vector(value: Any, dof: int, what: str) -> Array:
    array = np.array(value, dtype=np.float64)
    if array.shape != (dof,) or not np.all(np.isfinite(array)):
        raise ValueError(f"{what} is {value}; give {dof} finite value(s), one per joint")
    return array


def with_options(scenario: Scenario, options: Mapping[str, Any] | None) -> Scenario:
    """The scenario with the parts that `reset(options=...)` names replaced.

    Args:
        scenario: what the variant drew.
        options: {"target": (dof,), "push": {"time": s, "duration": s, "torque": (dof,)}}, each key optional.

    Raises:
        ValueError: an unknown key, a wrong shape, or a target for a task that follows a path.
    """
    options = options or {}
    dof = len(scenario.q_start)
    unknown = set(options) - {"target", "push"}
    if unknown:
        raise ValueError(f"unknown reset options {sorted(unknown)}; allowed are 'target' and 'push'")
    if "target" in options:
        if scenario.target is None:
            raise ValueError("this task follows a path: it takes no 'target' in the reset options")
        scenario = replace(scenario, target=_vector(options["target"], dof, "reset option 'target'"))
    if "push" in options:
        keys = options["push"]
        if not isinstance(keys, Mapping) or set(keys) != {"time", "duration", "torque"}:
            raise ValueError(f"reset option 'push' is {keys}; give a mapping with 'time', 'duration' and 'torque'")
        torque = _vector(keys["torque"], dof, "reset option 'push' torque")
        scenario = replace(scenario, push=Push(float(keys["time"]), float(keys["duration"]), torque))
    return scenario
