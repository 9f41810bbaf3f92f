"""Gains for any arm, from its inertia: a wanted bandwidth and damping, within what motors and observers can follow."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.parameters import ImpedanceGains, PDGains
from fo_gym.robots import Robot
from fo_gym.robots.poses import Poses, tool_rows

Array = NDArray[np.float64]

STEP = float(np.deg2rad(5.0))
"""The step that the motor PD answers without reaching the torque limits [rad]."""

STEP_SHARE = 0.4
"""Share of the torque limit, less gravity at home, that the step may ask for."""

STIFFNESS_RATE = 250.0
"""K_p / B at most [1/s^2]. The paper's low gains hold the motor to the nominal one with B L L_p = 500 B: at half of
that, what friction they leave displaces the motor by half of what it does without compensation."""

DAMPING_RATE = 200.0
"""K_d / B at most [1/s]: a fifth of the sampling rate of 1 kHz."""

SINGULAR = 1e6
"""Condition number of the controlled coordinates' Jacobian from which on a pose is singular."""

TOMEI = 1.15
"""K_p is at least so many times the largest |dg/dq|: below once (Tomei 1991) gravity has more than one rest."""

__all__ = ["Response", "designed_impedance", "designed_pd", "gravity_slope"]


@dataclass(frozen=True)
class Response:
    """How a friction-free loop should answer.

    Attributes:
        bandwidth: natural frequency [rad/s].
        damping: damping ratio.
    """

    bandwidth: float
    damping: float


JOINT = Response(5.0, 0.5)
"""Motor PD: the paper's joint 2, K_p = 50 and B about 1, has 5 rad/s; its K_d = 2, a damping of 0.1, suits an arm whose
viscous friction damps it, and is raised here."""

POSITION = Response(10.0, 1.0)
ORIENTATION = Response(5.0, 0.7)
ELBOW = Response(7.0, 0.7)
"""Impedance: the paper's 1000 N/m, 200 N s/m and 10 N m/rad, 2 N m s/rad on the MIRO-like arm."""


def gravity_slope(model: mujoco.MjModel) -> Array:
    """A bound of |dg/dq| for every joint over all poses, (dof,) [N m/rad | N/m].

    The largest sum of a row of dg/dq, other joints counted in natural units: diag(K_p) above it makes K_p + dg/dq
    diagonally dominant, hence positive definite, so that PD with g(q_d) has one rest (Tomei 1991), and K_j above it
    makes the springs' own rest unique.
    """
    poses = Poses(model)
    slopes = np.abs([poses.gravity_slope(q) for q in poses.sample(127, share=1.0)])
    return np.asarray((slopes @ poses.units).max(axis=0) / poses.units)


def designed_pd(robot: Robot, response: Response = JOINT) -> PDGains:
    """Motor PD gains, one value per joint.

    K_p = bandwidth^2 (M_jj(home) + B), at most STIFFNESS_RATE B and what a STEP may ask of the torque limit, but at
    least TOMEI times `gravity_slope`. K_d = 2 damping sqrt(K_p (M_jj + B)), at most DAMPING_RATE B.
    """
    model, home, joints = robot.link_side.model, robot.home, robot.flexible
    poses = Poses(model)
    inertia = np.diag(poses.inertia(home)) + joints.motor_inertia
    free = np.maximum(joints.torque_limit - np.abs(poses.gravity(home)), 0.0)
    kp = np.minimum(response.bandwidth**2 * inertia, STIFFNESS_RATE * joints.motor_inertia)
    kp = np.minimum(kp, STEP_SHARE * free / (STEP * poses.units))
    kp = np.maximum(kp, TOMEI * gravity_slope(model))
    kd = np.minimum(2.0 * response.damping * np.sqrt(kp * inertia), DAMPING_RATE * joints.motor_inertia)
    return PDGains(kp=kp, kd=kd)


def designed_impedance(robot: Robot) -> ImpedanceGains:
    """Impedance gains from the inertia that the controlled coordinates feel at home, links and motors together.

    With A the Jacobian of tool position, tool orientation and redundant joints, Lambda = A^-T (M + B) A^-1. Each part
    gets K_p = bandwidth^2 Lambda and K_d = 2 damping sqrt(K_p Lambda), Lambda the geometric mean over its own
    directions, at most what STIFFNESS_RATE and DAMPING_RATE allow the motors. The orientation's gains are without
    effect where the position alone is controlled, as are the elbow's where no joint is redundant.

    Raises:
        ValueError: the robot has no tool, or it is at a singularity at home.
    """
    if robot.tool is None:
        raise ValueError(
            f"robot {robot.name!r} has no tool for an impedance; name a site, a body or a link of its file"
        )
    model, home, motors = robot.link_side.model, robot.home, np.asarray(robot.flexible.motor_inertia)
    poses, rows = Poses(model, robot.tool), tool_rows(robot.dof)
    held = np.eye(robot.dof)[[robot.joints.index(name) for name in robot.redundant]].reshape(-1, robot.dof)
    jacobian = np.concatenate([poses.jacobian(home)[:rows], held])
    if len(jacobian) != robot.dof or np.linalg.cond(jacobian) > SINGULAR:
        raise ValueError(
            f"robot {robot.name!r} cannot move its tool in {rows} directions at home, its redundant joints "
            f"{robot.redundant} held; choose another home, tool or other redundant joints"
        )
    inverse = np.linalg.inv(jacobian)
    inertia = inverse.T @ (poses.inertia(home) + np.diag(motors)) @ inverse

    def gains(part: slice, response: Response) -> tuple[float, float]:
        own = jacobian[part]
        felt = float(np.exp(np.log(np.linalg.eigvalsh(inertia[part, part])).mean()))
        # The largest eigenvalue of B^-1 J^T J: how fast a unit of stiffness makes the motors alone.
        lightest = float(np.linalg.eigvalsh((own / motors) @ own.T)[-1])
        kp = min(response.bandwidth**2 * felt, STIFFNESS_RATE / lightest)
        return kp, min(2.0 * response.damping * np.sqrt(kp * felt), DAMPING_RATE / lightest)

    position = gains(slice(0, 3), POSITION)
    orientation = gains(slice(3, 6), ORIENTATION) if rows == 6 else position
    elbow = [gains(slice(i, i + 1), ELBOW) for i in range(rows, robot.dof)]
    kp_elbow, kd_elbow = np.array(elbow).T if elbow else orientation
    return ImpedanceGains(*position, *orientation, kp_elbow, kd_elbow)
