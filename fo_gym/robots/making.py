"""From a file to all that a robot is made of; each decision leaves a line in the report."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import instance, real_array
from fo_gym.hardware import Hardware
from fo_gym.parameters import FlexibleJoint, LuGre, per_joint
from fo_gym.robots.choosing import (
    check_home,
    check_ranges,
    chosen_joints,
    frozen_joints,
    named_pose,
    resting_pose,
)
from fo_gym.robots.design import designed_friction, designed_joints
from fo_gym.robots.editing import compile_whole
from fo_gym.robots.file import existing_file, read_spec
from fo_gym.robots.home import found_home, poor_home, redundant_joints
from fo_gym.robots.inventory import listed, note_design, note_the_rest
from fo_gym.robots.link_side import LinkSide
from fo_gym.robots.report import Notes, Report
from fo_gym.robots.sanity import check_count, check_numbers_of
from fo_gym.robots.survey import Survey, survey
from fo_gym.robots.tool import end_of_chain

Array = NDArray[np.float64]

_GENERAL = {"robot", "model", "scene", "arm", "main"}
"""Names of files that say nothing of the robot; their folder does."""

_HOME = "home"
"""The keyframe that is looked for."""

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
    check_numbers_of(file, whole)
    everything = survey(whole)
    check_ranges(file, everything)
    chosen = chosen_joints(file, whole, everything, joints, notes)
    check_count(file, chosen)
    own = everything.of(chosen)
    tool = _tool(whole, chosen, tool, notes)
    key, pose = _pose(file, whole, everything, home)
    link_side = LinkSide(file, chosen, tool, None, frozen_joints(whole, everything, chosen, pose, notes))
    model = link_side.model
    there = pose[[everything.names.index(name) for name in chosen]]
    start = _start(file, model, own, tool, home, key, there, notes)
    note_the_rest(spec, whole, own, notes, friction_given=friction is not None, flexible_given=flexible is not None)
    motors = flexible or designed_joints(model, start, armature=own.armature, torque_limit=_limit(own))
    motors = per_joint(motors, len(chosen))
    if friction is None:
        friction = designed_friction(model, motors, frictionloss=own.frictionloss)
        note_design(own, friction, notes)
    if flexible is None:
        note_design(own, motors, notes)
    if redundant is None:
        redundant = redundant_joints(model, start, tool)
    return {
        "name": file.parent.name if file.stem in _GENERAL else file.stem,
        "link_side": link_side,
        "units": own.units,
        "flexible": motors,
        "friction": friction,
        "home": start,
        "redundant": redundant_joints(model, start, tool)
        if redundant is None
        else tuple(redundant)
        if isinstance(redundant, list)
        else redundant,
        "hardware": hardware,
        "report": Report(tuple(notes)),
    }


def _limit(facts: Survey) -> Array:
    return np.where(np.isnan(facts.torque_limit), np.inf, facts.torque_limit)


def _tool(whole: mujoco.MjModel, chosen: tuple[str, ...], tool: str | None, notes: Notes) -> str:
    if tool is not None:
        notes.taken("tool", tool)
        return tool
    tool, why = end_of_chain(whole, chosen)
    notes.assumed("tool", f"{tool}: {why}")
    return tool


def _pose(file: Path, whole: mujoco.MjModel, facts: Survey, home: Any) -> tuple[str, Array]:
    """The keyframe that home names, or might be, and "" for none; where all of the file's joints are then."""
    if isinstance(home, str):
        return home, named_pose(file, whole, facts, home)
    if home is None and any(whole.key(i).name == _HOME for i in range(whole.nkey)):
        pose = named_pose(file, whole, facts, _HOME)
        if np.all((facts.low <= pose) & (pose <= facts.high)):
            return _HOME, pose
    return "", resting_pose(facts)


def _start(
    file: Path, model: mujoco.MjModel, facts: Survey, tool: str, home: Any, key: str, there: Array, notes: Notes
) -> Array:
    """The start pose, (dof,): as given, from the keyframe `key`, where it is `there`, or found."""
    if key and (home is not None or not (poor := poor_home(model, there, tool))):
        start = there
        notes.taken("home", f"keyframe {key}")
    elif home is not None:
        start = real_array("home", home, (len(facts.names),))
        notes.taken("home", "as given")
    else:
        start = found_home(model, tool, _limit(facts))
        besides = f"; keyframe {key} is not taken: {poor}" if key else ""
        notes.assumed("home", f"{listed(facts.names, start)}: found, away from limits and singular poses{besides}")
    check_home(file, facts, start)
    return start
