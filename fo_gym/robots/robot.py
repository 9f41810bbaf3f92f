"""A robot as one object: its links, its flexible joints, their friction, where it starts and what it works with."""

from __future__ import annotations

import hashlib
import inspect
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import instance, real_array, shown, text
from fo_gym.friction import FrictionLaw, LuGre
from fo_gym.hardware import Effect, Hardware
from fo_gym.parameters import FlexibleJoint, ImpedanceGains, PDGains, per_joint
from fo_gym.robots.advice import Advice, advice
from fo_gym.robots.exchange import read_robot, robot_text
from fo_gym.robots.link_side import LinkSide
from fo_gym.robots.making import made_from_file
from fo_gym.robots.poses import SLIDE
from fo_gym.robots.report import Report

Array = NDArray[np.float64]

_NO_MOTION = ("name", "link_side", "report", "sources")
"""Fields that a robot's fingerprint does not need: the model of its links is in it."""

__all__ = ["Robot"]


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot with flexible joints, or any other arm made into one; `Robot.from_file` makes it of MJCF or URDF.

    Attributes:
        name: what tables call it.
        link_side: its links, from a file.
        units: of each joint's position, "rad" or "m".
        flexible: motor and spring of each joint, arrays (dof,).
        friction: of each motor, arrays (dof,).
        home: where it starts (dof,) [m | rad], within the range of every joint.
        redundant: joints whose angles a task-space controller holds, beside the tool.
        hardware: what sets it apart from its model, or None.
        identified: a model of its friction that compensators may use, arrays (dof,); None where nobody identified it.
        pd_gains: of its motor PD in joint space, arrays (dof,); None for gains by design.
        impedance_gains: of its task-space impedance; None likewise.
        sources: where numbers are from, by their path, such as "friction.f_c".
        report: what was taken from the file, dropped, assumed.
    """

    name: str
    link_side: LinkSide
    units: tuple[str, ...]
    flexible: FlexibleJoint
    friction: FrictionLaw
    home: Array
    redundant: tuple[str, ...] = ()
    hardware: Hardware | None = None
    identified: LuGre | None = None
    pd_gains: PDGains | None = None
    impedance_gains: ImpedanceGains | None = None
    sources: Mapping[str, str] = field(default_factory=dict)
    report: Report = field(default_factory=Report)

    def __post_init__(self) -> None:
        text("Robot.name", self.name)
        instance("Robot.link_side", self.link_side, LinkSide)
        instance("Robot.flexible", self.flexible, FlexibleJoint)
        instance("Robot.friction", self.friction, FrictionLaw)
        instance("Robot.hardware", self.hardware, Hardware, none="none")
        instance("Robot.identified", self.identified, LuGre, none="none known")
        instance("Robot.pd_gains", self.pd_gains, PDGains, none="gains by design")
        instance("Robot.impedance_gains", self.impedance_gains, ImpedanceGains, none="gains by design")
        for name in ("flexible", "friction", "identified", "pd_gains"):
            value = getattr(self, name)
            object.__setattr__(self, name, None if value is None else per_joint(value, self.dof))
        object.__setattr__(self, "home", real_array("Robot.home", self.home, (self.dof,)))
        if self.hardware is not None:
            self.hardware.check_joints(self.dof)
        names: Any = self.redundant
        listed = isinstance(names, tuple) and all(isinstance(name, str) for name in names)
        if not listed or len(set(names)) < len(names) or not set(names) <= set(self.joints):
            raise ValueError(f"redundant is {shown(names)}; give a tuple of names, each once, of {self.joints}")

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the flexible joints."""
        return self.link_side.joints

    @property
    def dof(self) -> int:
        """Number of flexible joints."""
        return self.link_side.dof

    @cached_property
    def fingerprint(self) -> str:
        """Hash of all that decides how it moves, whatever its files are called."""
        model = self.link_side.model
        links = np.zeros(mujoco.mj_sizeModel(model), dtype=np.uint8)
        mujoco.mj_saveModel(model, None, links)
        parts = {each.name: getattr(self, each.name) for each in fields(self) if each.name not in _NO_MOTION}
        told = repr({name: _content(part) for name, part in parts.items()}) + repr(self.tool)
        return hashlib.sha256(links.tobytes() + told.encode()).hexdigest()

    @property
    def joint_unit(self) -> str:
        """Unit that the joints are told in, "rad" or "m"; where some turn and some slide, "rad", see `levers`."""
        return "m" if set(self.units) == {"m"} else "rad"

    @property
    def levers(self) -> Array:
        """What `joint_unit` is of each joint's own unit, (dof,): 1, but for slides among hinges 0.1 m/rad.

        Divided by it, positions and velocities of all joints compare; multiplied, torques do, and energies are kept.
        """
        return np.where([unit == self.joint_unit for unit in self.units], 1.0, SLIDE)

    @property
    def tool(self) -> str | None:
        """Name of the tool's site or body."""
        return self.link_side.tool

    def advice(self, gains: PDGains | None = None, control_dt: float = 1e-3) -> Advice:
        """Check list of what its numbers mean for control: modes, micro-steps, conditions of observers and of gains.

        Args:
            gains: of a motor PD; None for the robot's own. Where it has none, what is about gains is left out.
            control_dt: control period [s].
        """
        gains = self.pd_gains if gains is None else per_joint(gains, self.dof)
        return advice(self.link_side, self.flexible, self.friction, self.home, gains, control_dt)

    @classmethod
    def from_file(
        cls,
        path: str | PathLike[str],
        *,
        joints: tuple[str, ...] | None = None,
        tool: str | None = None,
        home: str | Array | None = None,
        flexible: FlexibleJoint | None = None,
        friction: FrictionLaw | None = None,
        hardware: Hardware | None = None,
        redundant: tuple[str, ...] | None = None,
    ) -> Robot:
        """Make a robot of an MJCF or URDF file; what is not given is taken from it, or designed. See `report`.

        Its friction counts as identified: compensators that build on a model of it have the nominal one.

        Args:
            path: the file.
            joints: names of the flexible joints, in the file's order; None for all that turn or slide, but those that
                the file binds to others, and those of things beside the robot. The others are welded at home.
            tool: name of a site or a body (URDF: link); None for the end of the longest chain of the joints.
            home: (dof,) [m | rad], a keyframe's name, or None: the keyframe "home" where there is one, or a pose in
                the middle of the ranges.
            flexible: motors and springs; None for those of `fo_gym.robots.design`.
            friction: of the motors; None likewise.
            hardware: for the "hardware" variant of environments; None for that of `fo_gym.robots.design_hardware`.
            redundant: joints whose angles a task-space controller holds; None to choose them.

        Raises:
            FileNotFoundError: there is no such file.
            ValueError: the file is broken, or has not what is named; what there is, is told.
        """
        instance("flexible", flexible, FlexibleJoint, none="joints by design")
        instance("friction", friction, FrictionLaw, none="friction by design")
        instance("hardware", hardware, Hardware, none="hardware by design")
        lugre = friction if isinstance(friction, LuGre) else None
        known = {**({} if flexible is None else vars(flexible)), **({} if lugre is None else vars(lugre))}
        chosen: dict[str, Any] = {"joints": joints, "tool": tool, "home": home, "redundant": redundant}
        made = made_from_file(path, **chosen, known=known, sources={}, hardware=hardware)
        identified = made["friction"]
        return cls(**{**made, "friction": friction or identified}, identified=identified)

    @classmethod
    def from_toml(cls, path: str | PathLike[str]) -> Robot:
        """Read a robot that `to_toml` wrote, or somebody by hand: what is missing is designed, as by `from_file`.

        Raises:
            FileNotFoundError: the file is not there, or that of the robot, or the package that has it.
            ValueError: there is something in it that a robot has not, or that it does not take.
        """
        said = read_robot(Path(path))
        keys = ("joints", "tool", "camera", "home", "frozen", "known", "sources", "redundant", "hardware")
        made = made_from_file(said["file"], **{key: said[key] for key in keys})
        made["sources"] = {**said["sources"], **made["sources"]}
        law = said["friction"]
        if law is not None:
            made["friction"] = law if isinstance(law, FrictionLaw) else law.like(made["friction"])
        parts = ("identified", "pd_gains", "impedance_gains")
        return cls(**{**made, "name": said["name"], **{part: said[part] for part in parts}})

    def to_toml(self, path: str | PathLike[str]) -> None:
        """Write the robot as a robot.toml, from which `from_toml` makes the same one; its file is named from there."""
        target = Path(path)
        target.write_text(robot_text(vars(self), target.parent), encoding="utf-8", newline="\n")


def _content(part: Any) -> Any:
    """A field, exactly: arrays as lists, parameters by their fields' names, effects and laws with their source."""
    if isinstance(part, np.ndarray):
        return part.tolist()
    if isinstance(part, tuple):
        return [_content(each) for each in part]
    if isinstance(part, Effect | FrictionLaw):
        return {**{name: _content(value) for name, value in vars(part).items()}, "class": _source(part)}
    if is_dataclass(part):
        return {name: _content(value) for name, value in vars(part).items()}
    return part


def _source(part: Effect | FrictionLaw) -> str:
    """Its class and the text of its module; what is never the same again, where that cannot be had."""
    try:
        return f"{type(part).__qualname__}: {inspect.getsource(sys.modules[type(part).__module__])}"
    except (OSError, TypeError):
        return object.__repr__(part)
