"""What a file says of its joints: kinds, ranges, motors, and which of them cannot be driven on their own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.robots.editing import ENDLESS, HINGE
from fo_gym.robots.welding import SLIDE

Array = NDArray[np.float64]

_JOINTS = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
_TENDON = int(mujoco.mjtTrn.mjTRN_TENDON)

__all__ = ["Survey", "bound_joints", "joints_of_things", "survey"]


@dataclass(frozen=True)
class Survey:
    """What the file says of joints that turn or slide; arrays have one value for each of them, NaN where it says none.

    Attributes:
        names: in the file's order.
        units: "rad" or "m".
        low, high: range [m | rad], infinite at both ends where one has no end.
        reference: position in which the file is drawn [m | rad].
        armature: of the rotor, reflected, the actuators' included [kg | kg m^2].
        frictionloss: dry friction [N | N m].
        damping: viscous [N s/m | N m s/rad], the actuators' included.
        torque_limit: [N | N m].
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    low: Array
    high: Array
    reference: Array
    armature: Array
    frictionloss: Array
    damping: Array
    torque_limit: Array

    def of(self, joints: tuple[str, ...]) -> Survey:
        """The same of some of the joints."""
        picked = [self.names.index(name) for name in joints]
        arrays = {name: value[picked] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        return Survey(names=joints, units=tuple(self.units[i] for i in picked), **arrays)


def survey(whole: mujoco.MjModel) -> Survey:
    """Look at all joints of a file that turn or slide, in its compiled model."""
    ids = [i for i in range(whole.njnt) if whole.jnt_type[i] in (HINGE, SLIDE)]
    dofs = whole.jnt_dofadr[ids]
    endless = np.abs(whole.jnt_range[ids]).max(axis=1, initial=0.0) > ENDLESS
    limited = whole.jnt_limited[ids].astype(bool) & ~endless
    armature, damping = whole.dof_armature.copy(), whole.dof_damping.copy()
    for actuator, joint in _driven(whole):
        gear = whole.actuator_gear[actuator, 0]
        armature[whole.jnt_dofadr[joint]] += gear**2 * whole.actuator_armature[actuator]
        damping[whole.jnt_dofadr[joint]] += gear**2 * whole.actuator_damping[actuator]
    return Survey(
        names=tuple(whole.joint(i).name for i in ids),
        units=tuple("rad" if whole.jnt_type[i] == HINGE else "m" for i in ids),
        low=np.where(limited, whole.jnt_range[ids, 0], -np.inf),
        high=np.where(limited, whole.jnt_range[ids, 1], np.inf),
        reference=whole.qpos0[whole.jnt_qposadr[ids]],
        armature=armature[dofs],
        frictionloss=whole.dof_frictionloss[dofs],
        damping=damping[dofs],
        torque_limit=np.array([_torque_limit(whole, i) for i in ids]),
    )


def _driven(whole: mujoco.MjModel) -> Iterator[tuple[int, int]]:
    """(actuator, joint) of every actuator that acts on a hinge or a slide itself."""
    for actuator in range(whole.nu):
        joint = int(whole.actuator_trnid[actuator, 0])
        if whole.actuator_trntype[actuator] in _JOINTS and whole.jnt_type[joint] in (HINGE, SLIDE):
            yield actuator, joint


def _both_ways(low_high: Array) -> float:
    """What can be given in both directions; of a motor that works in one alone, what it gives there."""
    low, high = np.abs(low_high)
    return float(min(low, high) or max(low, high))


def _torque_limit(whole: mujoco.MjModel, joint: int) -> float:
    """The least of what the joint and its strongest actuator allow [N | N m]; NaN where neither has a limit."""
    limits = []
    if whole.jnt_actfrclimited[joint]:
        limits.append(_both_ways(whole.jnt_actfrcrange[joint]))
    motors = [_motor_limit(whole, actuator) for actuator, driven in _driven(whole) if driven == joint]
    if motors and not np.isnan(motors).any():
        limits.append(max(motors))
    positive = [limit for limit in limits if limit > 0.0]
    return min(positive, default=np.nan)


def _motor_limit(whole: mujoco.MjModel, actuator: int) -> float:
    """Of an actuator at its joint: its force's range, or, where force is gain times control, the control's."""
    gear = abs(float(whole.actuator_gear[actuator, 0]))
    limits = []
    if whole.actuator_forcelimited[actuator]:
        limits.append(_both_ways(whole.actuator_forcerange[actuator]))
    fixed = whole.actuator_gaintype[actuator] == int(mujoco.mjtGain.mjGAIN_FIXED)
    plain = whole.actuator_biastype[actuator] == int(mujoco.mjtBias.mjBIAS_NONE)
    still = whole.actuator_dyntype[actuator] == int(mujoco.mjtDyn.mjDYN_NONE)
    if whole.actuator_ctrllimited[actuator] and fixed and plain and still:
        gain = abs(float(whole.actuator_gainprm[actuator, 0]))
        limits.append(gain * _both_ways(whole.actuator_ctrlrange[actuator]))
    return gear * min(limits) if limits else np.nan


def _tendon_joints(whole: mujoco.MjModel, tendon: int) -> list[int]:
    first = int(whole.tendon_adr[tendon])
    wraps = range(first, first + int(whole.tendon_num[tendon]))
    kind = int(mujoco.mjtWrap.mjWRAP_JOINT)
    return [int(whole.wrap_objid[wrap]) for wrap in wraps if whole.wrap_type[wrap] == kind]


def bound_joints(whole: mujoco.MjModel) -> dict[str, str]:
    """Joints that an equality of the file binds to others, and what binds them, for reports.

    Of joints that follow each other, the one that leads is not among them; of a closed loop, all are.
    """
    bound: dict[int, str] = {}
    kinds = mujoco.mjtEq
    for equality in range(whole.neq):
        if not whole.eq_active0[equality]:
            continue
        kind, first, second = (int(x[equality]) for x in (whole.eq_type, whole.eq_obj1id, whole.eq_obj2id))
        if kind == int(kinds.mjEQ_JOINT):
            leader = f"follows joint {whole.joint(second).name}" if second >= 0 else "is held by an equality"
            bound.setdefault(first, leader)
        elif kind == int(kinds.mjEQ_TENDON):
            joints = [joint for tendon in (first, second) if tendon >= 0 for joint in _tendon_joints(whole, tendon)]
            for joint in joints[1:]:
                bound.setdefault(joint, f"is tied to joint {whole.joint(joints[0]).name} by a tendon")
        elif kind in (int(kinds.mjEQ_CONNECT), int(kinds.mjEQ_WELD)):
            for joint in _loop(whole, equality):
                bound.setdefault(joint, "is part of a closed loop")
    return {whole.joint(joint).name: why for joint, why in sorted(bound.items())}


def _loop(whole: mujoco.MjModel, equality: int) -> list[int]:
    """Joints between what an equality holds together, two bodies or sites; none where one of them is a mocap body."""
    ends = [int(whole.eq_obj1id[equality]), int(whole.eq_obj2id[equality])]
    if whole.eq_objtype[equality] == int(mujoco.mjtObj.mjOBJ_SITE):
        ends = [int(whole.site_bodyid[end]) for end in ends]
    if any(whole.body_mocapid[end] >= 0 for end in ends):
        return []
    above = [set(ancestors(whole, end)) for end in ends]
    bodies = above[0] ^ above[1]
    return [joint for joint in range(whole.njnt) if int(whole.jnt_bodyid[joint]) in bodies]


def ancestors(whole: mujoco.MjModel, body: int) -> Iterator[int]:
    """A body and those that carry it, the world excepted, from the tip down."""
    while body:
        yield body
        body = int(whole.body_parentid[body])


def joints_of_things(whole: mujoco.MjModel) -> dict[str, str]:
    """Joints of what stands apart from all that actuators move, things beside the robot such as a puck; and why."""
    moved = {joint for _, joint in _driven(whole)}
    for actuator in range(whole.nu):
        if whole.actuator_trntype[actuator] == _TENDON:
            moved.update(_tendon_joints(whole, int(whole.actuator_trnid[actuator, 0])))
    robots = {int(whole.body_rootid[whole.jnt_bodyid[joint]]) for joint in moved}
    if not robots:
        return {}
    return {
        whole.joint(joint).name: "belongs to a thing apart, which no actuator moves"
        for joint in range(whole.njnt)
        if int(whole.body_rootid[whole.jnt_bodyid[joint]]) not in robots
    }
