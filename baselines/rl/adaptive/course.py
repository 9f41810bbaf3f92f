"""What the adaptive compensator is trained on: the single link and random chains, as imperfect as robots are, and more.

Ranges are wider than those of the scored variants. The scored arm is not among the robots.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import VectorEnv

from fo_gym import (
    Dahl,
    ElastoPlastic,
    Hardware,
    JointPath,
    LuGre,
    MaxwellSlip,
    Push,
    Randomization,
    Robot,
    Step,
    Task,
    ToolPath,
)
from fo_gym.friction import FrictionLaw
from fo_gym.hardware import CommandDelay, LoadFriction, ModelError, PushTime

RANGES: dict[str, tuple[float, float]] = {
    "friction": (0.4, 2.5),
    "stiction": (0.3, 2.0),
    "stribeck": (0.3, 5.0),
    "bristle": (0.2, 2.0),
    "viscous": (0.2, 8.0),
    "motor_inertia": (0.6, 1.5),
    "stiffness": (0.6, 1.6),
    "mass": (0.5, 1.5),
    "step": (0.3, 2.5),
    "push_time": (4.0, 8.0),
    "push": (0.3, 2.0),
}
"""Of an episode's draws, see `fo_gym.Randomization`."""
EFFECTS: dict[str, tuple[float, float]] = {
    "torque noise": (0.2, 2.0),
    "zero": (0.5, 2.0),
    "ripple": (0.0, 1.6),
    "ripple period": (0.5, 2.0),
    "link friction": (0.3, 2.0),
}
"""Factors on the effects of the robot's hardware, one of each for the robots of a batch."""
DELAYS, LOAD = (0, 1, 2, 3), (0.0, 0.15)
"""Of commands [ms]; gain of the friction that the load adds."""
BELIEFS = ModelError(motor_inertia=(0.87, 1.15), stiffness=(0.85, 1.15), mass=(0.85, 1.05))

_LEVEL = 0.25
"""Share of the chains without gravity, as if every axis were vertical."""

__all__ = ["Shares", "described", "random_chain", "training_batch"]


@dataclass(frozen=True)
class Shares:
    """Shares of batches, from 0 to 1.

    Attributes:
        links: of the single link; the others are of random chains.
        exact: with exact signals.
        laws: with another friction law than LuGre.
    """

    links: float = 0.35
    exact: float = 0.4
    laws: float = 0.375

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not 0.0 <= value <= 1.0:
                raise ValueError(f"Shares.{name} is {value}; it must be from 0 to 1")


def described() -> dict[str, Any]:
    """The ranges, for a model card."""
    return {"draws": RANGES, "effects": EFFECTS, "delays_ms": DELAYS, "load": LOAD, "beliefs": vars(BELIEFS)}


def random_chain(generator: np.random.Generator, folder: Path) -> Robot:
    """A chain of 2 to 5 hinges, by design a robot; its file is written into `folder`. One in four weighs nothing."""
    dof, mass, drop = int(generator.integers(2, 6)), 2.5 * generator.uniform(0.4, 1.6), 0.0
    opened = ""
    for i in range(dof):
        length = generator.uniform(0.15, 0.4)
        axis = "0 1 0" if i == 0 else generator.choice(["0 1 0", "0 1 0", "0 0 1", "1 0 0"])
        opened += (
            f'<body pos="0 0 {-drop:.3f}"><joint name="joint{i + 1}" axis="{axis}" range="-170 170"/>'
            f'<geom type="capsule" fromto="0 0 0 0 0 {-length:.3f}" size="0.04" mass="{mass:.3f}"/>'
        )
        drop, mass = length, mass * generator.uniform(0.4, 0.9)
    home = " ".join(f"{angle:.2f}" for angle in generator.uniform(0.3, 1.2, dof) * generator.choice([-1, 1], dof))
    gravity = '<option gravity="0 0 0"/>' if generator.random() < _LEVEL else ""
    tip = f'<site name="tip" pos="0 0 {-drop:.3f}"/>'
    file = folder / "chain.xml"
    file.write_text(
        f"<mujoco>{gravity}<worldbody>{opened}{tip}{'</body>' * dof}</worldbody>"
        f'<keyframe><key name="home" qpos="{home}"/></keyframe></mujoco>',
        encoding="utf-8",
    )
    return Robot.from_file(file, tool="tip")


