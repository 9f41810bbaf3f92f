"""The friction laws: their equations as the literature has them, their steps for any stiffness, what they refuse."""

from __future__ import annotations

import math
import pickle
from typing import Any

import numpy as np
import pytest

from fo_gym import Dahl, ElastoPlastic, LuGre, MaxwellSlip
from fo_gym.certificate.experiments import PAPER, Joint
from fo_gym.certificate.law_oracle import LawLink
from fo_gym.certificate.oracle import lugre as oracle_lugre
from fo_gym.friction import FrictionLaw
from fo_gym.friction.maxwell_slip import presliding_elements
from fo_gym.parameters import FlexibleJoint, per_joint
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import robot_of

LUGRE = LuGre(**PAPER)
LAWS: dict[str, FrictionLaw] = {
    "lugre": LUGRE,
    "dahl": Dahl.like(LUGRE),
    "elasto-plastic": ElastoPlastic.like(LUGRE),
    "maxwell-slip": MaxwellSlip.like(LUGRE),
}


def stribeck(v: float) -> float:
    return 1.0 + 0.5 * math.exp(-((v / 1e-3) ** 2))


def dahl(v: float, z: float) -> float:
    return v * (1.0 - 1e5 * z / 1.0 * math.copysign(1.0, v))


def elasto_plastic(v: float, z: float) -> float:
    z_ss, z_ba = stribeck(v) / 1e5, 0.7 / 1e5
    if z * v < 0.0 or abs(z) <= z_ba:
        alpha = 0.0
    elif abs(z) >= z_ss:
        alpha = 1.0
    else:
        alpha = 0.5 * (1.0 + math.sin(math.pi * (abs(z) - (z_ss + z_ba) / 2.0) / (z_ss - z_ba)))
    return v * (1.0 - alpha * 1e5 / stribeck(v) * math.copysign(1.0, v) * z)


@pytest.mark.parametrize(("name", "written"), [("dahl", dahl), ("elasto-plastic", elasto_plastic)])
def test_equations_are_those_of_the_literature(name: str, written: Any) -> None:
    """Written here from the papers, apart from the package; forces as LuGre has them."""
    generator = np.random.default_rng(0)
    for v, z in generator.normal(size=(200, 2)) * [2e-3, 1e-5]:
        rate, tau_f = LAWS[name].equations(v, np.array([z]))
        assert rate[0] == pytest.approx(written(v, z), rel=1e-12, abs=1e-18)
        assert tau_f == pytest.approx(-(1e5 * z + 1e5**0.5 * written(v, z) + 0.4 * v), rel=1e-12, abs=1e-12)


def test_lugres_equations_are_those_of_the_oracle() -> None:
    for v, z in np.random.default_rng(1).normal(size=(200, 2)) * [2e-3, 1e-5]:
        rate, tau_f = LUGRE.equations(v, np.array([z]))
        assert (rate[0], tau_f) == pytest.approx(oracle_lugre(v, z, LUGRE), rel=1e-12)


def test_springs_of_maxwell_slip_stick_slip_and_stick_again() -> None:
    """F_i' = k_i v while it sticks, sgn(v) C (alpha_i - F_i / s) while it slips, until v changes its sign."""
    law: Any = LAWS["maxwell-slip"]
    alpha, k = np.array(law.alpha), np.array(law.kappa) * 1e5
    v, d = 5e-4, np.array([0.5, 0.2, 0.1, 0.0]) * 1.5e-5
    rate, _ = law.equations(v, np.concatenate([d, [1.0, 0.0, 0.0, 0.0]]))
    assert k[0] * rate[0] == pytest.approx(100.0 * (alpha[0] - k[0] * d[0] / stribeck(v)), rel=1e-12)
    np.testing.assert_array_equal(rate[1:4], v)
    np.testing.assert_array_equal(rate[4:], 0.0)
    full = np.concatenate([alpha * stribeck(v) / k, np.zeros(4)])
    np.testing.assert_array_equal(law.switched(v, full)[4:], 1.0)
    np.testing.assert_array_equal(law.switched(-v, np.concatenate([full[:4], np.ones(4)]))[4:], 0.0)
    assert law.equations(v, law.switched(v, full))[1] == pytest.approx(law.steady(v), rel=1e-12)


