"""From a file's model to its link side: what is no link goes, joints that are not driven are welded where they stand.

The inertia of every body is made its own first, so that geoms and meshes can go without changing it. Then the file's
whole model is compiled once, with balls in the place of meshes: it tells what joints and actuators there are.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from fo_gym.robots.file import mujoco_errors
from fo_gym.robots.meshes import find_file, find_meshes, note_missing
from fo_gym.robots.report import Notes
from fo_gym.robots.welding import SLIDE, weld

_OFF = int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT)

# What is deleted, in an order in which nothing refers to what is gone.
_NO_LINKS = (
    "skins",
    "sensors",
    "actuators",
    "equalities",
    "tendons",
    "pairs",
    "excludes",
    "flexes",
    "keys",
    "tuples",
    "texts",
    "numerics",
)
_LOOKS = ("geoms", "meshes", "hfields", "materials", "textures", "cameras", "lights")

HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)

ENDLESS = 1e6
"""A range that reaches farther than this [m | rad] is none."""

__all__ = ["ENDLESS", "HINGE", "SLIDE", "compile_whole", "counts", "link_side_of"]


def counts(spec: mujoco.MjSpec) -> dict[str, int]:
    """How many there are of each kind of element that a link side has not."""
    return {kind: len(getattr(spec, kind)) for kind in (*_NO_LINKS, "plugins") if len(getattr(spec, kind))}


def compile_whole(spec: mujoco.MjSpec, file: Path, notes: Notes, *, pictures: bool = False) -> mujoco.MjModel:
    """Compile the file as it stands, every body's inertia its own; skins and flexes go, and meshes without `pictures`.

    Args:
        spec: what was read, changed in place.
        file: for errors, and to find meshes.
        notes: gets what was dropped.
        pictures: whether meshes stay, where they are found.

    Raises:
        ValueError: MuJoCo does not compile it, or a mass is to come from a mesh that is not there.
    """
    for kind in ("skins", "flexes", "sensors"):
        _delete(spec, kind)
    if not pictures:
        for element in (*spec.geoms, *spec.sites, *spec.tendons):
            element.material = ""
        for kind in ("materials", "textures"):
            _delete(spec, kind)
    _without_textures(spec, file)
    missing = find_meshes(spec, file)
    note_missing(missing, notes)
    _own_inertia(spec, file, missing, notes)
    _without_meshes(spec, missing if pictures else {mesh.name for mesh in spec.meshes})
    for mesh in spec.meshes:  # of those that only show, a surface is enough
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    return _compiled(spec, file, notes)


def _own_inertia(spec: mujoco.MjSpec, file: Path, missing: set[str], notes: Notes) -> None:
    """Make the inertia that a body has from its geoms its own; then nothing depends on geoms any more."""
    how = spec.compiler.inertiafromgeom
    kinds = mujoco.mjtInertiaFromGeom
    spec.compiler.inertiafromgeom = kinds.mjINERTIAFROMGEOM_FALSE
    if how == kinds.mjINERTIAFROMGEOM_FALSE:
        return
    always = how == kinds.mjINERTIAFROMGEOM_TRUE
    inferring = [body for body in spec.bodies[1:] if body.geoms and (always or not body.explicitinertial)]
    for body in inferring:
        without = {geom.meshname for geom in body.geoms} & missing
        if without:
            raise ValueError(
                f"{file}: body {body.name!r} has no <inertial>, and its mesh {sorted(without)} is not found; "
                "give it an <inertial>, or put the mesh where the file says"
            )
    if not inferring:
        return
    whole = spec.copy()
    whole.compiler.inertiafromgeom = how
    needed = {geom.meshname for body in inferring for geom in body.geoms}
    _without_meshes(whole, {mesh.name for mesh in whole.meshes} - needed)
    model = _compiled(whole, file, notes)
    spec.compiler.balanceinertia = whole.compiler.balanceinertia
    for body in inferring:
        compiled = model.body(body.name)
        body.mass, body.ipos, body.iquat, body.inertia = (
            compiled.mass[0],
            compiled.ipos,
            compiled.iquat,
            compiled.inertia,
        )
        body.fullinertia, body.explicitinertial = [np.nan] * 6, True
        body.ialt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT


def _compiled(spec: mujoco.MjSpec, file: Path, notes: Notes) -> mujoco.MjModel:
    try:
        with mujoco_errors(file, "compile it"):
            return spec.compile()
    except ValueError as error:
        if "A + B >= C" not in str(error):
            raise
    spec.compiler.balanceinertia = True
    notes.assumed("inertia", "one that no body has (A + B < C) was balanced: its three values became their mean")
    with mujoco_errors(file, "compile it"):
        return spec.compile()


def _without_textures(spec: mujoco.MjSpec, file: Path) -> None:
    """Take textures out whose files are not found; materials keep their colours."""
    missing = set()
    for texture in spec.textures:
        files = [name for name in (texture.file, *texture.cubefiles) if name]
        if not all(find_file(name, file, texture.compiler.texturedir or "") for name in files):
            missing.add(texture.name)
    for material in spec.materials:
        material.textures = ["" if name in missing else name for name in material.textures]
    for texture in list(spec.textures):
        if texture.name in missing:
            spec.delete(texture)


def _without_meshes(spec: mujoco.MjSpec, meshes: set[str]) -> None:
    """Take meshes out, and all height fields; balls stand where they were, for what refers to their geoms."""
    for geom in spec.geoms:
        if geom.meshname in meshes or geom.hfieldname:
            geom.type, geom.meshname, geom.hfieldname = mujoco.mjtGeom.mjGEOM_SPHERE, "", ""
            geom.size, geom.rgba, geom.material = [1e-3, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], ""
    for mesh in list(spec.meshes):
        if mesh.name in meshes:
            spec.delete(mesh)
    _delete(spec, "hfields")


def _delete(spec: mujoco.MjSpec, kind: str) -> None:
    for element in list(getattr(spec, kind)):
        spec.delete(element)


def link_side_of(
    spec: mujoco.MjSpec,
    whole: mujoco.MjModel,
    joints: tuple[str, ...],
    frozen: Mapping[str, float],
    damping: Mapping[str, float],
    *,
    pictures: bool = False,
) -> mujoco.MjModel:
    """The link side: `joints` alone move, the others are welded; no contacts, constraints, armature, dry friction.

    Args:
        spec: what `compile_whole` left, changed in place.
        whole: what it compiled.
        joints: those that stay.
        frozen: where joints are welded [m | rad]; others at the file's own reference.
        damping: of each of `joints`, the actuators' included [N s/m | N m s/rad].
        pictures: whether geoms, cameras and lights stay.
    """
    for kind in _NO_LINKS:
        _delete(spec, kind)
    for kind in () if pictures else _LOOKS:
        _delete(spec, kind)
    for name in joints:
        _make_plain(spec.joint(name), whole.joint(name), damping[name])
    for joint in list(spec.joints):
        if joint.name not in joints:
            spec.delete(joint)
    spec.option.disableflags |= _OFF
    spec.option.wind = [0.0, 0.0, 0.0]
    spec.option.enableflags = 0
    model = spec.compile()
    if weld(model, whole, joints, frozen):
        spec.copy_back(model)
        model = spec.compile()
    return model


def _make_plain(joint: mujoco.MjsJoint, compiled: Any, damping: float) -> None:
    """Motors have the armature, friction is the plant's; springs and dampers of the file stay, at their own values."""
    joint.armature, joint.frictionloss, joint.actgravcomp = 0.0, 0.0, False
    if np.any(joint.springdamper):
        joint.springdamper = [0.0, 0.0]
        joint.stiffness = [float(compiled.stiffness[0]), 0.0, 0.0]
        joint.damping = [float(compiled.damping[0]), 0.0, 0.0]
    joint.damping[0] = damping
    if np.abs(compiled.range).max() > ENDLESS:
        joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
