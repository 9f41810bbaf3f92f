"""Parameters out of range are refused by name."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from pendulum import FRICTION, JOINTS, MakeRobot

from fo_gym.friction import LuGre
from fo_gym.parameters import FlexibleJoint, ImpedanceGains, PDGains, per_joint
from fo_gym.plant import FlexibleJointPlant

GOOD = {
    LuGre: {"sigma_0": 1e5, "sigma_1": 300.0, "sigma_2": 0.4, "f_c": 1.0, "f_s": 1.5, "v_s": 1e-3},
    FlexibleJoint: {"stiffness": 3e3, "damping": 0.0, "motor_inertia": 1.0, "torque_limit": 10.0},
    PDGains: {"kp": 50.0, "kd": 5.0},
    ImpedanceGains: {field.name: 10.0 for field in fields(ImpedanceGains)},
}
MAY_BE_ZERO = {"sigma_0", "sigma_1", "sigma_2", "damping", "kd", "kd_position", "kd_orientation", "kd_elbow"}
FIELDS = [(kind, name) for kind, values in GOOD.items() for name in values]


@pytest.mark.parametrize(("kind", "name"), FIELDS)
@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_bad_parameters_are_refused_by_name(kind: type, name: str, bad: float) -> None:
    kind(**GOOD[kind])
    with pytest.raises(ValueError, match=rf"{kind.__name__}\.{name}\b"):
        kind(**{**GOOD[kind], name: bad})


@pytest.mark.parametrize(
    ("kind", "name"), [pair for pair in FIELDS if pair[0] is not ImpedanceGains or "elbow" in pair[1]]
)
def test_one_bad_joint_is_enough(kind: type, name: str) -> None:
    values = np.full(3, GOOD[kind][name])
    kind(**{**GOOD[kind], name: values.copy()})
    values[1] = -1.0
    with pytest.raises(ValueError, match=rf"{kind.__name__}\.{name}\b"):
        kind(**{**GOOD[kind], name: values})


@pytest.mark.parametrize(("kind", "name"), FIELDS)
def test_zero_is_accepted_where_it_means_something(kind: type, name: str) -> None:
    zero = {**GOOD[kind], name: 0.0}
    if name in MAY_BE_ZERO:
        kind(**zero)
    else:
        with pytest.raises(ValueError, match=rf"{kind.__name__}\.{name}\b"):
            kind(**zero)


def test_stiction_below_coulomb_friction_is_refused() -> None:
    with pytest.raises(ValueError, match=r"LuGre\.f_s is 0\.9.*f_c = 1"):
        LuGre(**{**GOOD[LuGre], "f_s": 0.9})


@pytest.mark.parametrize("name", ["stiffness", "motor_inertia"])
def test_values_for_another_number_of_joints_are_refused(pendulum: MakeRobot, name: str) -> None:
    joints = replace(JOINTS, **{name: np.full(3, 1e3)})
    with pytest.raises(ValueError, match=rf"FlexibleJoint\.{name} .*\(3,\).*2"):
        FlexibleJointPlant(pendulum(), 1, joints=joints, friction=FRICTION)


def test_scalars_stand_for_all_joints() -> None:
    spread = per_joint(replace(JOINTS, stiffness=np.array([1e3, 2e3])), 2)
    np.testing.assert_array_equal(spread.stiffness, [1e3, 2e3])
    np.testing.assert_array_equal(spread.motor_inertia, [1.0, 1.0])
