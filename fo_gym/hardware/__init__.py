"""What sets a robot apart from its model: sensors, commands, joints, and what is believed about them.

Each effect is a frozen dataclass, in a file of its own: what it is and where its numbers are from, what it draws for an
episode, and what it does there. Values are floats (the same for all joints) or arrays with one value per joint; ranges
are drawn per episode, uniformly and per joint. For an effect of one's own see `Effect`, and `Hardware.others`.
"""

from fo_gym.hardware.command_delay import CommandDelay
from fo_gym.hardware.draw import HardwareDraw, draw_hardware
from fo_gym.hardware.effect import Effect, Episodes, FrictionChange, Readings, Truth
from fo_gym.hardware.encoder import MotorEncoder
from fo_gym.hardware.gear_ripple import GearRipple
from fo_gym.hardware.hardware import Hardware
from fo_gym.hardware.link_friction import LinkFriction
from fo_gym.hardware.load_friction import LoadFriction
from fo_gym.hardware.model_error import ModelError
from fo_gym.hardware.push_time import PushTime
from fo_gym.hardware.saturation import TorqueSaturation
from fo_gym.hardware.sensors import SensorModel
from fo_gym.hardware.temperature import Temperature
from fo_gym.hardware.torque_sensor import TorqueSensor

__all__ = [
    "CommandDelay",
    "Effect",
    "Episodes",
    "FrictionChange",
    "GearRipple",
    "Hardware",
    "HardwareDraw",
    "LinkFriction",
    "LoadFriction",
    "ModelError",
    "MotorEncoder",
    "PushTime",
    "Readings",
    "SensorModel",
    "Temperature",
    "TorqueSaturation",
    "TorqueSensor",
    "Truth",
    "draw_hardware",
]
