"""Parameters of joints, controllers, draws and hardware: everything that is no such value is refused by name."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hostile import NO_ARRAYS, NO_NUMBERS, Attack, check_refused

import fo_gym
from fo_gym import hardware
from fo_gym.parameters import per_joint
from fo_gym.tasks.scenario import Push

LUGRE = fo_gym.LuGre(sigma_0=1e5, sigma_1=300.0, sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=1e-3)
PER_JOINT = (
    LUGRE,
    fo_gym.FlexibleJoint(stiffness=3e3, damping=0.0, motor_inertia=1.0, torque_limit=10.0),
    fo_gym.PDGains(kp=50.0, kd=5.0),
    hardware.MotorEncoder(resolution=1e-6),
    hardware.TorqueSensor(noise=0.1, offset=0.1),
    hardware.LinkFriction(coulomb=0.1, viscous=0.1, width=0.01),
    hardware.GearRipple(amplitude=0.1, period=0.1),
)
IMPEDANCE = fo_gym.ImpedanceGains(100.0, 10.0, 10.0, 1.0, 10.0, 1.0)
OF_THE_TOOL = tuple(field.name for field in fields(IMPEDANCE) if "elbow" not in field.name)
OF_THE_ELBOW = ("kp_elbow", "kd_elbow")
SINGLE = (
    hardware.CommandDelay(1e-3),
    hardware.TorqueSaturation(),
    hardware.LoadFriction(0.1),
)
RANGES = (fo_gym.Randomization(), hardware.ModelError(), hardware.PushTime((0.0, 1.0)))
NO_RANGES = (None, 1.0, "ab", (1.0,), (1.0, 2.0, 3.0), (2.0, 1.0), (math.nan, 1.0), (0.5, math.inf), (1j, 2j), {1, 2})
NO_PARTS = (1.0, "exact", LUGRE, [], hardware.MotorEncoder)


def attacks(owner: object, values: tuple[object, ...], skipped: tuple[str, ...] = ()) -> list[Attack]:
    """Every field of a dataclass with every value."""
    return [
        (f"{type(owner).__name__}.{field.name}", value, lambda value, name=field.name: replace(owner, **{name: value}))  # type: ignore[misc, type-var]
        for field in fields(owner)  # type: ignore[arg-type]
        if field.name not in skipped
        for value in values
    ]


def test_values_per_joint() -> None:
    bad = (*NO_ARRAYS, math.nan, -math.inf, -1.0, 10**5000, [], np.ones((2, 2)), [1.0, math.nan])
    check_refused(attack for owner in PER_JOINT for attack in attacks(owner, bad))
    check_refused(attacks(IMPEDANCE, bad, OF_THE_TOOL))


def test_single_numbers() -> None:
    bad = (*NO_NUMBERS, None, math.nan, math.inf, -1.0, 10**5000, [1.0], np.ones(1), np.array(1.0))
    check_refused(attack for owner in SINGLE for attack in attacks(owner, bad))
    check_refused(attacks(IMPEDANCE, bad, OF_THE_ELBOW))
    rest = ("start",)
    check_refused(attacks(hardware.Temperature(), bad, rest))
    check_refused(("Randomization.start", each, lambda each: fo_gym.Randomization(start=each)) for each in bad[:-3])


def test_ranges() -> None:
    check_refused(attack for owner in RANGES for attack in attacks(owner, NO_RANGES, ("start",)))
    starts = (hardware.Temperature, hardware.PushTime)
    cases = [
        (f"{kind.__name__}.start", each, lambda each, kind=kind: kind(start=each))
        for kind in starts
        for each in NO_RANGES
    ]
    check_refused(cases)


def test_parts_of_the_hardware() -> None:
    for owner in (fo_gym.Hardware(), fo_gym.SensorModel()):
        check_refused(attacks(owner, NO_PARTS[:-1]))
    check_refused([("Hardware.sensors", None, lambda value: fo_gym.Hardware(sensors=value))])


def test_pushes() -> None:
    bad = (*NO_NUMBERS, None, math.nan, math.inf, -1.0)
    cases: list[Attack] = [("push time", each, lambda each: Push(each, 1.0, np.ones(1))) for each in bad]
    cases += [("push duration", each, lambda each: Push(0.0, each, np.ones(1))) for each in (*bad, 0.0)]
    cases += [("push torque", each, lambda each: Push(0.0, 1.0, each)) for each in (*NO_ARRAYS, [math.nan])]
    check_refused(cases)


def test_fields_for_different_numbers_of_joints_are_named_together() -> None:
    with pytest.raises(ValueError, match="LuGre: f_c has 2 values, f_s has 3 values; give one value for all joints"):
        fo_gym.LuGre(1.0, 1.0, 1.0, np.ones(2), np.ones(3), 1.0)


def test_lists_become_arrays_and_copies_are_kept() -> None:
    given = np.array([1.0, 2.0])
    law = replace(LUGRE, f_c=given, f_s=[3, 4])
    given[:] = 9.0
    np.testing.assert_array_equal(law.f_c, [1.0, 2.0])
    np.testing.assert_array_equal(law.steady(1.0), [-1.4, -2.4])
    assert (per_joint(law, 2).v_s == 1e-3).all()
