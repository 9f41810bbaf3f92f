"""What sets a robot apart from its model: sensors, commands, joints, and what is believed about them."""

from fo_gym.hardware.draw import HardwareDraw, draw_hardware
from fo_gym.hardware.effects import (
    CommandDelay,
    GearRipple,
    Hardware,
    LinkFriction,
    LoadFriction,
    ModelError,
    MotorEncoder,
    PushTime,
    SensorModel,
    Temperature,
    TorqueSaturation,
    TorqueSensor,
)
from fo_gym.hardware.joint import Imperfections
from fo_gym.hardware.sensing import Sensing

__all__ = [
    "CommandDelay",
    "GearRipple",
    "Hardware",
    "HardwareDraw",
    "Imperfections",
    "LinkFriction",
    "LoadFriction",
    "ModelError",
    "MotorEncoder",
    "PushTime",
    "Sensing",
    "SensorModel",
    "Temperature",
    "TorqueSaturation",
    "TorqueSensor",
    "draw_hardware",
]
