"""What a joint, its friction and its controllers are made of: frozen, checked, with units.

A field takes a float (the same for all joints) or an array with one value per joint.
"N | N m" reads: N on a sliding joint, N m on a revolute one; so does "m | rad".
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, check_numbers, check_values

Array = NDArray[np.float64]
Value = float | Array
Parameters = TypeVar("Parameters")

PARAMETERS = ("stiffness", "damping", "motor_inertia", "sigma_0", "sigma_1", "sigma_2", "f_c", "f_s", "v_s")
"""Columns of `packed`."""

__all__ = [
    "FRICTIONLESS",
    "PARAMETERS",
    "FlexibleJoint",
    "ImpedanceGains",
    "JointInfo",
    "LuGre",
    "PDGains",
    "Value",
    "check_joints",
    "packed",
    "part_of",
    "per_joint",
    "stacked",
]


def check_joints(parameters: Any, dof: int) -> None:
    """Raise ValueError where a field has neither one value nor `dof` of them."""
    for name, value in vars(parameters).items():
        if np.shape(value) not in ((), (1,), (dof,)):
            raise ValueError(
                f"{type(parameters).__name__}.{name} has shape {np.shape(value)}; "
                f"give one value for all joints or one for each of the {dof}"
            )


def per_joint(parameters: Any, dof: int) -> Any:
    """The same parameters with every field as an array (dof,). Raises ValueError as `check_joints` does."""
    check_joints(parameters, dof)
    return type(parameters)(**{name: np.broadcast_to(value, (dof,)) for name, value in vars(parameters).items()})


def stacked(parameters: Sequence[Parameters], **changes: Array) -> Parameters:
    """The parameters of n robots, fields (dof,), as one object with fields (n, dof), for who computes a batch.

    Args:
        parameters: of each robot.
        changes: fields (n, dof) to have instead.
    """
    made = copy.copy(parameters[0])
    for name in vars(made):
        field = changes.get(name, np.stack([getattr(each, name) for each in parameters]))
        object.__setattr__(made, name, field)  # each was checked by itself
    return made


def part_of(parameters: Parameters, rows: slice) -> Parameters:
    """Those of some of the robots whose parameters were `stacked`."""
    made = copy.copy(parameters)
    for name, field in vars(made).items():
        object.__setattr__(made, name, field[rows])
    return made


def one_joint(parameters: Any) -> Any:
    """The parameters of a single joint with numbers for its arrays of one."""
    return type(parameters)(**{name: float(np.asarray(value).item()) for name, value in vars(parameters).items()})


@dataclass(frozen=True, eq=False)
class LuGre:
    """LuGre friction on the motor side (Canudas de Wit et al. 1995); v = theta'.

        z'    = v - sigma_0 |v| / g(v) z,   g(v) = f_c + (f_s - f_c) exp(-(v/v_s)^2)
        tau_f = -(sigma_0 z + sigma_1 z' + sigma_2 v)      opposes motion in B theta'' + tau_j = tau_m + tau_f

    Attributes:
        sigma_0: bristle stiffness [N/m | N m/rad], at least 0; 0 leaves only viscous friction.
        sigma_1: bristle damping [N s/m | N m s/rad], at least 0.
        sigma_2: viscous coefficient [N s/m | N m s/rad], at least 0.
        f_c: Coulomb friction [N | N m], at least 0, above 0 where sigma_0 is.
        f_s: stiction [N | N m], at least f_c.
        v_s: Stribeck velocity [m/s | rad/s], above 0.
    """

    sigma_0: Value
    sigma_1: Value
    sigma_2: Value
    f_c: Value
    f_s: Value
    v_s: Value

    def __post_init__(self) -> None:
        not_negative = dict.fromkeys(("sigma_0", "sigma_1", "sigma_2", "f_c", "f_s"), NOT_NEGATIVE)
        check_values(self, **not_negative, v_s=POSITIVE)
        if np.any(np.asarray(self.f_s) < np.asarray(self.f_c)):
            raise ValueError(
                f"LuGre.f_s is {self.f_s}; stiction must be at least the Coulomb friction f_c = {self.f_c}"
            )
        if np.any((np.asarray(self.sigma_0) > 0) & (np.asarray(self.f_c) == 0)):
            raise ValueError(
                "LuGre.f_c is 0 where sigma_0 is above 0; give f_c > 0, or sigma_0 = 0 for no dry friction"
            )

    def steady(self, v: Value) -> Array:
        """Friction torque tau_f at constant velocity v [m/s | rad/s], in N | N m; it opposes v."""
        g = self.f_c + (self.f_s - self.f_c) * np.exp(-np.square(v / self.v_s))
        return np.asarray(-(np.sign(v) * g * (np.asarray(self.sigma_0) > 0) + self.sigma_2 * np.asarray(v)))

    def passivity_margin(self) -> Array:
        """sigma_2 - sigma_1 (f_s - f_c) / f_c: above 0, a sufficient condition for the passivity of v -> -tau_f."""
        f_c, f_s = np.broadcast_arrays(np.asarray(self.f_c, dtype=np.float64), self.f_s)
        excess = np.divide(f_s - f_c, f_c, out=np.zeros_like(f_c), where=f_c > 0)
        return np.asarray(self.sigma_2 - self.sigma_1 * excess)


FRICTIONLESS = LuGre(sigma_0=0.0, sigma_1=0.0, sigma_2=0.0, f_c=0.0, f_s=0.0, v_s=1.0)
"""No friction at all: what the reference competitor `ideal` runs on."""


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


def packed(joints: FlexibleJoint, friction: LuGre, dof: int) -> Array:
    """Motors, springs and friction as one array (dof, 9), columns as in PARAMETERS; errors as of `per_joint`."""
    values = {**vars(per_joint(joints, dof)), **vars(per_joint(friction, dof))}
    return np.stack([values[name] for name in PARAMETERS], axis=-1)


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
