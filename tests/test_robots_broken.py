"""Robot files that are broken on purpose: each is refused in one line, which says what is wrong and what to do."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from robot_files import CRANE, URDF

from fo_gym.robots import Robot
from fo_gym.robots import file as file_module

MASS = '<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>'


def mjcf(joint: str = "", inside: str = MASS, body: str = "", option: str = "") -> str:
    """One body on one joint."""
    return (
        f'<mujoco>{option}<worldbody><body name="link" {body}><joint name="pivot" {joint}/>{inside}</body>'
        "</worldbody></mujoco>"
    )


def chain(count: int) -> str:
    return (
        "<mujoco><worldbody>"
        + "".join(f'<body name="b{i}"><joint name="j{i}"/>{MASS}' for i in range(count))
        + "</body>" * count
        + "</worldbody></mujoco>"
    )


def inertial(mass: str = "1", inertia: str = "1 1 1") -> str:
    return f'<inertial mass="{mass}" pos="0 0 0" diaginertia="{inertia}"/>'


NO_FILE = {"missing.xml": "does not exist", "no/where.urdf": "does not exist"}

MJCF: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "is empty"),
    "text": ("hello", "is no XML"),
    "another root": ("<html/>", "outermost element is <html>"),
    "cut off": ("<mujoco><worldbody>", "cannot read it"),
    "garbage": (np.random.default_rng(0).bytes(3000), "is no XML"),
    "garbage within": (b"<mujoco>" + np.random.default_rng(1).bytes(3000), "cannot read it"),
    "UTF-16": ("<mujoco/>".encode("utf-16"), "cannot read it"),
    "nothing in it": ("<mujoco/>", "no joint that turns or slides"),
    "no joints": ('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>', "no joint that turns or slides"),
    "ball alone": (mjcf('type="ball"'), "no joint that turns or slides"),
    "mass 0": (mjcf(inside=inertial("0")), "link.*give the body an <inertial>"),
    "mass below 0": (mjcf(inside=inertial("-1")), "link.*give the body an <inertial>"),
    "mass NaN": (mjcf(inside=inertial("nan")), "link.*give the body an <inertial>"),
    "mass infinite": (mjcf(inside=inertial("inf")), "mass of body 'link' is inf"),
    "mass huge": (mjcf(inside=inertial("1e300")), r"mass of body 'link' is 1e\+300"),
    "inertia 0": (mjcf(inside=inertial("1", "0 0 0")), "link.*above 0"),
    "inertia NaN": (mjcf(inside=inertial("1", "1 nan 1")), "link.*above 0"),
    "no mass": (mjcf(inside=""), "link.*give the body an <inertial>"),
    "place NaN": (mjcf(body='pos="0 nan 0"'), r"pos of body 'link' is \[0.0, nan, 0.0\]"),
    "place infinite": (mjcf(body='pos="0 inf 0"'), r"pos of body 'link' is \[0.0, inf, 0.0\]"),
    "range NaN": (mjcf('range="nan 1" limited="true"'), "range of joint 'pivot' is"),
    "range inverted": (mjcf('range="1 -1" limited="true"'), "pivot"),
    "axis 0": (mjcf('axis="0 0 0"'), "axis too small.*pivot"),
    "axis NaN": (mjcf('axis="0 nan 0"'), "axis of joint 'pivot'"),
    "armature below 0": (mjcf('armature="-1"'), "armature of joint 'pivot' is -1"),
    "damping below 0": (mjcf('damping="-1"'), "damping of joint 'pivot' is -1"),
    "damping NaN": (mjcf('damping="nan"'), "damping of joint 'pivot' is nan"),
    "spring infinite": (mjcf('stiffness="inf"'), "stiffness of joint 'pivot' is inf"),
    "frictionloss below 0": (mjcf('frictionloss="-1"'), "frictionloss of joint 'pivot' is -1"),
    "gravity NaN": (mjcf(option='<option gravity="0 0 nan"/>'), r"gravity is \[0.0, 0.0, nan\]"),
    "include missing": ('<mujoco><include file="nope.xml"/></mujoco>', "nope.xml.*put the file"),
    "includes itself": ('<mujoco><include file="broken.xml"/></mujoco>', "broken.xml"),
    "unknown element": ("<mujoco><bodies/></mujoco>", "bodies"),
    "unknown plugin": ('<mujoco><extension><plugin plugin="no.such"/></extension></mujoco>', "no.such"),
    "joint twice": (mjcf(inside=f'{MASS}<joint name="pivot"/>'), "pivot"),
    "mass of a mesh": (
        '<mujoco><asset><mesh name="shell" file="no.stl"/></asset><worldbody><body name="link"><joint/>'
        '<geom type="mesh" mesh="shell"/></body></worldbody></mujoco>',
        r"'link' has no <inertial>, and its mesh \['shell'\] is not found",
    ),
    "deep": (chain(600), "nesting is too deep"),
    "many joints": (chain(300), "300 joints.*at most 256.*name them"),
    "huge": (b"<mujoco>" + b" " * 2_000_000, "2000008 bytes.*at most 1000000"),
}

SMALL = file_module.MAX_BYTES // 50
"""What counts as too large here, so that no test writes fifty megabytes."""

URDFS: dict[str, tuple[str, str]] = {
    "no links": ('<robot name="x"/>', "has no <link>"),
    "unknown parent": (URDF.replace('<parent link="base"/>', '<parent link="bass"/>'), "'bass'; the links are"),
    "circle": (URDF.replace('<parent link="base"/>', '<parent link="fore"/>'), "circle through link"),
    "its own parent": (URDF.replace('<parent link="upper"/><child', '<parent link="fore"/><child'), "circle"),
    "two parents": (
        URDF.replace(
            "</robot>", '<joint name="q" type="fixed"><parent link="base"/><child link="jaw"/></joint></robot>'
        ),
        "'jaw' is the child of two joints",
    ),
    "mass below 0": (URDF.replace('mass value="2"', 'mass value="-2"'), "mass of link 'upper' is -2 kg"),
    "mass a word": (URDF.replace('mass value="2"', 'mass value="heavy"'), "link 'upper' is 'heavy'"),
    "inertia NaN": (URDF.replace('ixx="0.02"', 'ixx="nan"'), "ixx of link 'upper' is 'nan'"),
    "joint without name": (URDF.replace('name="elbow"', ""), "a joint is named ''"),
    "joint twice": (URDF.replace('name="elbow"', 'name="shoulder"'), "a joint is named 'shoulder'"),
    "link twice": (URDF.replace("</robot>", '<link name="fore"/></robot>'), "a link is named 'fore'"),
    "inverted": (URDF.replace('lower="-2" upper="2"', 'lower="2" upper="-2"'), r"'shoulder' is \(2, -2\)"),
    "limit a word": (URDF.replace('lower="-2"', 'lower="low"'), "lower of joint 'shoulder' is 'low'"),
    "effort below 0": (URDF.replace('effort="40"', 'effort="-40"'), "effort of joint 'shoulder' is -40"),
    "damping below 0": (URDF.replace('damping="0.7"', 'damping="-0.7"'), "damping of joint 'shoulder' is -0.7"),
    "unknown type": (URDF.replace('type="continuous"', 'type="wobbly"'), "joint type"),
    "axis 0": (URDF.replace('xyz="0.2 1 0"', 'xyz="0 0 0"'), "axis too small"),
    "half an origin": (URDF.replace('xyz="0 0.05 0.3"', 'xyz="0 0.05"'), "xyz"),
    "a xacro": ('<robot xmlns:xacro="http://ros.org/xacro" name="x"><xacro:macro/></robot>', "run xacro"),
}

ARGUMENTS: list[tuple[dict[str, Any], str]] = [
    ({"joints": ("rail", "nope")}, r"\['nope'\] are not there.*'rail', 'turn'"),
    ({"joints": ("rail", "rail")}, r"\['rail'\] twice"),
    ({"joints": ("turn", "rail")}, r"in the file's order, \('rail', 'turn'\)"),
    ({"joints": "rail"}, "give a list of names"),
    ({"joints": ()}, "give some of"),
    ({"joints": ("socket",)}, r"\['socket'\] are not there, or neither turn nor slide"),
    ({"tool": "nope"}, r"tool 'nope' is not there; sites are \['middle', 'tip'\]"),
    ({"tool": 3}, "tool is 3"),
    ({"home": [0.0, 0.0]}, r"shape \(2,\).*\(5,\)"),
    ({"home": [np.nan] * 5}, "home is .*nan"),
    ({"home": [9.0] * 5}, "home of joint 'rail' is 9 m; its range is -1 to 1 m"),
    ({"home": "nope"}, r"keyframe 'nope'; the file has \['parked'\]"),
    ({"home": 3}, "home is 3"),
    ({"redundant": ("nope",)}, r"redundant is \('nope',\).*'rail'"),
    ({"redundant": ("turn", "turn")}, "each once"),
    ({"redundant": "turn"}, "redundant is 'turn'"),
    ({"flexible": 3}, "flexible is 3"),
    ({"friction": "none"}, "friction is 'none'"),
    ({"hardware": 1}, "hardware is 1"),
]


def offenders(cases: Iterator[tuple[str, Any, dict[str, Any], type[Exception], str]]) -> list[str]:
    """Cases that are not refused with that error in one line."""
    found = []
    for name, file, options, error, words in cases:
        try:
            with pytest.raises(error, match=words) as refusal:
                Robot.from_file(file, **options)
            if "\n" in str(refusal.value) or len(str(refusal.value)) > 900:
                found.append(f"{name}: more than a line")
        except (Exception, pytest.fail.Exception) as failure:
            found.append(f"{name}: {' '.join(str(failure).split())[:300]}")
    return found


@pytest.fixture(autouse=True)
def no_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No file of MuJoCo's may lie about."""
    monkeypatch.chdir(tmp_path)
    yield
    assert not [name for name in os.listdir(tmp_path) if "LOG" in name]


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    cases = [(name, name, {}, FileNotFoundError, words) for name, words in NO_FILE.items()]
    cases += [(repr(value)[:20], value, {}, ValueError, "robot file") for value in (None, 3, "", "a\0b", "x" * 5000)]
    cases += [("folder", tmp_path, {}, ValueError, "is a folder; give the MJCF")]
    assert offenders(iter(cases)) == []


def test_broken_files_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(file_module, "MAX_BYTES", SMALL)

    def cases() -> Iterator[tuple[str, Any, dict[str, Any], type[Exception], str]]:
        for kind, table in (("broken.xml", MJCF), ("broken.urdf", URDFS)):
            for name, (content, words) in table.items():
                path = tmp_path / kind
                path.write_bytes(content if isinstance(content, bytes) else content.encode())
                yield name, path, {}, ValueError, words

    assert offenders(cases()) == []


def test_wrong_arguments_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "crane.xml"
    path.write_text(CRANE)
    assert offenders(iter([(repr(given), path, given, ValueError, words) for given, words in ARGUMENTS])) == []
