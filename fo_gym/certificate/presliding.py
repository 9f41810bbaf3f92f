"""Friction below break-away: what a law does along a prescribed way, and under a load that vibrates."""

from __future__ import annotations

from itertools import pairwise

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.experiments import SAMPLE, Joint
from fo_gym.friction import FrictionLaw, LuGre, MaxwellSlip
from fo_gym.micro_steps import micro_steps

Array = NDArray[np.float64]

SPEED = 1e-6
"""Of a prescribed way [m/s]: a thousandth of the paper's Stribeck velocity, so that only the way counts."""

PIECES = 400
"""Positions in each straight part of a way."""

__all__ = ["PIECES", "friction_on", "tendons_on", "vibrated", "way"]


def way(*turns: float, pieces: int = PIECES) -> Array:
    """Positions [m] from 0 by way of some turning points, so many to each of them."""
    ends = (0.0, *turns)
    parts = [np.linspace(a, b, pieces + 1)[1:] for a, b in pairwise(ends)]
    return np.concatenate(parts)


def friction_on(law: FrictionLaw, positions: Array) -> Array:
    """Friction F = -tau_f [N] at the end of each step to the next of some positions [m], from rest, at SPEED."""
    z, memory = np.zeros(law.states), np.zeros(max(1, law.memory))
    friction = np.empty(len(positions))
    for k, stretch in enumerate(np.diff(positions, prepend=0.0)):
        h, v = abs(stretch) / SPEED, SPEED * float(np.sign(stretch))
        law.respond(v, z, h, law, memory)
        law.step(v, z, h, law, memory)
        friction[k] = -law.equations(0.0, law.switched(0.0, z))[1]
    return friction


def tendons_on(law: MaxwellSlip, positions: Array) -> Array:
    """Force [N] of the same springs side by side as MuJoCo's yielding tendons, on a joint at each of some positions."""
    spec = mujoco.MjSpec()
    spec.option.gravity = [0.0, 0.0, 0.0]
    # So heavy that its springs do not move it within the step in which they yield.
    body = spec.worldbody.add_body(name="motor", mass=1e9, inertia=[1.0] * 3, explicitinertial=True)
    body.add_joint(name="motor", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[1.0, 0.0, 0.0])
    for i, (alpha, kappa) in enumerate(zip(law.alpha, law.kappa, strict=True)):
        stiffness = kappa * float(law.sigma_0)
        tendon = spec.add_tendon(name=f"spring{i}", stiffness=[stiffness, 0.0, 0.0], springlength=[0.0, 0.0])
        tendon.springyield = alpha * float(law.f_s) / stiffness
        tendon.wrap_joint("motor", 1.0)
    model = spec.compile()
    data, force = mujoco.MjData(model), np.empty(len(positions))
    for k, position in enumerate(positions):
        data.qpos[0], data.qvel[0] = position, 0.0
        mujoco.mj_step(model, data)
        force[k] = -data.qfrc_spring[0]
    return force


def vibrated(law: FrictionLaw, lugre: LuGre, physics_dt: float | None = None) -> float:
    """Mean speed of a motor of 1 kg under (0.4 + 0.2 sin 20 pi t) f_c, at most 0.6 f_c, over 10 s after 2 s [m/s].

    Args:
        law: of the motor.
        lugre: whose f_c is meant.
        physics_dt: micro-step [s].
    """
    joint, steps = Joint(friction=law), micro_steps(SAMPLE, physics_dt)
    positions = []
    for k in range(12_000):
        t = (k + 0.5) * SAMPLE
        share = 0.4 + 0.2 * np.sin(20.0 * np.pi * t)
        joint.advance(share * min(1.0, t) * float(lugre.f_c), steps, SAMPLE / steps)
        positions.append(joint.theta)
    per_cycle = np.array(positions).reshape(-1, 100).mean(axis=1)
    return float(abs(per_cycle[-1] - per_cycle[20]) / (0.1 * (len(per_cycle) - 21)))
