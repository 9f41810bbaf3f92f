"""Gains for any arm, from its inertia: a wanted bandwidth and damping, within what motors and observers can follow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

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

STIFFEST_RATE = 500.0
"""The same where gravity asks for more than STIFFNESS_RATE [1/s^2]."""

GRAVITY_SHARE = 0.6
"""Share of the impedance's stiffness that dg/dq at home may have. The impedance knows gravity where the joints are;
with a compensator that takes gravity for friction, dg/dq acts as a spring of either sign."""

DAMPING_RATE = 200.0
"""K_d / B at most [1/s]: a fifth of the sampling rate of 1 kHz."""

SINGULAR = 1e6
"""Condition number of the controlled coordinates' Jacobian from which on a pose is singular."""

TOMEI = 1.15
"""K_p is at least so many times the largest |dg/dq|: below once (Tomei 1991) gravity has more than one rest."""

__all__ = ["Response", "designed_impedance", "designed_pd"]


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


def designed_pd(robot: Robot, response: Response = JOINT) -> PDGains:
    """Motor PD gains, one value per joint.

    K_p = bandwidth^2 (M_jj(home) + B), at most STIFFNESS_RATE B and what a STEP may ask of the torque limit, but at
    least TOMEI times the bound of |dg/dq| (Poses.gravity_bound). K_d = 2 damping sqrt(K_p (M_jj + B)), at most
    DAMPING_RATE B.
    """
    model, home, joints = robot.link_side.model, robot.home, robot.flexible
    poses = Poses(model)
    inertia = np.diag(poses.inertia(home)) + joints.motor_inertia
    free = np.maximum(joints.torque_limit - np.abs(poses.gravity(home)), 0.0)
    kp = np.minimum(response.bandwidth**2 * inertia, STIFFNESS_RATE * joints.motor_inertia)
    kp = np.minimum(kp, STEP_SHARE * free / (STEP * poses.units))
    kp = np.maximum(kp, TOMEI * poses.gravity_bound())
    kd = np.minimum(2.0 * response.damping * np.sqrt(kp * inertia), DAMPING_RATE * joints.motor_inertia)
    return PDGains(kp=kp, kd=kd)


def designed_impedance(robot: Robot) -> ImpedanceGains:
    """Impedance gains from the inertia that the controlled coordinates feel at home, links and motors together.

    With A the Jacobian of tool position, tool orientation and redundant joints, Lambda = A^-T (M + B) A^-1. Each part
    gets K_p = bandwidth^2 Lambda and K_d = 2 damping sqrt(K_p Lambda), Lambda the geometric mean over its own
    directions, at most what STIFFNESS_RATE and DAMPING_RATE allow the motors; all K_p are raised together, up to
    STIFFEST_RATE, where dg/dq would be more than GRAVITY_SHARE of them. The orientation's gains are without effect
    where the position alone is controlled, as are the elbow's where no joint is redundant.

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

    parts = [(slice(0, 3), POSITION), (slice(3, 6), ORIENTATION)][: rows // 3]
    parts += [(slice(i, i + 1), ELBOW) for i in range(rows, robot.dof)]
    # How much inertia each part feels; and how fast a unit of stiffness makes the motors alone: the largest eigenvalue
    # of B^-1 J^T J.
    felt = np.array([np.exp(np.log(np.linalg.eigvalsh(inertia[part, part])).mean()) for part, _ in parts])
    lightest = np.array([np.linalg.eigvalsh((jacobian[part] / motors) @ jacobian[part].T)[-1] for part, _ in parts])
    bandwidth, damping = np.array([(response.bandwidth, response.damping) for _, response in parts]).T
    kp = np.minimum(bandwidth**2 * felt, STIFFNESS_RATE / lightest)
    joint_stiffness = sum(k * jacobian[part].T @ jacobian[part] for k, (part, _) in zip(kp, parts, strict=True))
    slope = poses.gravity_slope(home)
    outweighed = np.abs(eigh(0.5 * (slope + slope.T), joint_stiffness, eigvals_only=True)).max() / GRAVITY_SHARE
    kp *= np.clip(outweighed, 1.0, (STIFFEST_RATE / lightest / kp).min())
    kd = np.minimum(2.0 * damping * np.sqrt(kp * felt), DAMPING_RATE / lightest)
    last = rows // 3
    elbow = (kp[last:], kd[last:]) if robot.redundant else (kp[-1], kd[-1])
    return ImpedanceGains(float(kp[0]), float(kd[0]), float(kp[last - 1]), float(kd[last - 1]), *elbow)
