"""Small arms of our own, of every kind that a link side may be, for the tests of what is designed for them."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from envs_assets import asset_path
from fo_gym.parameters import FRICTIONLESS, FlexibleJoint
from fo_gym.robots import LinkSide, Robot

SIX = ("0 0 1", "0 1 0", "0 1 0", "0 1 0", "0 0 1", "0 1 0")
"""Axes of an elbow arm with an offset wrist."""


def arm(
    path: Path,
    axes: tuple[str, ...] = SIX,
    *,
    scale: float = 1.0,
    slides: tuple[int, ...] = (),
    limited: bool = True,
    wrist: float = 1.0,
) -> LinkSide:
    """A chain of links, its lengths times `scale` and its masses times its cube; `wrist` scales the last two masses.

    Links lie along x and bend about the axes; joints in `slides` slide along them instead, by -+0.2 m times scale.
    """
    text, end = "", ""
    for i, axis in enumerate(axes):
        length = scale * 0.35 * 0.8**i
        mass = 4.0 * 0.6**i * scale**3 * (wrist if i >= len(axes) - 2 else 1.0)
        inertia = mass * length**2 / 12.0
        kind, reach = ("slide", 0.2 * scale) if i in slides else ("hinge", 2.5)
        bounds = f'limited="true" range="{-reach} {reach}"' if limited else ""
        text += (
            f'<body name="link{i}" pos="{0.0 if i == 0 else scale * 0.35 * 0.8 ** (i - 1)} 0 0">'
            f'<joint name="joint{i}" type="{kind}" axis="{axis}" {bounds}/>'
            f'<inertial mass="{mass}" pos="{0.5 * length} 0 {0.1 * length}" '
            f'diaginertia="{0.2 * inertia} {inertia} {inertia}"/>'
        )
        end += "</body>"
    tool = f'<site name="tool" pos="{length} 0 {0.3 * length}"/>'
    path.write_text(
        f'<mujoco><compiler angle="radian" balanceinertia="true"/><worldbody>{text}{tool}{end}</worldbody></mujoco>',
        encoding="utf-8",
    )
    return LinkSide(path, tuple(f"joint{i}" for i in range(len(axes))), tool="tool")


def compiled(robot: LinkSide) -> mujoco.MjModel:
    """The link side of a robot."""
    return mujoco.MjModel.from_xml_path(str(robot.file))


def miro() -> LinkSide:
    """The shipped arm."""
    return LinkSide(asset_path("miro_like"), tuple(f"joint{i}" for i in range(1, 8)), tool="tool")


def standing(links: LinkSide, home: np.ndarray, redundant: tuple[str, ...] = ()) -> Robot:
    """A robot with these links in a pose; its motors play no part."""
    motors = FlexibleJoint(stiffness=1e3, damping=0.0, motor_inertia=1.0, torque_limit=10.0)
    slides = compiled(links).jnt_type == mujoco.mjtJoint.mjJNT_SLIDE
    units = tuple("m" if slide else "rad" for slide in slides)
    return Robot(links.file.stem, links, units, motors, FRICTIONLESS, home, redundant)
