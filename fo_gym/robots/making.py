"""From a file to all that a robot is made of; each decision leaves a line in the report."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import instance, real_array, shown
from fo_gym.hardware import Hardware
from fo_gym.parameters import FlexibleJoint, LuGre
from fo_gym.robots.design import designed_friction, designed_joints
from fo_gym.robots.editing import compile_whole
from fo_gym.robots.file import existing_file, read_spec
from fo_gym.robots.home import found_home, poor_home, redundant_joints
from fo_gym.robots.inventory import note_the_rest
from fo_gym.robots.link_side import LinkSide
from fo_gym.robots.report import Notes, Report
from fo_gym.robots.survey import Survey, bound_joints, joints_of_things, survey
from fo_gym.robots.tool import end_of_chain

Array = NDArray[np.float64]

_GENERAL = {"robot", "model", "scene", "arm", "main"}
"""Names of files that say nothing of the robot; their folder does."""

__all__ = ["made_from_file"]


def made_from_file(
    path: Any,
    joints: Any,
    tool: Any,
    home: Any,
    flexible: FlexibleJoint | None,
    friction: LuGre | None,
    hardware: Hardware | None,
    redundant: Any,
) -> dict[str, Any]:
    """The fields of a `Robot`. Arguments and errors as of `Robot.from_file`."""
    instance("flexible", flexible, FlexibleJoint, none="joints by design")
    instance("friction", friction, LuGre, none="friction by design")
    instance("tool", tool, str, none="the end of the longest chain")
    file, notes = existing_file("robot file", path), Notes()
    spec = read_spec(file, notes)
    whole = compile_whole(spec, file, notes)
    everything = survey(whole)
    _check_ranges(file, everything)
    chosen = _joints(file, whole, everything, joints, notes)
    if tool is None:
        tool, why = end_of_chain(whole, chosen)
        notes.assumed("tool", f"{tool}: {why}")
    else:
        notes.taken("tool", tool)
    own = everything.of(chosen)
    place, pose = _pose(file, whole, everything, home)
    frozen = _frozen(whole, everything, chosen, pose, notes)
    link_side = LinkSide(file, chosen, tool, None, frozen)
    model = link_side.model
    start = np.array([pose[name] for name in chosen])
    poor = poor_home(model, start, tool) if place else None
    if isinstance(home, str) or (home is None and place and poor is None):
        notes.taken("home", f"keyframe {place}")
    elif home is None:
        start = found_home(model, tool, own.torque_limit)
        notes.assumed("home", f"{start.tolist()}, found" + ("" if poor is None else f": in keyframe {place} {poor}"))
    else:
        start = real_array("home", home, (len(chosen),))
        notes.taken("home", "as given")
    _check_home(file, own, start)
    if redundant is None:
        redundant = redundant_joints(model, start, tool)
        if redundant:
            notes.assumed("redundant", f"{', '.join(redundant)}: the tool needs them least")
    note_the_rest(spec, whole, own, notes, friction_given=friction is not None, flexible_given=flexible is not None)
    if flexible is None:
        flexible = designed_joints(model, start, armature=own.armature, torque_limit=own.torque_limit)
        notes.assumed("springs", "K_j and D_j by design")
    if friction is None:
        friction = designed_friction(model, flexible, frictionloss=own.frictionloss)
        notes.assumed("friction", "by design")
    return {
        "name": file.parent.name if file.stem in _GENERAL else file.stem,
        "link_side": link_side,
        "units": own.units,
        "flexible": flexible,
        "friction": friction,
        "home": start,
        "redundant": tuple(redundant),
        "hardware": hardware,
        "report": Report(tuple(notes)),
    }


def _check_ranges(file: Path, facts: Survey) -> None:
    for name, low, high in zip(facts.names, facts.low, facts.high, strict=True):
        if not low < high:
            raise ValueError(
                f"{file}: the range of joint {name!r} is ({low:g}, {high:g}); its low end must be below its high"
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


def _joints(file: Path, whole: mujoco.MjModel, facts: Survey, given: Any, notes: Notes) -> tuple[str, ...]:
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


def _pose(file: Path, whole: mujoco.MjModel, facts: Survey, home: Any) -> tuple[str, dict[str, float]]:
    """The keyframe that gives the home pose, or "", and where all joints are there; or within their ranges at rest."""
    keys = {whole.key(i).name: whole.key(i).qpos for i in range(whole.nkey) if whole.key(i).name}
    if isinstance(home, str) and home not in keys:
        raise ValueError(f"{file}: home is keyframe {home!r}; the file has {sorted(keys) or 'none'}")
    inside = np.where((facts.low <= facts.reference) & (facts.reference <= facts.high), facts.reference, np.nan)
    with np.errstate(invalid="ignore"):  # an endless joint: -inf + inf
        middle = 0.5 * (facts.low + facts.high)
    middle = np.where(np.isfinite(middle), middle, facts.reference)
    rest = dict(zip(facts.names, np.where(np.isnan(inside), middle, inside).tolist(), strict=True))
    wanted = home if isinstance(home, str) else "home"
    if wanted not in keys or not (home is None or isinstance(home, str)):
        return "", rest
    place = {name: float(keys[wanted][whole.joint(name).qposadr[0]]) for name in facts.names}
    values = np.array(list(place.values()))
    if home is None and not np.all((facts.low <= values) & (values <= facts.high)):
        return "", rest
    return wanted, place


def _frozen(
    whole: mujoco.MjModel, facts: Survey, chosen: tuple[str, ...], pose: dict[str, float], notes: Notes
) -> tuple[tuple[str, float], ...]:
    """Where joints are welded that are elsewhere than as drawn; a line for each that is welded, and why."""
    why = {**joints_of_things(whole), **bound_joints(whole)}
    frozen = []
    for name, unit, reference in zip(facts.names, facts.units, facts.reference, strict=True):
        if name not in chosen:
            notes.dropped(f"joint {name}", f"{why.get(name, 'is not named')}; welded at {pose[name]:g} {unit}")
            if pose[name] != reference:
                frozen.append((name, pose[name]))
    return tuple(frozen)


def _check_home(file: Path, facts: Survey, home: Array) -> None:
    for name, unit, value, low, high in zip(facts.names, facts.units, home, facts.low, facts.high, strict=True):
        if not low <= value <= high:
            raise ValueError(
                f"{file}: home of joint {name!r} is {value:g} {unit}; its range is {low:g} to {high:g} {unit}"
            )
