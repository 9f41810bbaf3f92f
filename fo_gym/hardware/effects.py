"""What sets a robot apart from its model: one frozen dataclass per effect, each with where its numbers are from.

Values are floats (the same for all joints) or arrays with one value per joint; ranges are drawn per episode, uniformly
and per joint. An effect that is None is switched off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import (
    FINITE,
    NOT_NEGATIVE,
    POSITIVE,
    POSITIVE_OR_INFINITE,
    check_numbers,
    check_ranges,
    check_values,
    instance,
)
from fo_gym.parameters import check_joints

Value = float | NDArray[np.float64]
Range = tuple[float, float]

MAX_DELAY = 1000
"""Control periods of a delay at most: a second at 1 kHz."""

__all__ = [
    "MAX_DELAY",
    "CommandDelay",
    "GearRipple",
    "Hardware",
    "LinkFriction",
    "LoadFriction",
    "ModelError",
    "MotorEncoder",
    "PushTime",
    "SensorModel",
    "Temperature",
    "TorqueSaturation",
    "TorqueSensor",
]


def _check_parts(owner: Any, **kinds: type) -> None:
    """Raise ValueError for a field that is neither of its class nor None."""
    for name, kind in kinds.items():
        instance(f"{type(owner).__name__}.{name}", getattr(owner, name), kind, none="none")


@dataclass(frozen=True, eq=False)
class MotorEncoder:
    """Positions in steps; the velocity is their difference over a control period, low-passed.

    Origin: a 16-bit encoder on the motor behind a gear of 100:1 resolves 1e-6 rad of the link side; the
    cut-off is ours.

    Attributes:
        resolution: one step, on the link side [m | rad], at least 0.
        cutoff: of the first-order low-pass of the velocity [rad/s], above 0; infinity for none.
    """

    resolution: Value
    cutoff: Value = math.inf

    def __post_init__(self) -> None:
        check_values(self, resolution=NOT_NEGATIVE, cutoff=POSITIVE_OR_INFINITE)


@dataclass(frozen=True, eq=False)
class TorqueSensor:
    """Noise, an offset per episode, and a bandwidth.

    Origin: strain gauges of torque-controlled arms are accurate to about 2 % of their range (published for a 7-joint
    arm; uncertain); how that splits into offset and noise is ours, as is the bandwidth.

    Attributes:
        noise: standard deviation, white at the control rate [N | N m], at least 0.
        offset: largest offset, drawn per episode in +-offset [N | N m], at least 0.
        cutoff: of its first-order low-pass [rad/s], above 0; infinity for none.
    """

    noise: Value
    offset: Value
    cutoff: Value = math.inf

    def __post_init__(self) -> None:
        check_values(self, noise=NOT_NEGATIVE, offset=NOT_NEGATIVE, cutoff=POSITIVE_OR_INFINITE)


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
        _check_parts(self, encoder=MotorEncoder, torque=TorqueSensor)


@dataclass(frozen=True)
class CommandDelay:
    """Commands reach the motor late. Origin: ours; one cycle of a 1 kHz bus.

    Attributes:
        seconds: a whole number of control periods, from 0 to MAX_DELAY.
    """

    seconds: float

    def __post_init__(self) -> None:
        check_numbers(self, seconds=NOT_NEGATIVE)

    def ticks(self, control_dt: float) -> int:
        """The delay in control periods. Raises ValueError where it is no whole number of them, or above MAX_DELAY."""
        ticks = round(self.seconds / control_dt)
        if ticks > MAX_DELAY or abs(ticks * control_dt - self.seconds) > 1e-9:
            raise ValueError(
                f"CommandDelay.seconds is {self.seconds}; it must be a whole number of control_dt = {control_dt} s, "
                f"at most {MAX_DELAY} of them"
            )
        return ticks


@dataclass(frozen=True)
class TorqueSaturation:
    """The motor's torque stays within a share of the joint's torque limit. Origin: any drive.

    Attributes:
        share: of FlexibleJoint.torque_limit, above 0.
    """

    share: float = 1.0

    def __post_init__(self) -> None:
        check_numbers(self, share=POSITIVE)


@dataclass(frozen=True, eq=False)
class LinkFriction:
    """Friction of the link's bearings, -(coulomb tanh(q'/width) + viscous q'), which no motor-side observer can see.

    Origin: ours; a tenth of the motor side's, since nearly all friction sits there.

    Attributes:
        coulomb: [N | N m], at least 0.
        viscous: [N s/m | N m s/rad], at least 0.
        width: velocity at which it has nearly reached `coulomb` [m/s | rad/s], above 0.
    """

    coulomb: Value
    viscous: Value
    width: Value

    def __post_init__(self) -> None:
        check_values(self, coulomb=NOT_NEGATIVE, viscous=NOT_NEGATIVE, width=POSITIVE)


@dataclass(frozen=True, eq=False)
class GearRipple:
    """A torque on the motor that goes round with it, amplitude sin(2 pi theta / period + phase), phase per episode.

    Origin: strain-wave gears ripple twice per turn of the wave generator, here 200 times per turn of the link; the
    amplitude is ours.

    Attributes:
        amplitude: [N | N m], at least 0.
        period: [m | rad], above 0.
    """

    amplitude: Value
    period: Value

    def __post_init__(self) -> None:
        check_values(self, amplitude=NOT_NEGATIVE, period=POSITIVE)


@dataclass(frozen=True)
class LoadFriction:
    """Dry friction grows with what the gear carries: f_c and f_s plus gain |tau_j|.

    Origin: load terms of 0.063 and 0.166 identified on two servo joints (Rhoban BAM, arXiv:2410.08650).

    Attributes:
        gain: [1], at least 0.
    """

    gain: float

    def __post_init__(self) -> None:
        check_numbers(self, gain=NOT_NEGATIVE)


@dataclass(frozen=True)
class Temperature:
    """Friction falls as the joint warms up: f_c, f_s by exp(-dry T), sigma_2 by exp(-viscous T).

    T(t) = T_0 + rise (1 - exp(-t / time)) above the temperature at which friction was identified; T_0 per episode.

    Origin: ours; that lubricants thin out as they warm is common knowledge, and viscous friction falls most.

    Attributes:
        start: range of T_0 [K].
        rise: [K], at least 0.
        time: of warming up [s], above 0.
        dry, viscous: [1/K], at least 0.
    """

    start: Range = (0.0, 20.0)
    rise: float = 5.0
    time: float = 10.0
    dry: float = 0.005
    viscous: float = 0.02

    def __post_init__(self) -> None:
        check_numbers(self, rise=NOT_NEGATIVE, time=POSITIVE, dry=NOT_NEGATIVE, viscous=NOT_NEGATIVE)
        check_ranges(self, start=FINITE)


@dataclass(frozen=True)
class ModelError:
    """What controller, nominal motor and `JointInfo` believe, as factors on the truth, drawn per episode.

    Origin: ours; data sheets and identification are rarely better than some per cent, and a payload is rarely known.

    Attributes:
        motor_inertia, stiffness: ranges of the factors on B and K_j, per joint.
        mass: range of the factor on the masses, one for all links: below 1 is a payload that nobody told of.
    """

    motor_inertia: Range = (0.9, 1.1)
    stiffness: Range = (0.9, 1.1)
    mass: Range = (0.9, 1.0)

    def __post_init__(self) -> None:
        check_ranges(self, motor_inertia=POSITIVE, stiffness=POSITIVE, mass=POSITIVE)


@dataclass(frozen=True)
class PushTime:
    """The push comes at any time of a wide range. Origin: ours.

    Attributes:
        start: range of its start [s].
    """

    start: Range

    def __post_init__(self) -> None:
        check_ranges(self, start=NOT_NEGATIVE)


@dataclass(frozen=True)
class Hardware:
    """All effects of an environment; None switches one off.

    Attributes:
        sensors: encoder and torque sensor.
        delay, saturation: of the motor's command.
        link_friction, ripple, load, temperature: of the joint.
        model_error: of what is believed about it.
        push_time: when it is pushed; None leaves it to the randomization.
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

    def __post_init__(self) -> None:
        instance("Hardware.sensors", self.sensors, SensorModel)
        _check_parts(self, delay=CommandDelay, saturation=TorqueSaturation, link_friction=LinkFriction)
        _check_parts(self, ripple=GearRipple, load=LoadFriction, temperature=Temperature)
        _check_parts(self, model_error=ModelError, push_time=PushTime)

    def check_joints(self, dof: int) -> None:
        """Raise ValueError where an effect has values for another number of joints."""
        for part in (self.sensors.encoder, self.sensors.torque, self.link_friction, self.ripple):
            if part is not None:
                check_joints(part, dof)
