"""Which joints of a file move, which are welded and where, and where the robot may start."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import shown
from fo_gym.robots.report import Notes
from fo_gym.robots.survey import Survey, bound_joints, joints_of_things

Array = NDArray[np.float64]

__all__ = ["check_home", "check_ranges", "chosen_joints", "frozen_joints", "named_pose", "resting_pose"]


def check_ranges(file: Path, facts: Survey) -> None:
    """Raise ValueError where the range of a joint is none."""
    for name, low, high in zip(facts.names, facts.low, facts.high, strict=True):
        if not low < high:
            raise ValueError(
                f"{file}: the range of joint {name!r} is ({low:g}, {high:g}); give (low, high), low < high"
            )


def _named(file: Path, names: Iterable[str], given: Any) -> tuple[str, ...]:
    """The caller's joints, checked against those there are."""
    there = tuple(names)
    if isinstance(given, str) or not isinstance(given, list | tuple) or not all(isinstance(x, str) for x in given):
        raise ValueError(f"joints is {shown(given)}; give a list of names, of {there}")
    unknown = [name for name in given if name not in there]
    if unknown or not given:
        raise ValueError(f"{file}: joints {unknown} are not there, or neither turn nor slide; give some of {there}")
    if len(set(given)) < len(given):
        twice = sorted({name for name in given if list(given).count(name) > 1})
        raise ValueError(f"joints names {twice} twice; give each joint once")
    ordered = tuple(name for name in there if name in given)
    if ordered != tuple(given):
        raise ValueError(f"joints is {shown(tuple(given))}; give them in the file's order, {ordered}")
    return ordered


def chosen_joints(file: Path, whole: mujoco.MjModel, facts: Survey, given: Any, notes: Notes) -> tuple[str, ...]:
    """The flexible joints; a line for each of the others."""
    if not facts.names:
        raise ValueError(f"{file} has no joint that turns or slides; a robot needs one at least")
    bound = bound_joints(whole)
    for joint in range(whole.njnt):
        name = whole.joint(joint).name
        if whole.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_FREE):
            notes.dropped(f"joint {name}", f"free: body {_body(whole, joint)} is fixed where it stands")
        elif whole.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_BALL):
            notes.dropped(f"joint {name}", f"ball: body {_body(whole, joint)} is welded as it is drawn")
    if given is not None:
        chosen = _named(file, facts.names, given)
        for name in sorted(set(chosen) & set(bound)):
            notes.dropped(f"joint {name}", f"{bound[name]} in the file, and moves by itself here, as it is named")
        notes.taken("joints", f"the {len(chosen)} that are named")
        return chosen
    chosen = tuple(name for name in facts.names if name not in {**bound, **joints_of_things(whole)})
    if not chosen:
        told = "; ".join(f"{name} {why}" for name, why in bound.items())
        raise ValueError(f"{file} has no joint that moves by itself ({told}); name those that shall, joints=[...]")
    notes.taken("joints", ", ".join(chosen))
    return chosen


def _body(whole: mujoco.MjModel, joint: int) -> str:
    return str(whole.body(int(whole.jnt_bodyid[joint])).name)


def named_pose(file: Path, whole: mujoco.MjModel, facts: Survey, key: str) -> Array:
    """Where all joints of the file are in a keyframe [m | rad]. Raises ValueError where there is none of that name."""
    keys = {whole.key(i).name: whole.key(i).qpos for i in range(whole.nkey) if whole.key(i).name}
    if key not in keys:
        raise ValueError(f"{file}: home is keyframe {key!r}; the file has {sorted(keys) or 'none'}")
    return np.array([keys[key][whole.joint(name).qposadr[0]] for name in facts.names])


def resting_pose(facts: Survey) -> Array:
    """Where joints are welded if nobody says where [m | rad]: as drawn, or amid a range that does not have that."""
    pose = facts.reference.copy()
    outside = (pose < facts.low) | (pose > facts.high)
    pose[outside] = 0.5 * (facts.low[outside] + facts.high[outside])
    return pose


def frozen_joints(
    whole: mujoco.MjModel,
    facts: Survey,
    chosen: tuple[str, ...],
    pose: Array,
    notes: Notes,
    given: tuple[tuple[str, float], ...] | None = None,
) -> tuple[tuple[str, float], ...]:
    """Where joints are welded that are elsewhere than as drawn; a line for each that is welded, and why.

    They are where `given` says, joints that it does not name as drawn; or, without it, where `pose` has them.
    """
    why = {**joints_of_things(whole), **bound_joints(whole)}
    unknown = sorted({name for name, _ in given or ()} - (set(facts.names) - set(chosen)))
    if unknown:
        raise ValueError(f"frozen joints {unknown} are not there, or are driven; the file has {facts.names}")
    drawn = dict(zip(facts.names, facts.reference.tolist(), strict=True))
    places = {**drawn, **dict(given)} if given is not None else dict(zip(facts.names, pose.tolist(), strict=True))
    frozen = []
    for name, unit in zip(facts.names, facts.units, strict=True):
        if name not in chosen:
            notes.dropped(f"joint {name}", f"{why.get(name, 'is not named')}; welded at {places[name]:g} {unit}")
            if places[name] != drawn[name]:
                frozen.append((name, places[name]))
    return tuple(frozen)


def check_home(file: Path, facts: Survey, home: Array) -> None:
    """Raise ValueError where a joint's home (dof,) is outside its range."""
    for name, unit, value, low, high in zip(facts.names, facts.units, home, facts.low, facts.high, strict=True):
        if not low <= value <= high:
            raise ValueError(
                f"{file}: home of joint {name!r} is {value:g} {unit}; its range is {low:g} to {high:g} {unit}"
            )
