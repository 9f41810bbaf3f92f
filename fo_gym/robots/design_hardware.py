"""Hardware of a robot that nobody has measured: sensors, commands and joints as imperfect as the MIRO-like arm's."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fo_gym.friction import LuGre
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
from fo_gym.parameters import FlexibleJoint

Array = NDArray[np.float64]

ENCODER = 1e-6
"""Step of the motor's encoder, on the link side [rad]: 16 bits behind a gear of 100:1."""

NOISE, OFFSET, DRIFT = 1e-3, 2e-2, 1e-3
"""Of the torque sensor, as shares of the torque limit: an offset of the 2 % of the range that are published,
a drift of 0.05 % per 10 K (HBM) over the 20 K by which a joint warms up."""

NULLED, LOAD_ERROR = 1.0, 5e-3
"""Time at rest over which the torque sensor is nulled [s], and how well the load is known there."""

ENCODER_CUTOFF, TORQUE_CUTOFF = 2.0 * np.pi * 150.0, 2.0 * np.pi * 200.0
"""Of the low-passes of velocity and torque [rad/s]: MIRO-like."""

BUS = 2e-3
"""Delay of commands [s]: two cycles of a bus at 1 kHz, there and back."""

BEARINGS_DRY, BEARINGS_VISCOUS = 0.02, 0.1
"""Friction of the links' bearings as shares of the motor's, MIRO-like."""

RIPPLE, RIPPLES = 0.1, 200.0
"""Amplitude of the gear's ripple as a share of f_c, MIRO-like; ripples per turn of the link, of strain-wave gears."""

LOAD = 0.063
"""Load term of dry friction: eRob80:50 (Rhoban BAM, arXiv:2410.08650)."""

__all__ = ["designed_hardware"]


def designed_hardware(flexible: FlexibleJoint, friction: LuGre, units: Array) -> Hardware:
    """What sets a robot apart from its model in the "hardware" variant.

    Args:
        flexible, friction: of its joints, one value per joint.
        units: natural unit of every joint, (dof,): 1 rad, or 0.1 m of a slide.
    """
    limit, f_c = np.asarray(flexible.torque_limit), np.asarray(friction.f_c)
    return Hardware(
        sensors=SensorModel(
            MotorEncoder(resolution=ENCODER * units, cutoff=ENCODER_CUTOFF),
            TorqueSensor(
                noise=NOISE * limit,
                offset=OFFSET * limit,
                cutoff=TORQUE_CUTOFF,
                nulled=NULLED,
                load_error=LOAD_ERROR,
                drift=DRIFT * limit,
            ),
        ),
        delay=CommandDelay(BUS),
        saturation=TorqueSaturation(),
        link_friction=LinkFriction(
            coulomb=BEARINGS_DRY * f_c, viscous=BEARINGS_VISCOUS * np.asarray(friction.sigma_2), width=friction.v_s
        ),
        ripple=GearRipple(amplitude=RIPPLE * f_c, period=2.0 * np.pi / RIPPLES * units),
        load=LoadFriction(LOAD),
        temperature=Temperature(),
        model_error=ModelError(),
    )
