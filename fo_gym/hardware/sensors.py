"""The sensors of a joint."""

from __future__ import annotations

from dataclasses import dataclass

from fo_gym.checks import instance
from fo_gym.hardware.encoder import MotorEncoder
from fo_gym.hardware.torque_sensor import TorqueSensor

__all__ = ["SensorModel"]


@dataclass(frozen=True)
class SensorModel:
    """What the joint's sensors make of the truth; None is exact.

    Attributes:
        encoder: motor position and velocity.
        torque: joint torque.
    """

    encoder: MotorEncoder | None = None
    torque: TorqueSensor | None = None

    def __post_init__(self) -> None:
        instance("SensorModel.encoder", self.encoder, MotorEncoder, none="none")
        instance("SensorModel.torque", self.torque, TorqueSensor, none="none")
