"""The link side of a robot: which joints of an MJCF or URDF file are driven, and what MuJoCo makes of the rest."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np

from fo_gym.checks import shown
from fo_gym.robots.editing import HINGE, compile_whole, link_side_of
from fo_gym.robots.file import existing_file, mujoco_errors, read_spec
from fo_gym.robots.report import Notes
from fo_gym.robots.survey import survey
from fo_gym.robots.welding import SLIDE

__all__ = ["LinkSide"]


@dataclass(frozen=True)
class LinkSide:
    """The link side of a robot.

    Attributes:
        file: MJCF or URDF file. It knows nothing of motors and friction.
        joints: names of the flexible joints, in the file's order; all others are welded.
        tool: name of the site or body (URDF: link) that a task-space controller moves, or None.
        camera: name of the camera to render from, or None for MuJoCo's free camera.
        frozen: (name, position [m | rad]) of joints that are welded elsewhere than at the file's own reference.
    """

    file: Path
    joints: tuple[str, ...]
    tool: str | None = None
    camera: str | None = None
    frozen: tuple[tuple[str, float], ...] = ()

    @property
    def dof(self) -> int:
        """Number of joints."""
        return len(self.joints)

    @property
    def stamp(self) -> tuple[int, int]:
        """What changes with the file's content, for who keeps something of a link side.

        Raises:
            FileNotFoundError: there is no such file.
        """
        state = existing_file("robot file", self.file).stat()
        return state.st_mtime_ns, state.st_size

    @property
    def model(self) -> mujoco.MjModel:
        """The links alone, compiled: `joints` in their order, the tool as a site, no geoms, nothing that constrains.

        Armature and dry friction of the file are not in it; its springs and dampers are. A copy, to be changed freely.

        Raises:
            FileNotFoundError: there is no such file.
            ValueError: the file cannot be read, or has not these joints or this tool.
        """
        return copy.copy(_compiled(self, self.stamp, False)[1])

    @property
    def scene(self) -> mujoco.MjModel:
        """As `model`, with what there is to see: geoms, meshes where they are found, cameras and lights. A copy."""
        return copy.copy(_compiled(self, self.stamp, True)[1])

    @property
    def scene_spec(self) -> mujoco.MjSpec:
        """What `scene` was compiled from, to be built upon. A copy."""
        return _compiled(self, self.stamp, True)[0].copy()


@lru_cache(maxsize=16)
def _compiled(side: LinkSide, _stamp: tuple[int, int], pictures: bool) -> tuple[mujoco.MjSpec, mujoco.MjModel]:
    notes = Notes()
    file = Path(side.file)
    spec = read_spec(file, notes)
    whole = compile_whole(spec, file, notes, pictures=pictures)
    _check_joints(side, whole)
    if side.tool is not None:
        _add_tool(side.tool, spec, file)
    with mujoco_errors(file, "compile its link side"):
        damping = dict(zip(side.joints, survey(whole).of(side.joints).damping.tolist(), strict=True))
        model = link_side_of(spec, whole, side.joints, dict(side.frozen), damping, pictures=pictures)
    return spec, model


def _check_joints(side: LinkSide, whole: mujoco.MjModel) -> None:
    names = [whole.joint(i).name for i in range(whole.njnt) if whole.jnt_type[i] in (HINGE, SLIDE)]
    if not side.joints or [name for name in names if name in side.joints] != list(side.joints):
        raise ValueError(f"{side.file}: joints are {shown(side.joints)}; name some of {tuple(names)}, in this order")
    unknown = [name for name, _ in side.frozen if name not in names or name in side.joints]
    if unknown:
        raise ValueError(f"{side.file}: frozen joints {unknown} are not there, or are driven; there are {tuple(names)}")


def _add_tool(tool: str, spec: mujoco.MjSpec, file: Path) -> None:
    """A site of the tool's name where there is none: at the frame of the body of that name."""
    if spec.site(tool) is not None:
        return
    body = spec.body(tool)
    if body is None:
        sites = [site.name for site in spec.sites if site.name]
        bodies = [other.name for other in spec.bodies]
        raise ValueError(f"{file}: the tool {tool!r} is not there; sites are {sites}, bodies are {bodies}")
    body.add_site(
        name=tool, material="", pos=np.zeros(3), quat=[1.0, 0.0, 0.0, 0.0], size=[1e-3, 1e-3, 1e-3], rgba=[0.0] * 4
    )
