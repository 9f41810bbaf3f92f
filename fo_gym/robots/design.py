"""Motors, springs and friction of a robot that nobody has measured: designed from its inertia and its gravity load.

All rules are in natural units (fo_gym.robots.poses): a slide counts as a hinge with a lever of 0.1 m. The numbers are
those of arms that were measured:

| arm | B [kg m^2] | K_j / B [1/s^2] | limit / B [rad/s^2] | f_c / B [rad/s^2] | f_c / limit | sigma_2 / B [1/s] |
|---|---|---|---|---|---|---|
| MIRO-like (friction: ours) | 0.6-1.2 | 4200-5000 | 67-125 | 4.5-6.7 | 0.04-0.1 | 3-5 |
| Kinova Gen3 (empriselab) | 0.18-0.3 | 13000-19000 | 72-130 | | | |
| Rhoban BAM, eRob80:100 and :50 | 0.33-0.96 | | | 6-10 | | 4-9 |
| TREE "Orange", 80:1 | 0.3 | 20000 | | 9-20 | | 7 |
| KAIST study, 7 joints | 0.2-0.4 | 20000-35000 | | 17-35 | | 5-9 |
| Panda (Gaz et al. 2019) | | | | | 0.01-0.05 | |
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.friction import LuGre
from fo_gym.parameters import FlexibleJoint
from fo_gym.robots.poses import Poses

Array = NDArray[np.float64]

LIMIT_GRAVITY, LIMIT_ACCELERATION = 3.0, 60.0
"""A torque limit is so many times the largest gravity load, and accelerates the link by so much [rad/s^2]."""

LIMIT_SHARE = 0.15
"""A joint's torque limit is at least this share of the strongest one's: Panda 0.14, iiwa 0.13, UR5e 0.19."""

ACCELERATION = 100.0
"""A motor at its torque limit accelerates itself by so much [rad/s^2]: B = limit / ACCELERATION."""

INERTIA_RATIO = (0.3, 3.0)
"""B is at least the first times its own link's M_jj, at most the second times the largest M_jj of the arm."""

MOTOR_MODE = (100.0, 400.0)
"""sqrt(K_j / B) [rad/s], the motor against a held link: as designed, and the highest that 1 kHz follows, 0.4 of a
radian between two samples."""

SPRING_MODE = 1500.0
"""sqrt(K_j (1/B + (M^-1)_jj)) at most [rad/s]: 0.3 of a radian in the default micro-step of 0.2 ms, where 0.5 is the
limit; what "randomized" draws needs the rest."""

SAG = 0.01
"""Gravity deflects a spring by so much at most [rad]: MIRO-like 0.005 at joint 2."""

SPRING_DAMPING = 0.01
"""Damping ratio of the spring's mode; no public number was found, and steel gears lose little."""

FRICTION_SHARE = 0.05
"""f_c as a share of the torque limit."""

FRICTION_DECELERATION = (3.0, 10.0)
"""f_c / B at least and at most [rad/s^2]."""

PLACEHOLDER = 1.0
"""A file's frictionloss that decelerates the motor by less than this [rad/s^2] is a solver's placeholder."""

FRICTION_MOST = 0.25
"""Share of the torque limit from which on a file's frictionloss leaves too little to move with."""

STICTION = 1.5
"""f_s / f_c: the paper's single link (arXiv:1907.00553); MIRO-like 2.15, and about 2 on a loaded joint (axol)."""

DEFLECTION = 1e-4
"""f_c / sigma_0, how far a bristle yields before it slips [rad], at least: MIRO-like."""

BRISTLE_MODE = 300.0
"""sqrt(sigma_0 / B) at most [rad/s]: the default micro-step of 0.2 ms follows it, with what "randomized" draws."""

STRIBECK = 0.01
"""v_s [rad/s]: between MIRO-like, 0.002, and the KAIST study, 0.06."""

VISCOUS = 5.0
"""sigma_2 / B [1/s]."""

__all__ = ["designed_friction", "designed_joints"]


def _two_digits(natural: Array, units: Array) -> Array:
    """Values in natural units, such that they have two digits in the joints' own, value / units.

    What is assumed should look so, and the last bits of a processor should not count.
    """
    return units * [float(f"{value:.1e}") for value in natural / units]