def test_dahl_is_lugre_without_stiction() -> None:
    plain = LuGre(**{**PAPER, "f_s": PAPER["f_c"]})
    one, other = Joint(friction=plain), Joint(friction=LAWS["dahl"])
    for k in range(500):
        one.advance(3.0 * np.sin(0.02 * k), steps=5)
        other.advance(3.0 * np.sin(0.02 * k), steps=5)
        assert other.theta == pytest.approx(one.theta, rel=1e-9, abs=1e-15)


def test_a_plastic_bristle_that_slips_at_once_breaks_away_like_lugre() -> None:
    """The farther a bristle holds, the less it has yielded under the same force."""
    yielded = []
    for break_away in (0.0, 0.5, 0.9):
        joint = Joint(friction=ElastoPlastic.like(LUGRE, break_away))
        for k in range(1000):
            joint.advance(1.2e-3 * k, steps=5)
        yielded.append(joint.theta)
    soft = Joint()
    for k in range(1000):
        soft.advance(1.2e-3 * k, steps=5)
    assert yielded[2] < yielded[1] < yielded[0] < soft.theta


@pytest.mark.parametrize("count", [1, 2, 4, 8])
def test_springs_lie_on_lugres_curve_the_nearer_the_more_they_are(count: int) -> None:
    """Largest distance from 1 - exp(-x) of the best polygons of so many pieces."""
    alpha, kappa = presliding_elements(count)
    x = np.linspace(0.0, 10.0, 10_001)
    distance = np.abs(np.minimum(np.outer(kappa, x), np.array(alpha)[:, None]).sum(axis=0) + np.expm1(-x)).max()
    assert distance < {1: 0.37, 2: 0.12, 4: 0.03, 8: 0.008}[count]
    assert sum(alpha) == pytest.approx(1.0, abs=1e-9)
    assert sum(kappa) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("name", LAWS)
def test_a_step_of_any_length_is_bounded_and_passive(name: str) -> None:
    """At up to 100 m/s times 0.1 s, to and fro: never more than stiction in the springs, and damping never negative."""
    law: Any = LAWS[name]
    generator, bound = np.random.default_rng(2), 1.5 * (1.0 + 1e-9)
    z, memory = np.zeros(law.states), np.zeros(max(1, law.memory))
    springs = len(z) if len(z) == 1 else len(z) // 2
    stiffness = 1e5 * np.array(getattr(law, "kappa", [1.0]))
    for _ in range(2000):
        v = float(generator.choice([-1.0, 1.0]) * 10.0 ** generator.uniform(-7, 2))
        h = float(10.0 ** generator.uniform(-6, -1))
        held, slope = law.respond(v, z, h, law, memory)
        assert slope >= 0.0
        tau_f = law.step(v, z, h, law, memory)
        assert tau_f == pytest.approx(-(held + slope * v), rel=1e-9, abs=1e-9 * (abs(held) + abs(slope * v)))
        assert abs(float(np.sum(stiffness * z[:springs]))) <= bound


@pytest.mark.parametrize("name", LAWS)
def test_a_batch_is_its_environments_and_goes_on_from_a_state(name: str) -> None:
    robot = robot_of("miro_like")
    kind: Any = type(LAWS[name])
    law = robot.friction if name == "lugre" else kind.like(robot.friction)
    plants = [FlexibleJointPlant(robot.link_side, n, joints=robot.flexible, friction=law) for n in (2, 1)]
    torques = np.array([np.full(7, 8.0), np.linspace(-9.0, 9.0, 7)])
    for plant in plants:
        plant.reset(np.arange(plant.num_envs), robot.home)
    for _ in range(30):
        plants[0].step(torques, np.zeros((2, 7)))
        plants[1].step(torques[1:], np.zeros((1, 7)))
    np.testing.assert_array_equal(plants[0].theta[1], plants[1].theta[0])
    states = () if law.states == 1 else (law.states,)
    assert plants[1].z.shape == (1, 7, *states)
    again = pickle.loads(pickle.dumps(plants[1]))
    fresh = FlexibleJointPlant(robot.link_side, 1, joints=robot.flexible, friction=law)
    fresh.set_state(plants[1].get_state())
    for plant in (plants[1], again, fresh):
        plant.step(torques[1:], np.zeros((1, 7)))
        np.testing.assert_array_equal(plant.theta, plants[1].theta)
        np.testing.assert_array_equal(plant.z, plants[1].z)
    assert np.abs(plants[1].theta_dot).max() > 1e-3


