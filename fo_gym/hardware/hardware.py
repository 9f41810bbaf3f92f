"""All effects of a robot's hardware."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace

from fo_gym.checks import instance, text
from fo_gym.hardware.command_delay import CommandDelay
from fo_gym.hardware.effect import Effect
from fo_gym.hardware.gear_ripple import GearRipple
from fo_gym.hardware.link_friction import LinkFriction
from fo_gym.hardware.load_friction import LoadFriction
from fo_gym.hardware.model_error import ModelError
from fo_gym.hardware.push_time import PushTime
from fo_gym.hardware.saturation import TorqueSaturation
from fo_gym.hardware.sensors import SensorModel
from fo_gym.hardware.temperature import Temperature

_KINDS: dict[str, type[Effect]] = {
    "delay": CommandDelay,
    "saturation": TorqueSaturation,
    "link_friction": LinkFriction,
    "ripple": GearRipple,
    "load": LoadFriction,
    "temperature": Temperature,
    "model_error": ModelError,
    "push_time": PushTime,
}

__all__ = ["Hardware"]


@dataclass(frozen=True)
class Hardware:
    """What sets a robot apart from its model; None switches an effect off.

    There are two tiers of it. The shipped robots and those by design have the calibrated one: their torque sensors were
    nulled at rest before the start, as laboratories do. `raw` is the one below: the same sensors as they are.

    Attributes:
        sensors: encoder and torque sensor.
        delay, saturation: of the motor's command.
        link_friction, ripple, load, temperature: of the joint.
        model_error: of what is believed about it.
        push_time: when it is pushed; None leaves it to the randomization.
        others: effects of one's own, see `fo_gym.hardware.Effect`; they act after the ones above, in this order.

    Raises:
        ValueError: a part is of another class, or two effects have the same name.
    """

    sensors: SensorModel = field(default_factory=SensorModel)
    delay: CommandDelay | None = None
    saturation: TorqueSaturation | None = None
    link_friction: LinkFriction | None = None
    ripple: GearRipple | None = None
    load: LoadFriction | None = None
    temperature: Temperature | None = None
    model_error: ModelError | None = None
    push_time: PushTime | None = None
    others: tuple[Effect, ...] = ()

    def __post_init__(self) -> None:
        instance("Hardware.sensors", self.sensors, SensorModel)
        for name, kind in _KINDS.items():
            instance(f"Hardware.{name}", getattr(self, name), kind, none="none")
        instance("Hardware.others", self.others, tuple)
        for i, effect in enumerate(self.others):
            instance(f"Hardware.others[{i}]", effect, Effect)
            text(f"Hardware.others[{i}].name", effect.name)
        for name, count in Counter(effect.name for effect in self.effects).items():
            if count > 1:
                raise ValueError(f"Hardware has {count} effects named {name!r}; give each of them a `name` of its own")

    @property
    def raw(self) -> Hardware:
        """The same where nobody has nulled the torque sensor: the tier below the calibrated one."""
        torque = self.sensors.torque
        return self if torque is None else replace(self, sensors=replace(self.sensors, torque=torque.raw))

    @property
    def effects(self) -> tuple[Effect, ...]:
        """Those there are, in the order in which they act."""
        parts = (self.sensors.encoder, self.sensors.torque, *(getattr(self, name) for name in _KINDS), *self.others)
        return tuple(part for part in parts if part is not None)

    def check_joints(self, dof: int) -> None:
        """Raise ValueError where an effect has values for another number of joints."""
        for effect in self.effects:
            effect.check_joints(dof)
