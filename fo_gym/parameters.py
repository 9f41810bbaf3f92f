"""What a joint, its friction and its controllers are made of: frozen, checked, with units.

A field takes a float (the same for all joints) or an array with one value per joint.
"N | N m" reads: N on a sliding joint, N m on a revolute one; so does "m | rad".
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, Value, check_numbers, check_values
from fo_gym.friction import LuGre

Array = NDArray[np.float64]
Parameters = TypeVar("Parameters")

JOINT = ("stiffness", "damping", "motor_inertia")
"""Columns of `packed`."""

__all__ = [
    "JOINT",
    "FlexibleJoint",
    "ImpedanceGains",
    "JointInfo",
    "PDGains",
    "check_joints",
    "packed",
    "per_joint",
    "with_fields",
]


def check_joints(parameters: Any, dof: int) -> None:
    """Raise ValueError where a field has neither one value nor `dof` of them; a tuple is the same for all joints."""
    for name, value in vars(parameters).items():
        if not isinstance(value, tuple) and np.shape(value) not in ((), (1,), (dof,)):
            raise ValueError(
                f"{type(parameters).__name__}.{name} has shape {np.shape(value)}; "
                f"give one value for all joints or one for each of the {dof}"
            )


def per_joint(parameters: Any, dof: int) -> Any:
    """The same parameters with every field as an array (dof,). Raises ValueError as `check_joints` does."""
    check_joints(parameters, dof)
    return _each(parameters, lambda value: np.broadcast_to(value, (dof,)))


def with_fields(parameters: Parameters, values: Mapping[str, Array]) -> Parameters:
    """The same parameters with these fields, unchecked: (n, dof) each, of n robots, for who computes a batch."""
    made = copy.copy(parameters)
    for name, field in values.items():
        object.__setattr__(made, name, field)
    return made


def one_joint(parameters: Any) -> Any:
    """The parameters of a single joint with numbers for its arrays of one."""
    return _each(parameters, lambda value: float(np.asarray(value).item()))


def _each(parameters: Any, change: Callable[[Any], Any]) -> Any:
    """The same parameters, changed one by one; what is the same for all joints stays."""
    new = {name: value if isinstance(value, tuple) else change(value) for name, value in vars(parameters).items()}
    return type(parameters)(**new)


@dataclass(frozen=True, eq=False)
class FlexibleJoint:
    """Motor and spring of a joint: tau_j = stiffness (theta - q) + damping (theta' - q').

    Attributes:
        stiffness: K_j [N/m | N m/rad], above 0.
        damping: D_j [N s/m | N m s/rad], at least 0.
        motor_inertia: B, reflected to the link side [kg | kg m^2], above 0.
        torque_limit: bound of the action [N | N m], above 0.
    """

    stiffness: Value
    damping: Value
    motor_inertia: Value
    torque_limit: Value

    def __post_init__(self) -> None:
        check_values(self, stiffness=POSITIVE, damping=NOT_NEGATIVE, motor_inertia=POSITIVE, torque_limit=POSITIVE)


def packed(joints: FlexibleJoint, dof: int) -> Array:
    """Motors and springs as one array (dof, 3), columns as in JOINT; errors as of `per_joint`."""
    values = vars(per_joint(joints, dof))
    return np.stack([values[name] for name in JOINT], axis=-1)


@dataclass(frozen=True, eq=False)
class PDGains:
    """Motor PD in joint space.

    Attributes:
        kp: [N/m | N m/rad], above 0.
        kd: [N s/m | N m s/rad], at least 0.
    """

    kp: Value
    kd: Value

    def __post_init__(self) -> None:
        check_values(self, kp=POSITIVE, kd=NOT_NEGATIVE)


@dataclass(frozen=True, eq=False)
class ImpedanceGains:
    """Impedance in task space: tool position, tool orientation, and the elbow: the joints that are redundant.

    Attributes:
        kp_position, kd_position: [N/m], [N s/m].
        kp_orientation, kd_orientation: [N m/rad], [N m s/rad]; without effect where the position alone is controlled.
        kp_elbow, kd_elbow: [N/m | N m/rad], [N s/m | N m s/rad], one value or one for each redundant joint; without
            effect where there is none.
    """

    kp_position: float
    kd_position: float
    kp_orientation: float
    kd_orientation: float
    kp_elbow: Value
    kd_elbow: Value

    def __post_init__(self) -> None:
        for part in ("position", "orientation"):
            check_numbers(self, **{f"kp_{part}": POSITIVE, f"kd_{part}": NOT_NEGATIVE})
        check_values(self, kp_elbow=POSITIVE, kd_elbow=NOT_NEGATIVE)


@dataclass(frozen=True, eq=False)
class JointInfo:
    """What a compensator may know of the joints. Arrays broadcast against (num_envs, dof).

    Attributes:
        dof: number of joints.
        motor_inertia: B [kg | kg m^2].
        stiffness: K_j [N/m | N m/rad].
        torque_limit: bound of the action [N | N m].
        control_dt: time between two estimates [s].
        identified: friction as an identification of this robot gave it, which a model-based compensator may use; None
            where none is known. Where friction is drawn per episode, it is off like that of a robot that has aged. For
            privileged compensators it is the true one at the start of each episode, arrays (num_envs, dof).
    """

    dof: int
    motor_inertia: Array
    stiffness: Array
    torque_limit: Array
    control_dt: float
    identified: LuGre | None = None

    def ticks(self, what: str, period: float, least: int = 1) -> int:
        """Control periods from one time to the next of what comes every `period` [s].

        Raises:
            ValueError: they are no whole number, or fewer than `least`; the message begins with `what`.
        """
        ticks = round(period / self.control_dt)
        if ticks < least or abs(ticks * self.control_dt - period) > 1e-9:
            most = f", at most {period / least:g} s" if least > 1 else ""
            raise ValueError(
                f"{what} every {period:g} s, which does not suit control_dt = {self.control_dt:g} s; "
                f"choose a control_dt that divides {period:g} s{most}"
            )
        return ticks