@pytest.mark.parametrize("name", LAWS)
def test_load_temperature_and_chance_act_on_a_laws_own_levels(name: str) -> None:
    law: Any = per_joint(LAWS[name], 1)
    names = ("friction", "stiction", "stribeck", "viscous", "bristle")
    drawn = law.drawn({factor: np.array([4.0 if factor == "bristle" else 2.0]) for factor in names})
    assert (drawn.f_c, drawn.sigma_0, drawn.sigma_1, drawn.sigma_2) == pytest.approx((2.0, 4e5, 2 * 1e5**0.5, 0.8))
    if hasattr(law, "f_s"):
        assert (drawn.f_s, drawn.v_s) == pytest.approx((2.0 * 2.0, 2e-3))
    own, now = law.packed(1), law.packed(1)
    type(law).vary(own, now, 0.5, 0.1, viscous=2.0, stiction=0.3)
    assert (now["f_c"], now["sigma_2"], now["sigma_0"]) == pytest.approx((0.6, 0.8, 1e5))
    if hasattr(law, "f_s"):
        assert now["f_s"] == pytest.approx(0.5 * 1.5 + 0.1 + 0.3)


def test_what_a_law_cannot_be_is_refused() -> None:
    with pytest.raises(ValueError, match=r"Dahl\.f_c is 0 where sigma_0 is above 0"):
        Dahl(sigma_0=1e5, f_c=0.0)
    with pytest.raises(ValueError, match=r"break_away is 1\.0; a bristle starts to slip below f_c: give less than 1"):
        ElastoPlastic.like(LUGRE, 1.0)
    with pytest.raises(ValueError, match=r"ElastoPlastic\.f_s is 1\.0; stiction must be at least"):
        ElastoPlastic(1e5, 300.0, 0.4, 2.0, 1.0, 1e-3)
    good: Any = {**PAPER, "attraction": 100.0, "alpha": (0.5, 0.5), "kappa": (0.7, 0.3)}
    assert MaxwellSlip(**good).states == 4
    for change, told in (
        ({"alpha": (0.5, 0.4)}, "of sum 0.9, not 1"),
        ({"kappa": (1.0,)}, "equally many"),
        ({"alpha": (1.2, -0.2)}, "above 0"),
        ({"sigma_0": 0.0}, "it must be above 0"),
    ):
        with pytest.raises(ValueError, match=told):
            MaxwellSlip(**{**good, **change})


def test_a_plant_keeps_its_law_and_mujoco_has_lugre_alone() -> None:
    robot = robot_of("single_link")
    law = Dahl.like(robot.friction)  # type: ignore[arg-type]
    plant = FlexibleJointPlant(robot.link_side, 1, joints=robot.flexible, friction=law)
    with pytest.raises(ValueError, match="this plant's law is Dahl with 1 state"):
        plant.configure(np.array([0]), joints=robot.flexible, friction=robot.friction)
    with pytest.raises(ValueError, match="friction is Dahl; MuJoCo has LuGre alone"):
        plant.to_mujoco()


def test_the_solver_stops_where_a_law_changes() -> None:
    """One spring, pulled by a constant force over its bound: the time at which it slips, and the motion after it."""
    law = MaxwellSlip(1e5, 0.0, 0.0, 1.0, 1.0, 1e-3, 100.0, (1.0,), (1.0,))
    link = LawLink(FlexibleJoint(1e-6, 0.0, 1.0, 10.0), law, 1.0)
    end = link.advanced(np.zeros(6), (2.0, 0.0), 0.02)
    omega = math.sqrt(1e5)  # theta = 2e-5 (1 - cos omega t) until it is 1e-5
    slips = math.acos(0.5) / omega
    rest, speed = 0.02 - slips, 2e-5 * omega * math.sin(omega * slips)
    assert end[2] == pytest.approx(1e-5 + speed * rest + 0.5 * rest**2, rel=1e-7)
    assert end[4:] == pytest.approx([1e-5, 1.0], rel=1e-9)
