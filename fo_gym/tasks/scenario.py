"""What one episode is made of: parameters, start, target and push."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, instance, number, real_array, shown, values
from fo_gym.friction import FrictionLaw
from fo_gym.hardware import HardwareDraw
from fo_gym.parameters import FlexibleJoint, check_joints
from fo_gym.tasks.hand import Hand

Array = NDArray[np.float64]

__all__ = ["Push", "Scenario"]


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
        number("push time", self.time, NOT_NEGATIVE, "s")
        number("push duration", self.duration, POSITIVE, "s")
        values("push torque", self.torque)


@dataclass(frozen=True, eq=False)
class Scenario:
    """One episode of one environment.

    Attributes:
        friction: of the motors.
        joints: motors and springs.
        mass_scale: factor on the masses of the robot file.
        q_start: links at reset, (dof,), m or rad.
        target: desired links after the step, (dof,), m or rad; None where a path is followed.
        push: external push, or None.
        hardware: what was drawn of the hardware's effects, or None where there are none.
        hand: that guides the tool, nothing of it left open, or None.
    """

    friction: FrictionLaw
    joints: FlexibleJoint
    mass_scale: float
    q_start: Array
    target: Array | None
    push: Push | None
    hardware: HardwareDraw | None = None
    hand: Hand | None = None

    @property
    def believed(self) -> FlexibleJoint:
        """Motors and springs as controller, nominal motor and compensator know them."""
        return self.joints if self.hardware is None else self.hardware.believed

    @property
    def believed_mass(self) -> float:
        """Factor on the true masses in what the controller knows."""
        return 1.0 if self.hardware is None else self.hardware.believed_mass

    def check(self, name: str, dof: int) -> None:
        """Raise ValueError where it is none of a robot with `dof` joints; `name` is what to call it.

        What was drawn of the hardware is checked by who knows the hardware.
        """
        for part, kind in (("friction", FrictionLaw), ("joints", FlexibleJoint)):
            instance(f"{name}.{part}", getattr(self, part), kind)
            check_joints(getattr(self, part), dof)
        number(f"{name}.mass_scale", self.mass_scale, POSITIVE)
        arrays = {"q_start": self.q_start}
        if self.target is not None:
            arrays["target"] = self.target
        if self.push is not None:
            instance(f"{name}.push", self.push, Push)
            arrays["push.torque"] = self.push.torque
        if self.hand is not None:
            instance(f"{name}.hand", self.hand, Hand)
            if not self.hand.is_fitted:
                raise ValueError(f"{name}.hand is {shown(self.hand)}; give one with nothing left open")
        for part, array in arrays.items():
            real_array(f"{name}.{part}", array, (dof,))
