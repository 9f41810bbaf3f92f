"""What else a file holds, and what became of it: the lines of a report that nothing has to be decided for."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.parameters import FlexibleJoint, LuGre
from fo_gym.robots.editing import counts
from fo_gym.robots.report import Notes
from fo_gym.robots.survey import Survey

Array = NDArray[np.float64]

_WHY = {
    "actuators": "motors are the plant's; torque limits, rotor inertia and damping are taken from them",
    "equalities": "what they bind is welded or moves by itself",
    "tendons": "no pull, spring or coupling of theirs is kept",
    "pairs": "there are no contacts",
    "excludes": "there are no contacts",
    "keys": "poses by name, for home=",
    "tuples": "not needed",
    "texts": "not needed",
    "numerics": "not needed",
    "plugins": "not needed",
}

SYMBOLS = {
    "stiffness": "K_j [N m/rad | N/m]",
    "damping": "D_j [N m s/rad | N s/m]",
    "motor_inertia": "B [kg m^2 | kg]",
    "torque_limit": "torque limit [N m | N]",
    "sigma_0": "sigma_0 [N m/rad | N/m]",
    "sigma_1": "sigma_1 [N m s/rad]",
    "sigma_2": "sigma_2 [N m s/rad]",
    "f_c": "f_c [N m | N]",
    "f_s": "f_s [N m | N]",
    "v_s": "v_s [rad/s | m/s]",
}
"""What reports call the parameters of motors, springs and friction."""

__all__ = ["listed", "note_design", "note_the_rest"]


def listed(names: tuple[str, ...], values: Array) -> str:
    """One value for each joint, as a report shows it: the value alone where all have the same."""
    if len(values) > 1 and np.all(values == values[0]):
        return f"{values[0]:.4g} at each joint"
    return ", ".join(f"{name} {value:.4g}" for name, value in zip(names, values, strict=True))


def _positive(facts: Survey, values: Array) -> str:
    some = np.nan_to_num(values) > 0.0
    return listed(tuple(name for name, is_one in zip(facts.names, some, strict=True) if is_one), values[some])


def note_design(facts: Survey, parameters: FlexibleJoint | LuGre, notes: Notes) -> None:
    """Write down what was designed, but for what the file says: rotor inertia, torque limits, dry friction."""
    said = {"motor_inertia": facts.armature, "torque_limit": facts.torque_limit}
    for name, value in vars(parameters).items():
        assumed = ~(np.nan_to_num(said.get(name, np.zeros(len(facts.names)))) > 0.0)
        if assumed.any():
            names = tuple(np.array(facts.names)[assumed].tolist())
            notes.assumed(SYMBOLS[name], f"{listed(names, np.asarray(value)[assumed])}, by design")


def note_the_rest(
    spec: mujoco.MjSpec,
    whole: mujoco.MjModel,
    facts: Survey,
    notes: Notes,
    *,
    friction_given: bool,
    flexible_given: bool,
) -> None:
    """Write down what became of masses, springs, dampers, motors' numbers, and of what a link side has not."""
    notes.taken("masses", f"{whole.nbody - 1} bodies, {float(whole.body_mass.sum()):.4g} kg")
    if np.any(facts.armature > 0.0):
        kind = notes.dropped if flexible_given else notes.taken
        kind(
            "armature", f"[kg m^2 | kg] {_positive(facts, facts.armature)}: the motors' inertia B, no part of the links"
        )
    if np.any(facts.frictionloss > 0.0):
        kind = notes.dropped if friction_given else notes.taken
        kind("frictionloss", f"[N m | N] {_positive(facts, facts.frictionloss)}: dry friction of the motors")
    if np.any(facts.torque_limit > 0.0):
        kind = notes.dropped if flexible_given else notes.taken
        kind("torque limits", f"[N m | N] {_positive(facts, facts.torque_limit)}")
    if np.any(facts.damping > 0.0):
        notes.taken("damping", f"{_positive(facts, facts.damping)}: dampers between the links")
    if np.any(whole.jnt_stiffness):
        notes.taken("springs of the file", "act on the links")
    if np.any(whole.body_gravcomp):
        notes.taken("gravcomp", "the weight of bodies is balanced, as the file says")
    if whole.opt.density > 0.0 or whole.opt.viscosity > 0.0:
        notes.taken("medium", "its drag acts on the links")
    if not np.any(whole.opt.gravity):
        notes.taken("gravity", "none, as the file says")
    for elements, count in counts(spec).items():
        notes.dropped(elements, f"{count}: {_WHY[elements]}")
    if np.any(whole.geom_contype) or np.any(whole.geom_conaffinity):
        notes.dropped("contacts", "links go through each other and through the world")
