"""URDF, made ready for MuJoCo: links stay as they are, meshes are looked for, impossible inertias get a remedy."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import shown
from fo_gym.robots.meshes import find_mesh, note_missing
from fo_gym.robots.report import Notes
from fo_gym.text import one_line

LEAST_MASS, LEAST_INERTIA = 1e-3, 1e-6
"""Of a moving part without mass [kg, kg m^2]: a gram, within a few centimetres."""

_LARGE = 1e9
"""What a file gives as mass [kg] or inertia [kg m^2] is below this."""

_NO_INERTIA = 1e-14
"""What rounding leaves of an inertia of 0 [kg m^2]; MuJoCo takes nothing below 1e-15."""

_SCALAR = ("revolute", "continuous", "prismatic")
_SIX = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")

__all__ = ["LEAST_INERTIA", "LEAST_MASS", "urdf_for_mujoco"]


def urdf_for_mujoco(file: Path, notes: Notes) -> str:
    """The text of a URDF file as MuJoCo is to read it.

    Raises:
        ValueError: the file is no XML, has no links, joints between links that are not there, a circle of links, or
            a mass or an inertia that cannot be.
    """
    try:
        root = ET.parse(file).getroot()
    except (ET.ParseError, ValueError, LookupError) as error:
        raise ValueError(f"{file} is no XML: {one_line(str(error), 200)}; give an MJCF or URDF file") from None
    if any("xacro" in str(element.tag) for element in root.iter()):
        raise ValueError(f"{file} is a xacro, from which URDF is made; run xacro on it and give what it prints")
    parents = _parents(file, root)
    for joint in root.findall("joint"):
        _check_limit(file, joint)
        _plain_joint(joint, notes)
    _hold_followers(root, notes)
    for link in root.iter("link"):
        _check_inertial(file, link, notes)
    _fill_massless(root, parents, notes)
    _resolve_meshes(file, root, notes)
    _compiler(root)
    return ET.tostring(root, encoding="unicode")


def _parents(file: Path, root: ET.Element) -> dict[str, tuple[str, ET.Element]]:
    """For each link but the base the link that it hangs on, and by which joint."""
    links = [link.get("name", "") for link in root.findall("link")]
    if not links:
        raise ValueError(f"{file} has no <link>; give a URDF file with links and joints")
    names = [joint.get("name", "") for joint in root.findall("joint")]
    for kind, all_of_them in (("link", links), ("joint", names)):
        for name in all_of_them:
            if not name or all_of_them.count(name) > 1:
                raise ValueError(f"{file}: a {kind} is named {name!r}; give each {kind} a name of its own")
    parents: dict[str, tuple[str, ET.Element]] = {}
    for joint in root.findall("joint"):
        name = joint.get("name", "")
        ends = [("" if end is None else end.get("link", "")) for end in (joint.find("parent"), joint.find("child"))]
        for end, kind in zip(ends, ("parent", "child"), strict=True):
            if end not in links:
                raise ValueError(f"{file}: the {kind} of joint {name!r} is {end!r}; the links are {shown(links)}")
        if ends[1] in parents:
            raise ValueError(f"{file}: link {ends[1]!r} is the child of two joints; in a URDF it has one parent")
        parents[ends[1]] = ends[0], joint
    for link in links:
        met, here = {link}, link
        while here in parents:
            here = parents[here][0]
            if here in met:
                raise ValueError(f"{file}: the joints go in a circle through link {here!r}; a URDF is a tree of links")
            met.add(here)
    return parents


def _check_limit(file: Path, joint: ET.Element) -> None:
    limit, name = joint.find("limit"), joint.get("name", "")
    if limit is None:
        return
    low, high = _numbers(file, f"joint {name!r}", limit, ("lower", "upper"), np.inf)
    effort = _numbers(file, f"joint {name!r}", limit, ("effort",), np.inf)[0]
    if low > high:
        raise ValueError(f"{file}: the range of joint {name!r} is ({low:g}, {high:g}); give lower below upper")
    if effort < 0.0:
        raise ValueError(f"{file}: the effort of joint {name!r} is {effort:g}; it must be above 0, or left out")
    if effort == 0.0 or np.isinf(effort):
        limit.attrib.pop("effort", None)


def _plain_joint(joint: ET.Element, notes: Notes) -> None:
    """Take away what MuJoCo does not take, or only warns of, in place."""
    what, kind, limit = f"joint {joint.get('name')}", joint.get("type"), joint.find("limit")
    if kind == "floating":
        joint.set("type", "fixed")
        notes.dropped(what, "a floating joint: what hangs on it is fixed where it stands")
    if kind == "revolute" and (limit is None or limit.get("lower", "0") == limit.get("upper", "0")):
        joint.set("type", "continuous")
        notes.assumed(what, "its limits are equal, or missing: it turns without limits")


def _hold_followers(root: ET.Element, notes: Notes) -> None:
    """Joints that follow one which does not move, or is not there, do not move either; MuJoCo only warns of them."""
    moving = {joint.get("name") for joint in root.findall("joint") if joint.get("type") in _SCALAR}
    for joint in root.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is None or (joint.get("type") in _SCALAR and mimic.get("joint") in moving):
            continue
        joint.remove(mimic)
        if joint.get("type") in _SCALAR:
            joint.set("type", "fixed")
            notes.dropped(
                f"joint {joint.get('name')}", f"follows {mimic.get('joint')}, which does not move: it is fixed"
            )


def _numbers(
    file: Path, what: str, element: ET.Element, names: tuple[str, ...], largest: float = _LARGE
) -> list[float]:
    values = []
    for name in names:
        text = element.get(name, "0")
        try:
            value = float(text)
        except ValueError:
            value = np.nan
        if not abs(value) <= largest:
            raise ValueError(f"{file}: {name} of {what} is {shown(text)}; give a number of at most {largest:g}")
        values.append(value)
    return values


def _matrix(six: list[float]) -> NDArray[np.float64]:
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _check_inertial(file: Path, link: ET.Element, notes: Notes) -> None:
    """Refuse impossible masses; an inertial that says nothing is taken away, an impossible inertia replaced."""
    name, inertial = link.get("name", ""), link.find("inertial")
    if inertial is None:
        return
    mass_of, inertia_of = inertial.find("mass"), inertial.find("inertia")
    mass = 0.0 if mass_of is None else _numbers(file, f"link {name!r}", mass_of, ("value",))[0]
    six = [0.0] * 6 if inertia_of is None else _numbers(file, f"link {name!r}", inertia_of, _SIX)
    if mass < 0.0:
        raise ValueError(f"{file}: the mass of link {name!r} is {mass:g} kg; it must be at least 0")
    if mass == 0.0:
        link.remove(inertial)
        notes.dropped(f"link {name}", "its inertial has no mass and counts as none")
        return
    if np.linalg.eigvalsh(_matrix(six))[0] > _NO_INERTIA:
        return
    if inertia_of is not None:
        inertial.remove(inertia_of)
    value = mass * LEAST_INERTIA / LEAST_MASS
    sphere = dict.fromkeys(_SIX[:3], repr(value)) | dict.fromkeys(_SIX[3:], "0")
    ET.SubElement(inertial, "inertia", sphere)
    notes.assumed(f"link {name}", f"its inertia is not above 0 about all axes; it got {value:.3g} kg m^2")


def _fill_massless(root: ET.Element, parents: dict[str, tuple[str, ET.Element]], notes: Notes) -> None:
    """Give what moves and has no mass, itself or by what is fixed to it, a least mass."""
    moving = {link for link, (_, joint) in parents.items() if joint.get("type") != "fixed"}
    heavy = set()
    for link in root.findall("link"):
        here = link.get("name", "")
        if link.find("inertial") is not None:
            while here in parents and here not in moving:
                here = parents[here][0]
            heavy.add(here)
    for link in root.findall("link"):
        name = link.get("name", "")
        if name in moving - heavy:
            inertial = ET.SubElement(link, "inertial")
            ET.SubElement(inertial, "mass", {"value": repr(LEAST_MASS)})
            six = dict.fromkeys(_SIX[:3], repr(LEAST_INERTIA)) | dict.fromkeys(_SIX[3:], "0")
            ET.SubElement(inertial, "inertia", six)
            notes.assumed(f"link {name}", f"moves and has no mass; it got {LEAST_MASS:g} kg, {LEAST_INERTIA:g} kg m^2")


def _shapes(root: ET.Element) -> Iterator[tuple[ET.Element, ET.Element]]:
    for link in root.iter("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            yield link, shape


def _resolve_meshes(file: Path, root: ET.Element, notes: Notes) -> None:
    """Name meshes by the files they are; what is not found, or not read by MuJoCo, is left out of the pictures."""
    compiler = root.find("mujoco/compiler")
    folder = "" if compiler is None else compiler.get("meshdir", "")
    missing = set()
    for link, shape in _shapes(root):
        shape.attrib.pop("name", None)  # MuJoCo warns of names that come twice
        mesh = shape.find("geometry/mesh")
        if mesh is None:
            continue
        name = mesh.get("filename", "")
        found = find_mesh(name, file, folder)
        if found is None:
            link.remove(shape)
            missing.add(name)
        else:
            mesh.set("filename", str(found.absolute()))
    note_missing(missing, notes)
    for link in root.iter("link"):
        if link.find("visual") is not None:
            for shape in link.findall("collision"):
                link.remove(shape)


def _compiler(root: ET.Element) -> None:
    """Links stay apart, so that each can be the tool; masses are those of the inertials alone."""
    extension = root.find("mujoco")
    if extension is None:
        extension = ET.SubElement(root, "mujoco")
    compiler = extension.find("compiler")
    if compiler is None:
        compiler = ET.SubElement(extension, "compiler")
    compiler.attrib.pop("meshdir", None)
    never = dict.fromkeys(("fusestatic", "discardvisual", "strippath", "inertiafromgeom"), "false")
    compiler.attrib.update(never)