def training_batch(
    generator: np.random.Generator, folder: Path, num_envs: int, shares: Shares
) -> VectorEnv[Any, Any, Any]:
    """Episodes of one robot and task, drawn from `generator`, with measured feedback."""
    link = generator.random() < shares.links
    robot = None if link else random_chain(generator, folder)
    own = _link() if robot is None else robot
    exact = generator.random() < shares.exact
    settings: dict[str, Any] = {"variant": "randomized" if exact else "hardware"}
    if not exact and own.hardware is not None:
        settings["hardware"] = _hardware(own.hardware, generator)
    settings["task"], settings["friction"] = _task(own, generator, link), _law(own.friction, generator, shares)
    return gym.make_vec("FJRRegulation-v0", num_envs, robot=own, feedback="measured", physics_dt="auto", **settings)


def _link() -> Robot:
    env: Any = gym.make("FJRStiction-v0", variant="hardware")
    robot: Robot = env.unwrapped.simulation.robot
    env.close()
    return robot


def _law(friction: FrictionLaw, generator: np.random.Generator, shares: Shares) -> FrictionLaw:
    """LuGre, or another law as like it as can be."""
    if generator.random() >= shares.laws or not isinstance(friction, LuGre):
        return friction
    laws = (ElastoPlastic, MaxwellSlip, Dahl)
    return laws[generator.integers(len(laws))].like(friction)


def _task(robot: Robot, generator: np.random.Generator, link: bool) -> Task:
    """A step, a path of the joints, or a path of the tool."""
    limit = np.asarray(robot.flexible.torque_limit)
    push = Push(time=0.0, duration=0.5, torque=(0.15 if link else 0.05) * limit)
    draws = Randomization(**RANGES, start=0.002 if link else 0.02)
    size = 0.01 if link else -np.deg2rad(5.0)
    references = (Step(size=size, time=float(generator.choice([0.0, 0.5, 2.0]))), JointPath(duration=7.0))
    kind = int(generator.choice(3, p=[0.45, 0.25, 0.3] if robot.dof > 2 else [0.6, 0.4, 0.0]))  # tools need 3 joints
    reference = references[kind] if kind < len(references) else _tool_path(robot) or references[1]
    return Task(
        reference,
        duration=12.0 if kind == 0 else 9.0,
        random_push=push,
        push_time=PushTime(RANGES["push_time"]),
        randomization=draws,
    )


def _tool_path(robot: Robot) -> ToolPath | None:
    """A square of the tool; None where this chain cannot draw one."""
    try:
        return ToolPath(duration=5.0).fitted_to(robot)
    except ValueError:
        return None


def _hardware(own: Hardware, generator: np.random.Generator) -> Hardware:
    """The robot's own hardware, each effect stronger or weaker."""
    factor = {name: generator.uniform(low, high) for name, (low, high) in EFFECTS.items()}
    torque, ripple, bearings = own.sensors.torque, own.ripple, own.link_friction
    assert torque is not None
    assert ripple is not None
    assert bearings is not None
    torque = replace(
        torque,
        noise=factor["torque noise"] * torque.noise,
        drift=factor["zero"] * torque.drift,
        load_error=factor["zero"] * torque.load_error,
    )
    return replace(
        own,
        sensors=replace(own.sensors, torque=torque),
        ripple=replace(
            ripple, amplitude=factor["ripple"] * ripple.amplitude, period=factor["ripple period"] * ripple.period
        ),
        link_friction=replace(
            bearings,
            coulomb=factor["link friction"] * bearings.coulomb,
            viscous=factor["link friction"] * bearings.viscous,
        ),
        delay=CommandDelay(1e-3 * int(generator.choice(DELAYS))),
        load=LoadFriction(generator.uniform(*LOAD)),
        model_error=BELIEFS,
    )