def designed_joints(
    model: mujoco.MjModel, home: Array, *, armature: Array | None = None, torque_limit: Array | None = None
) -> FlexibleJoint:
    """Motor and spring of every joint.

    * Torque limit: the file's; else LIMIT_GRAVITY times the largest gravity load over the poses plus LIMIT_ACCELERATION
      times M_jj(home) and the file's armature, at least LIMIT_SHARE of the strongest joint's.
    * B: the file's armature; else limit / ACCELERATION, within INERTIA_RATIO.
    * K_j: B times the square of MOTOR_MODE, of its higher value where gravity asks for it by SAG; at most what
      SPRING_MODE allows in all of the poses that were looked at.
    * D_j: SPRING_DAMPING of the spring's mode at home.

    Args:
        model: the compiled link side, without armature.
        home: start pose, (dof,) [rad | m].
        armature: B as the file has it, (dof,) [kg m^2 | kg], 0 where it has none.
        torque_limit: as the file has it, (dof,) [N m | N], NaN where it has none.
    """
    poses = Poses(model)
    units = poses.units
    own = np.diag(poses.inertia(home)) * units**2
    load = _gravity_load(poses) * units
    rotor = np.maximum(_known(armature, 0.0, len(home)) * units**2, 0.0)
    limit = LIMIT_GRAVITY * load + LIMIT_ACCELERATION * (own + rotor)
    given = _known(torque_limit, np.nan, len(home)) * units
    limit = np.where(np.isfinite(given), given, limit)
    limit = np.where(np.isfinite(given), given, _two_digits(np.maximum(limit, LIMIT_SHARE * limit.max()), units))
    least, most = INERTIA_RATIO
    inertia = np.clip(limit / ACCELERATION, least * own, np.maximum(most * own.max(), least * own))
    inertia = np.where(rotor > 0.0, rotor, _two_digits(inertia, units**2))
    mobility = _mobility(poses) / units**2
    softest = SPRING_MODE**2 / (1.0 / inertia + mobility.max(axis=0))
    usual, highest = (mode**2 * inertia for mode in MOTOR_MODE)
    stiffness = np.minimum(np.clip(load / SAG, usual, highest), softest)
    damping = 2.0 * SPRING_DAMPING * np.sqrt(stiffness / (1.0 / inertia + mobility[0]))
    return FlexibleJoint(
        stiffness=_two_digits(stiffness, units**2) / units**2,
        damping=_two_digits(damping, units**2) / units**2,
        motor_inertia=inertia / units**2,
        torque_limit=limit / units,
    )


def designed_friction(model: mujoco.MjModel, joints: FlexibleJoint, *, frictionloss: Array | None = None) -> LuGre:
    """LuGre friction of every joint.

    * f_c: the file's frictionloss, unless it is below PLACEHOLDER or above FRICTION_MOST; else FRICTION_SHARE of the
      torque limit, within FRICTION_DECELERATION.
    * f_s, sigma_0, v_s, sigma_2 by STICTION, DEFLECTION (more where BRISTLE_MODE asks for it), STRIBECK and VISCOUS;
      sigma_1 = sqrt(sigma_0 B), which damps the bristle's mode by a half.

    Args:
        model: the compiled link side.
        joints: motors and springs, one value per joint.
        frictionloss: dry friction as the file has it, (dof,), 0 where it has none.
    """
    units = Poses(model).units
    inertia = joints.motor_inertia * units**2
    least, most = FRICTION_DECELERATION
    designed = np.clip(FRICTION_SHARE * joints.torque_limit * units, least * inertia, most * inertia)
    given = _known(frictionloss, 0.0, len(units)) * units
    plausible = (given >= PLACEHOLDER * inertia) & (given <= FRICTION_MOST * joints.torque_limit * units)
    f_c = np.where(plausible, given, _two_digits(designed, units))
    sigma_0 = np.minimum(f_c / DEFLECTION, BRISTLE_MODE**2 * inertia)
    return LuGre(
        sigma_0=sigma_0 / units**2,
        sigma_1=np.sqrt(sigma_0 * inertia) / units**2,
        sigma_2=VISCOUS * inertia / units**2,
        f_c=f_c / units,
        f_s=STICTION * f_c / units,
        v_s=STRIBECK * units,
    )


def _known(given: Array | None, nothing: float, dof: int) -> Array:
    """What the file gives, (dof,), with `nothing` where it gives nothing."""
    return np.full(dof, nothing) if given is None else np.asarray(given, dtype=np.float64)


def _gravity_load(poses: Poses) -> Array:
    """The largest |g_j| over all of the ranges, (dof,) [N m | N]."""
    return np.max(np.abs([poses.gravity(q) for q in poses.sample(255, share=1.0)]), axis=0)


def _mobility(poses: Poses) -> Array:
    """(M^-1)_jj in many poses, (n, dof), the middle of the ranges first."""
    return np.array([np.diag(np.linalg.inv(poses.inertia(q))) for q in poses.sample(255, share=1.0)])
