"""The shipped robots, and what else names one."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from os import PathLike
from pathlib import Path

import mujoco
import numpy as np

from envs_assets import asset_path
from fo_gym.checks import shown
from fo_gym.hardware import (
    CommandDelay,
    GearRipple,
    Hardware,
    LinkFriction,
    LoadFriction,
    ModelError,
    MotorEncoder,
    SensorModel,
    Temperature,
    TorqueSaturation,
    TorqueSensor,
)
from fo_gym.parameters import FlexibleJoint, ImpedanceGains, LuGre, PDGains
from fo_gym.robots.link_side import LinkSide
from fo_gym.robots.robot import Robot

RobotLike = Robot | str | PathLike[str]
"""A robot, the name of a shipped one, or a file: *.toml, *.xml (MJCF), *.urdf."""

# B about 1 kg m^2 at joint 2 is the paper's. Stiffness is within what is published for arms of this size
# (3500-8000 N m/rad); its fall towards the wrist, and the torque limits, are ours.
_FLEXIBLE = FlexibleJoint(
    stiffness=np.array([6000.0, 6000.0, 5000.0, 5000.0, 3000.0, 3000.0, 3000.0]),
    damping=0.0,
    motor_inertia=np.array([1.2, 1.2, 1.2, 1.2, 0.6, 0.6, 0.6]),
    torque_limit=np.array([150.0, 150.0, 100.0, 100.0, 50.0, 40.0, 40.0]),
)

# Coulomb friction and stiction of 2-6 N m, viscous friction of about 5 N m s/rad and a Stribeck velocity of
# 0.01 rad/s give the paper's pattern; all values are ours. The bristles yield by 0.1 mrad before they slip.
_F_C = np.array([4.0, 4.0, 4.0, 4.0, 3.0, 3.0, 3.0])
_SIGMA_0 = _F_C / 1e-4
_FRICTION = LuGre(
    sigma_0=_SIGMA_0,
    sigma_1=np.sqrt(_SIGMA_0 * _FLEXIBLE.motor_inertia),
    sigma_2=5.0,
    f_c=_F_C,
    f_s=1.5 * _F_C,
    v_s=0.01,
)

# A 16-bit encoder on the motor behind a gear of 100:1, noise and offset of the torque sensor within 2 % of the range
# of the smallest joint, a tenth of the motor's friction on the link, and 2 ripples per turn of the motor.
_HARDWARE = Hardware(
    sensors=SensorModel(
        MotorEncoder(resolution=1e-6, cutoff=2.0 * np.pi * 150.0),
        TorqueSensor(noise=0.05, offset=0.2, cutoff=2.0 * np.pi * 200.0),
    ),
    delay=CommandDelay(1e-3),
    saturation=TorqueSaturation(),
    link_friction=LinkFriction(coulomb=0.3, viscous=0.3, width=0.01),
    ripple=GearRipple(amplitude=0.2, period=2.0 * np.pi / 200.0),
    load=LoadFriction(0.063),
    temperature=Temperature(),
    model_error=ModelError(),
)


def _miro_like() -> Robot:
    path = asset_path("miro_like")
    return Robot(
        name="miro_like",
        link_side=LinkSide(path, tuple(f"joint{i}" for i in range(1, 8)), "tool", "view"),
        units=("rad",) * 7,
        flexible=_FLEXIBLE,
        friction=_FRICTION,
        home=mujoco.MjModel.from_xml_path(str(path)).key("home").qpos.copy(),
        redundant=("joint3",),
        hardware=_HARDWARE,
        identified=_FRICTION,
        pd_gains=PDGains(
            kp=np.array([50.0, 50.0, 30.0, 30.0, 15.0, 10.0, 10.0]), kd=np.array([2.0, 2.0, 1.2, 1.2, 0.6, 0.4, 0.4])
        ),
        impedance_gains=ImpedanceGains(1000.0, 200.0, 10.0, 2.0, 10.0, 2.0),
    )


def _single_link() -> Robot:
    friction = LuGre(sigma_0=1e5, sigma_1=float(np.sqrt(1e5)), sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=0.001)
    return Robot(
        name="single_link",
        link_side=LinkSide(asset_path("single_link"), ("joint",), None, "view"),
        units=("m",),
        flexible=FlexibleJoint(stiffness=3000.0, damping=0.0, motor_inertia=1.0, torque_limit=10.0),
        friction=friction,
        home=np.zeros(1),
        hardware=Hardware(
            sensors=SensorModel(
                MotorEncoder(resolution=1e-7, cutoff=2.0 * np.pi * 150.0),
                TorqueSensor(noise=0.005, offset=0.02, cutoff=2.0 * np.pi * 200.0),
            ),
            delay=CommandDelay(1e-3),
            saturation=TorqueSaturation(),
            link_friction=LinkFriction(coulomb=0.05, viscous=0.1, width=1e-3),
            ripple=GearRipple(amplitude=0.05, period=2e-3),
            load=LoadFriction(0.063),
            temperature=Temperature(),
            model_error=ModelError(),
        ),
        identified=friction,
        pd_gains=PDGains(kp=50.0, kd=5.0),
    )


_SHIPPED: dict[str, Callable[[], Robot]] = {"miro_like": _miro_like, "single_link": _single_link}

__all__ = ["RobotLike", "robot_of", "shipped_robots"]


def shipped_robots() -> tuple[str, ...]:
    """Names of the robots that come with the package."""
    return tuple(_SHIPPED)


@lru_cache(maxsize=8)
def _shipped(name: str) -> Robot:
    return _SHIPPED[name]()


def robot_of(value: RobotLike) -> Robot:
    """The robot that a value means.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it means no robot; the message names what is allowed.
    """
    if isinstance(value, Robot):
        return value
    if isinstance(value, str) and value in _SHIPPED:
        return _shipped(value)
    if isinstance(value, str | PathLike) and Path(value).suffix in (".xml", ".urdf"):
        return Robot.from_file(value)
    raise ValueError(
        f"robot is {shown(value)}; give a Robot, one of {', '.join(_SHIPPED)}, or a file *.toml, *.xml or *.urdf"
    )
