"""A two-link pendulum in the vertical plane, for the tests of the plant."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from fo_gym.friction import FRICTIONLESS, LuGre
from fo_gym.parameters import FlexibleJoint
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import LinkSide

JOINTS = FlexibleJoint(stiffness=3000.0, damping=0.0, motor_inertia=1.0, torque_limit=100.0)
FRICTION = LuGre(sigma_0=1e4, sigma_1=1e2, sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=5e-3)
POSE = np.array([0.3, -0.8])

PENDULUM = """
<mujoco model="pendulum">
  <compiler angle="radian"/>
  <worldbody>
    {world}
    <body name="upper">
      <joint name="shoulder" axis="0 1 0" {shoulder}/>
      <inertial pos="0.2 0 0" mass="2" diaginertia="0.01 0.03 0.03"/>
      <geom name="upper_shell" type="capsule" fromto="0 0 0 0.4 0 0" size="0.05" mass="0"/>
      <body name="fore" pos="0.4 0 0">
        <joint name="elbow" type="{elbow_type}" {elbow}/>
        <inertial pos="0.15 0 0" mass="1" diaginertia="0.005 0.01 0.01"/>
        <geom name="fore_shell" type="capsule" fromto="0.1 0 0 0.3 0 0" size="0.05" mass="0"/>
        <site name="tip" pos="0.3 0 0"/>
      </body>
    </body>
  </worldbody>
  {rest}
</mujoco>
"""
MakeRobot = Callable[..., LinkSide]


def write_pendulum(
    folder: Path, shoulder: str = "", elbow: str = 'axis="0 1 0"', elbow_type: str = "hinge", **parts: str
) -> LinkSide:
    """Write the pendulum, with the given attributes of its joints, and name its joints."""
    values = {"world": "", "rest": "", **parts}
    path = folder / "pendulum.xml"
    path.write_text(PENDULUM.format(shoulder=shoulder, elbow=elbow, elbow_type=elbow_type, **values))
    return LinkSide(path, ("shoulder", "elbow"))


def plant_of(robot: LinkSide, num_envs: int = 1, friction: LuGre = FRICTION, **options: Any) -> FlexibleJointPlant:
    plant = FlexibleJointPlant(robot, num_envs, joints=JOINTS, friction=friction, **options)
    plant.reset(np.arange(num_envs), POSE)
    return plant


def drive(plant: FlexibleJointPlant, ticks: int, start: int = 0) -> np.ndarray:
    """Motion under torques that depend on tick and environment, (ticks, 5, num_envs, dof)."""
    history = []
    phase = np.arange(plant.q.size).reshape(plant.q.shape)
    for k in range(start, start + ticks):
        plant.step(8.0 * np.sin(0.05 * k + phase), 2.0 * np.cos(0.03 * k + phase))
        history.append(np.stack([plant.q, plant.q_dot, plant.theta, plant.theta_dot, plant.z]))
    return np.array(history)


def varied(robot: LinkSide) -> FlexibleJointPlant:
    """Three environments with masses, friction and poses of their own, in mid-motion."""
    plant = plant_of(robot, num_envs=3)
    plant.configure(np.array([1]), joints=replace(JOINTS, damping=3.0), friction=FRICTIONLESS, mass_scale=1.7)
    plant.reset(np.array([1, 2]), np.array([[0.1, 0.2], [-0.4, 1.0]]))
    drive(plant, 200)
    return plant
