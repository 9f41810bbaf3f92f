"""`fo-gym robot`: what becomes of a robot's file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fo_gym.console import Stop, console, say, tell_written, text_table

if TYPE_CHECKING:
    from fo_gym.robots import Robot

File = Annotated[
    str, typer.Argument(metavar="FILE", help="MJCF (.xml), URDF (.urdf) or robot.toml; or the name of a shipped robot.")
]
Joints = Annotated[
    str | None, typer.Option(metavar="NAME,...", help="The flexible joints; by default all that move by themselves.")
]
Tool = Annotated[str | None, typer.Option(help="Site, body or link of the tool; by default the end of the chain.")]
Home = Annotated[
    str | None, typer.Option(help="A keyframe of the file, or positions with commas between; by default found.")
]

robot_commands = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    help="Any MJCF or URDF arm as a robot with flexible joints and friction: look at it, or write its robot.toml.",
    epilog="Example: fo-gym robot inspect arm.urdf",
)

__all__ = ["robot_commands"]


@robot_commands.command("inspect")
def run_inspect(
    file: File,
    joints: Joints = None,
    tool: Tool = None,
    home: Home = None,
    picture: Annotated[Path | None, typer.Option(dir_okay=False, help="Draw it at home, to this PNG file.")] = None,
) -> None:
    """Show a robot: its joints, what was taken, dropped and assumed, and what follows for control.

    Examples:
        fo-gym robot inspect arm.urdf --picture arm.png

        fo-gym robot inspect arm.xml --joints shoulder,elbow,wrist --tool gripper
    """
    from fo_gym.control.design import designed_pd

    robot = _robot(file, joints, tool, home)
    title = f"{robot.name}: tool {robot.tool or 'none'}, redundant {', '.join(robot.redundant) or 'none'}"
    console.print(text_table(title, [*_HEADINGS, *_levels(robot).values()], _rows(robot)))
    say(str(robot.report))
    say(str(robot.advice(robot.pd_gains or designed_pd(robot))))
    if picture is not None:
        tell_written([_draw(robot, picture)])


@robot_commands.command("new")
def run_new(
    file: File,
    out: Annotated[Path, typer.Option(dir_okay=False, help="The file that is written.")] = Path("robot.toml"),
    joints: Joints = None,
    tool: Tool = None,
    home: Home = None,
) -> None:
    """Write a robot.toml: everything that is known or assumed of a robot, with units and sources, to be edited.

    Examples:
        fo-gym robot new arm.urdf --out arm.toml

        fo-gym evaluate pid-high --env FJRRegulation-v0 --robot arm.toml
    """
    if out.exists():
        raise Stop(f"--out {out} is there already; name another file, or remove it")
    with _telling():
        out.parent.mkdir(parents=True, exist_ok=True)
        _robot(file, joints, tool, home).to_toml(out)
    tell_written([out])


def _robot(file: str, joints: str | None, tool: str | None, home: str | None) -> Robot:
    """The robot of the options. Stops where there is none."""
    from fo_gym.robots import Robot, robot_of

    with _telling():
        if joints is None and tool is None and home is None:
            return robot_of(file)
        names = None if joints is None else tuple(name.strip() for name in joints.split(","))
        return Robot.from_file(file, joints=names, tool=tool, home=None if home is None else _pose(home))


def _pose(home: str) -> Any:
    """Positions, or the name of a keyframe."""
    import numpy as np

    try:
        return np.array([float(part) for part in home.split(",")])
    except ValueError:
        return home


@contextmanager
def _telling() -> Iterator[None]:
    """Stop at what a robot's file is not."""
    try:
        yield
    except (ValueError, OSError) as error:
        raise Stop(str(error)) from error


_HEADINGS = ["joint", "unit", "home", "range", "B", "K_j", "D_j", "limit"]


def _levels(robot: Robot) -> dict[str, str]:
    """The levels of its friction that are shown, and what its law calls them."""
    levels = {name: getattr(robot.friction.levels, name) for name in ("coulomb", "stiction", "viscous", "stribeck")}
    return {name: called for name, called in levels.items() if called}


def _rows(robot: Robot) -> list[list[str]]:
    """A row per joint, in N, m, kg, s, rad."""
    import numpy as np

    from fo_gym.robots.poses import joint_range

    low, high = joint_range(robot.link_side.model)
    flexible, friction = robot.flexible, robot.friction
    numbers = (
        *(flexible.motor_inertia, flexible.stiffness, flexible.damping, flexible.torque_limit),
        *(friction.level(level) for level in _levels(robot)),
    )
    return [
        [
            *(name, robot.units[j], f"{robot.home[j]:.3g}", f"{low[j]:.3g} ... {high[j]:.3g}"),
            *(f"{np.asarray(values)[j]:.3g}" for values in numbers),
        ]
        for j, name in enumerate(robot.joints)
    ]


def _draw(robot: Robot, path: Path) -> Path:
    """The robot at home, as a PNG file."""
    from matplotlib.image import imsave

    from fo_gym.envs.rendering import picture_of
    from fo_gym.files import draft_of

    try:
        image = picture_of(robot)
    except RuntimeError as error:
        raise Stop(str(error)) from error
    with draft_of(path) as draft:
        imsave(draft, image, metadata={"Software": ""}, format="png")
    return path
