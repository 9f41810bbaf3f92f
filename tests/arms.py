"""Small arms of our own, of every kind that a link side may be, for the tests of what is designed for them."""

from __future__ import annotations

from pathlib import Path

from fo_gym.robots import Robot, robot_of

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
) -> Robot:
    """A chain of links, its motors designed by `Robot.from_file`.

    Lengths are times `scale` and masses times its cube; `wrist` scales the last two masses. Links lie along x and bend
    about the axes; joints in `slides` slide along them instead, by -+0.2 m times scale.
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
    return Robot.from_file(path, tool="tool")


def miro() -> Robot:
    """The shipped arm."""
    return robot_of("miro_like")
