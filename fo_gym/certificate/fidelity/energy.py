"""Energy: what the motors and the world put in is stored, or taken by friction; nothing else comes or goes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import ARM, PERIOD, WITHOUT_FRICTION, Case, arm_case
from fo_gym.certificate.experiments import SAMPLE, Joint
from fo_gym.certificate.oracle import Arm, lugre
from fo_gym.certificate.statement import Finding, at_most, check, near
from fo_gym.certificate.subject import Subject
from fo_gym.micro_steps import DEFAULT_PHYSICS_DT, micro_steps
from fo_gym.plant import FlexibleJointPlant

Array = NDArray[np.float64]

SEED = 20240613
CONSERVATION = "conservation of energy, Pinocchio's energy of the links"


def _stored(arm: Arm, plant: FlexibleJointPlant) -> float:
    """Energy of links (Pinocchio's), springs and motors [J]."""
    links = arm.energy(plant.q[0], plant.q_dot[0])
    springs = 0.5 * arm.joint.stiffness * (plant.theta - plant.q) ** 2
    return float(links + np.sum(springs + 0.5 * arm.joint.motor_inertia * plant.theta_dot**2))


def _bristles(arm: Arm, plant: FlexibleJointPlant) -> float:
    """Energy of the bristles [J]."""
    return float(np.sum(0.5 * arm.friction.sigma_0 * plant.z**2))


def _dissipation(arm: Arm, plant: FlexibleJointPlant) -> float:
    """Power that LuGre's equations take: friction times velocity, less what goes into the bristles [W]."""
    friction: Any = arm.friction
    z_rate, tau_f = lugre(plant.theta_dot, plant.z, friction, np.exp)
    return float(np.sum(-tau_f * plant.theta_dot - friction.sigma_0 * plant.z * z_rate))


@dataclass(frozen=True)
class _Ledger:
    """Energies of an arm since its start, at every micro-step, (steps,) each [J].

    Attributes:
        put_in: work of motors and push.
        turned_over: the same, every joint's share in absolute values.
        stored: in links, springs, motors and bristles.
        damped: taken by the springs' dampers.
        taken: taken by friction, less what the bristles store.
        dissipated: LuGre's dissipation, integrated.
    """

    put_in: Array
    turned_over: Array
    stored: Array
    damped: Array
    taken: Array
    dissipated: Array


@lru_cache(maxsize=1)
def _ledger(subject: Subject) -> _Ledger:
    """One second of a step and a push on the 7-joint arm under the PD-type observer.

    Control acts at every micro-step, so that the plant's mean friction times the motor's way is friction's work.
    """
    case, h = (
        arm_case(ARM.link_side, ARM.home, np.random.default_rng(SEED), 2),
        subject.physics_dt or DEFAULT_PHYSICS_DT,
    )
    arm, plant = case.equations, case.plant(h, control_dt=h)
    assert isinstance(arm, Arm)
    control = case.control(plant.theta.copy())
    control.dt = h
    start, power, rows = _stored(arm, plant), _dissipation(arm, plant), []
    for k in range(round(len(case.tau_ext) * PERIOD / h)):
        push = case.tau_ext[int((k + 0.5) * h / PERIOD)]
        theta, q = plant.theta.copy(), plant.q.copy()
        tau_m = control(theta, plant.theta_dot, plant.tau_j)
        plant.step(tau_m, push[None])
        motor, link = plant.theta - theta, plant.q - q
        before, power = power, _dissipation(arm, plant)
        works = np.append(tau_m * motor, push * link)
        damped = np.sum(arm.joint.damping * (motor - link) ** 2) / h
        flows = works.sum(), np.abs(works).sum(), damped, -np.sum(plant.tau_f * motor), 0.5 * h * (before + power)
        rows.append((*flows, _stored(arm, plant) - start, _bristles(arm, plant)))
    columns = np.array(rows).T
    put_in, turned_over, damped, friction, dissipated = np.cumsum(columns[:5], axis=1)
    bristles = columns[6]
    return _Ledger(put_in, turned_over, columns[5] + bristles, damped, friction - bristles, dissipated)


@check(
    "energy-balance",
    source=CONSERVATION,
    text="On the 7-joint arm, with inertia renewed every micro-step, the work of motors and push is what links, "
    "springs, motors and bristles store and "
    "friction and dampers take, within 1e-7 of the energy turned over.",
)
def energy_balance(subject: Subject) -> Finding:
    """Largest imbalance over 1 s."""
    ledger = _ledger(subject)
    imbalance = np.abs(ledger.put_in - ledger.stored - ledger.damped - ledger.taken).max()
    total = ledger.turned_over[-1]
    measured = (
        f"largest imbalance, {imbalance:.1e} J of {total:.2f} J turned over; put in {ledger.put_in[-1]:.3f} J, stored "
        f"{ledger.stored[-1]:.3f} J, taken by friction {ledger.taken[-1]:.3f} J, by dampers {ledger.damped[-1]:.3f} J"
    )
    return at_most(imbalance / total, 1e-7, "", measured)


@check(
    "energy-dissipation",
    source="LuGre's equations, sigma_0^2 |v| z^2 / g + sigma_1 z' v + sigma_2 v^2",
    text="What friction takes on the arm, less what its bristles store, is the integral of LuGre's dissipation within "
    "0.01 %, and never falls.",
)
def energy_dissipation(subject: Subject) -> Finding:
    """Largest difference from the integral; infinite where friction gives back more than its bristles held."""
    taken, dissipated = _ledger(subject).taken, _ledger(subject).dissipated
    smallest = np.diff(taken, prepend=0.0).min()
    share = 100 * np.abs(taken - dissipated).max() / taken[-1] if smallest >= 0.0 else np.inf
    measured = f"largest difference in 1 s, of {taken[-1]:.2f} J; the least that a micro-step takes is {smallest:.1e} J"
    return at_most(share, 0.01, "%", measured)


def _free_motion(generator: np.random.Generator, physics_dt: float | None) -> tuple[float, float]:
    """Largest rise of energy above its lowest so far, and what is left after 4 s, as shares of the start's."""
    q, w, theta, v = generator.normal(size=4) * [1e-2, 0.3, 1e-2, 0.3]
    joint = Joint(stiffness=3000.0).put(q=q, q_dot=w, theta=theta, theta_dot=v)
    steps, energies = micro_steps(SAMPLE, physics_dt), []
    for _ in range(4000 * steps + 1):
        kinetic = 0.5 * joint.q_dot**2 + 0.5 * joint.theta_dot**2
        energies.append(kinetic + 0.5 * 3000.0 * (joint.theta - joint.q) ** 2 + 0.5 * 1e5 * joint.z**2)
        joint.advance(h=SAMPLE / steps)
    energy = np.array(energies) / energies[0]
    return float((energy - np.minimum.accumulate(energy)).max()), float(energy[-1])


@check(
    "energy-free-motion",
    source="on these motions friction takes energy throughout",
    text="Left to itself for 4 s, a single joint only loses energy, through slips, reversals and stiction; 1e-6 of "
    "the start is left to the step.",
)
def energy_free_motion(subject: Subject) -> Finding:
    """Largest rise over random starts."""
    runs = [_free_motion(np.random.default_rng([SEED, i]), subject.physics_dt) for i in range(subject.count(15))]
    rises, left = np.array(runs).T
    measured = (
        f"largest rise above the lowest so far in {len(runs)} random starts, as a share of the start; "
        f"at most {left.max():.1g} of it is left"
    )
    return at_most(rises.max(), 1e-6, "", measured)


def _swing_drift(pose: Array, physics_dt: float | None, control_dt: float) -> float:
    """Largest change of energy in 2 s of free fall from rest, as a share of the potential energy turned over."""
    arm, still = Arm(ARM.link_side.model, ARM.flexible, WITHOUT_FRICTION), np.zeros((1, ARM.dof))
    plant = Case(ARM.link_side, arm, pose).plant(physics_dt, control_dt)
    potential, stored = [], []
    for _ in range(round(2.0 / control_dt) + 1):
        potential.append(arm.energy(plant.q[0], still[0]))
        stored.append(_stored(arm, plant))
        plant.step(still, still)
    return float(np.abs(np.array(stored) - stored[0]).max() / np.ptp(potential))


@check(
    "energy-swing",
    source=CONSERVATION,
    text="Let go without friction and torques from random poses, the 7-joint arm keeps its energy for 2 s at 1 kHz "
    "within 0.5 % of what moves.",
)
def energy_swing(subject: Subject) -> Finding:
    """Largest drift over random poses."""
    spread = [np.random.default_rng([SEED, i]).uniform(-0.5, 0.5, ARM.dof) for i in range(subject.count(15))]
    drifts = [100 * _swing_drift(ARM.home + offset, subject.physics_dt, PERIOD) for offset in spread]
    measured = (
        f"largest drift from {len(drifts)} poses, as a share of the potential energy turned over; "
        f"median {np.median(drifts):.1g} %"
    )
    return at_most(max(drifts), 0.5, "%", measured)


@check(
    "energy-swing-order",
    source=CONSERVATION,
    text="That drift falls with the square of the control period, over which inertia and bias are held.",
)
def energy_swing_order(subject: Subject) -> Finding:
    """Slope of log(drift) over log(control period), from the home pose."""
    h = subject.physics_dt or DEFAULT_PHYSICS_DT
    periods = [4 * h, 2 * h, h]
    drifts = [_swing_drift(ARM.home, h, period) for period in periods]
    values = ", ".join(f"{drift:.1e}" for drift in drifts)
    measured = f"slope over control periods of {', '.join(f'{1e6 * p:g}' for p in periods)} us; drifts {values}"
    return near(np.polyfit(np.log(periods), np.log(drifts), 1)[0], 2.0, 0.1, "", measured)
