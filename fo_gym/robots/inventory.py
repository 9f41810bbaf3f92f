"""What else a file holds, and what became of it: the lines of a report that nothing has to be decided for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.friction import LuGre
from fo_gym.parameters import FlexibleJoint
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

DESIGN, GIVEN = "by design", "given"
"""What reports call numbers that nobody measured, and such as a program gives."""

__all__ = ["listed", "note_sources", "note_the_rest"]


def listed(names: tuple[str, ...], values: Array) -> str:
    """One value for each joint, as a report shows it: the value alone where all have the same."""
    if len(values) > 1 and np.all(values == values[0]):
        return f"{values[0]:.4g} at each joint"
    return ", ".join(f"{name} {value:.4g}" for name, value in zip(names, values, strict=True))


def _positive(facts: Survey, values: Array) -> str:
    some = np.nan_to_num(values) > 0.0
    return listed(tuple(name for name, is_one in zip(facts.names, some, strict=True) if is_one), values[some])


def note_sources(
    facts: Survey,
    flexible: FlexibleJoint,
    friction: LuGre,
    known: Iterable[str],
    sources: Mapping[str, str],
    notes: Notes,
) -> dict[str, str]:
    """Write down where each number of motors, springs and friction is from; returns that by its path."""
    said = {"motor_inertia": facts.armature, "torque_limit": facts.torque_limit}
    found = {}
    for part, parameters in (("flexible", flexible), ("friction", friction)):
        for name, value in vars(parameters).items():
            path, told = f"{part}.{name}", listed(facts.names, np.asarray(value))
            from_file = np.nan_to_num(said.get(name, np.zeros(len(facts.names)))) > 0.0
            if name in known:
                found[path] = sources.get(path, GIVEN)
                (notes.assumed if found[path].startswith(DESIGN) else notes.taken)(
                    SYMBOLS[name], f"{told}: {found[path]}"
                )
            elif from_file.all():
                found[path] = "the robot's file"
            else:
                found[path] = f"{DESIGN}, where the file says nothing" if from_file.any() else DESIGN
                notes.assumed(SYMBOLS[name], f"{told}: {found[path]}")
    return found


def note_the_rest(
    spec: mujoco.MjSpec,
    whole: mujoco.MjModel,
    facts: Survey,
    notes: Notes,
    known: set[str],
) -> None:
    """Write down what became of masses, springs, dampers, motors' numbers, and of what a link side has not.

    What is `known` better, by the names of the parameters, is not taken from the file.
    """
    notes.taken("masses", f"{whole.nbody - 1} bodies, {float(whole.body_mass.sum()):.4g} kg")
    if np.any(facts.armature > 0.0):
        kind = notes.dropped if "motor_inertia" in known else notes.taken
        kind(
            "armature", f"[kg m^2 | kg] {_positive(facts, facts.armature)}: the motors' inertia B, no part of the links"
        )
    if np.any(facts.frictionloss > 0.0):
        kind = notes.dropped if "f_c" in known else notes.taken
        kind(
            "frictionloss",
            f"[N m | N] {_positive(facts, facts.frictionloss)}: dry friction of the motors, but for placeholders",
        )
    if np.any(facts.torque_limit > 0.0):
        kind = notes.dropped if "torque_limit" in known else notes.taken
        kind("torque limits", f"[N m | N] {_positive(facts, facts.torque_limit)}")
    if np.any(facts.damping > 0.0):
        notes.taken("damping", f"{_positive(facts, facts.damping)}: dampers between the links")
    if np.any(whole.jnt_stiffness):
        notes.taken("springs of the file", "act on the links")
    if np.any(whole.body_gravcomp):
        notes.taken("gravcomp", "the weight of bodies is balanced, as the file says")
    if whole.opt.density > 0.0 or whole.opt.viscosity > 0.0:
        notes.taken("medium", "its drag acts on the links")
    if np.any(whole.opt.wind):
        notes.dropped("wind", "the medium is still: no torque of a controller balances a wind")
    if not np.any(whole.opt.gravity):
        notes.taken("gravity", "none, as the file says")
    for elements, count in counts(spec).items():
        notes.dropped(elements, f"{count}: {_WHY[elements]}")
    if np.any(whole.geom_contype) or np.any(whole.geom_conaffinity):
        notes.dropped("contacts", "links go through each other and through the world")
