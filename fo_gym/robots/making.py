"""From a file to all that a robot is made of; each decision leaves a line in the report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import instance, real_array
from fo_gym.friction import LuGre
from fo_gym.hardware import Hardware
from fo_gym.parameters import FlexibleJoint, per_joint
from fo_gym.robots.choosing import (
    check_home,
    check_ranges,
    chosen_joints,
    frozen_joints,
    named_pose,
    resting_pose,
)
from fo_gym.robots.design import designed_friction, designed_joints
from fo_gym.robots.design_hardware import designed_hardware
from fo_gym.robots.editing import compile_whole
from fo_gym.robots.exchange import NO_TOOL
from fo_gym.robots.file import existing_file, read_spec
from fo_gym.robots.home import found_home, poor_home, redundant_joints
from fo_gym.robots.inventory import listed, note_sources, note_the_rest
from fo_gym.robots.link_side import LinkSide
from fo_gym.robots.poses import natural_units
from fo_gym.robots.report import Notes, Report
from fo_gym.robots.sanity import check_count, check_numbers_of
from fo_gym.robots.survey import Survey, survey
from fo_gym.robots.tool import end_of_chain

Array = NDArray[np.float64]

_GENERAL = {"robot", "model", "scene", "arm", "main"}
"""Names of files that say nothing of the robot; their folder does."""

_HOME = "home"
"""The keyframe that is looked for."""

_OF_JOINTS = tuple(field.name for field in fields(FlexibleJoint))
_OF_FRICTION = tuple(field.name for field in fields(LuGre))

__all__ = ["made_from_file"]


def made_from_file(
    path: Any,
    *,
    joints: Any = None,
    tool: Any = None,
    camera: str | None = None,
    home: Any = None,
    frozen: tuple[tuple[str, float], ...] | None = None,
    known: Mapping[str, Any],
    sources: Mapping[str, str],
    redundant: Any = None,
    hardware: Hardware | None = None,
) -> dict[str, Any]:
    """The fields of a `Robot` that a file decides, or a design.

    Args:
        path, joints, tool, home, redundant, hardware: as of `Robot.from_file`.
        camera: of the link side.
        frozen: where joints are welded, or None for the pose of home.
        known: parameters of `FlexibleJoint` and `LuGre` that are not designed, by name.
        sources: where they are from, by "flexible.<name>" and "friction.<name>".
    """
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
    welded = frozen_joints(whole, everything, chosen, pose, notes, frozen)
    link_side = LinkSide(file, chosen, tool, camera, welded)
    model = link_side.model
    there = pose[[everything.names.index(name) for name in chosen]]
    start = _start(file, model, own, tool, home, key, there, notes)
    note_the_rest(spec, whole, own, notes, set(known))
    flexible, friction = designed(model, start, own, known)
    if redundant is None:
        redundant = redundant_joints(model, start, tool)
    if hardware is None:
        hardware = designed_hardware(flexible, friction, natural_units(model))
        notes.assumed("hardware", "sensors, commands and joints as imperfect as the MIRO-like arm's, for its variant")
    return {
        "name": file.parent.name if file.stem in _GENERAL else file.stem,
        "link_side": link_side,
        "units": own.units,
        "flexible": flexible,
        "friction": friction,
        "home": start,
        "hardware": hardware,
        "redundant": tuple(redundant) if isinstance(redundant, list) else redundant,
        "sources": note_sources(own, flexible, friction, known, sources, notes),
        "report": Report(tuple(notes)),
    }


def designed(
    model: mujoco.MjModel, start: Array, facts: Survey, known: Mapping[str, Any]
) -> tuple[FlexibleJoint, LuGre]:
    """Motors, springs and friction: what is known, the rest by design from it and from what the file says."""
    dof = len(facts.names)
    given = {
        name: real_array(name, np.broadcast_to(value, dof) if np.size(value) == 1 else value, (dof,))
        for name, value in known.items()
    }
    mine = {name: given[name] for name in _OF_JOINTS if name in given}
    if len(mine) < len(_OF_JOINTS):
        armature, limit = mine.get("motor_inertia", facts.armature), mine.get("torque_limit", _limit(facts))
        mine = {**vars(designed_joints(model, start, armature=armature, torque_limit=limit)), **mine}
    flexible = per_joint(FlexibleJoint(**mine), dof)
    rubs = {name: given[name] for name in _OF_FRICTION if name in given}
    if len(rubs) < len(_OF_FRICTION):
        dry = rubs.get("f_c", facts.frictionloss)
        rubs = {**vars(designed_friction(model, flexible, frictionloss=dry)), **rubs}
    return flexible, per_joint(LuGre(**rubs), dof)


def _limit(facts: Survey) -> Array:
    return np.where(np.isnan(facts.torque_limit), np.inf, facts.torque_limit)


def _tool(whole: mujoco.MjModel, chosen: tuple[str, ...], tool: str | None, notes: Notes) -> str | None:
    if tool == NO_TOOL:
        return None
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
    file: Path, model: mujoco.MjModel, facts: Survey, tool: str | None, home: Any, key: str, there: Array, notes: Notes
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
