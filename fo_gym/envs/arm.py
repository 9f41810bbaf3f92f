"""The MIRO-like arm as both arm tasks use it: robot, joints and friction."""

from __future__ import annotations

import numpy as np

from envs_assets import asset_path
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
from fo_gym.parameters import FlexibleJoint, LuGre
from fo_gym.plant import Robot
from fo_gym.plant.robot import home_pose

ARM = Robot(
    asset_path("miro_like"),
    joints=("joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7"),
    tool="tool",
    camera="view",
)

# B about 1 kg m^2 at joint 2 is the paper's. Stiffness is within what is published for arms of this size
# (3500-8000 N m/rad); its fall towards the wrist, and the torque limits, are ours.
ARM_JOINTS = FlexibleJoint(
    stiffness=np.array([6000.0, 6000.0, 5000.0, 5000.0, 3000.0, 3000.0, 3000.0]),
    damping=0.0,
    motor_inertia=np.array([1.2, 1.2, 1.2, 1.2, 0.6, 0.6, 0.6]),
    torque_limit=np.array([150.0, 150.0, 100.0, 100.0, 50.0, 40.0, 40.0]),
)

# Coulomb friction and stiction of 2-6 N m, viscous friction of about 5 N m s/rad and a Stribeck velocity of
# 0.01 rad/s give the paper's pattern; all values are ours. The bristles yield by 0.1 mrad before they slip.
_F_C = np.array([4.0, 4.0, 4.0, 4.0, 3.0, 3.0, 3.0])
_SIGMA_0 = _F_C / 1e-4
ARM_FRICTION = LuGre(
    sigma_0=_SIGMA_0,
    sigma_1=np.sqrt(_SIGMA_0 * ARM_JOINTS.motor_inertia),
    sigma_2=5.0,
    f_c=_F_C,
    f_s=1.5 * _F_C,
    v_s=0.01,
)

# A 16-bit encoder on the motor behind a gear of 100:1, noise and offset of the torque sensor within 2 % of the range
# of the smallest joint, a tenth of the motor's friction on the link, and 2 ripples per turn of the motor.
ARM_HARDWARE = Hardware(
    sensors=SensorModel(
        MotorEncoder(resolution=1e-6, cutoff=2.0 * np.pi * 150.0),
        TorqueSensor(noise=0.05, offset=0.2, cutoff=2.0 * np.pi * 200.0),
    ),
    delay=CommandDelay(1e-3),
    saturation=TorqueSaturation(),
    link_friction=LinkFriction(coulomb=0.3, viscous=0.3, width=0.01),
    ripple=GearRipple(amplitude=0.2, period=2.0 * np.pi / 200.0),
    load=LoadFriction(0.063),
    temperature=Temperature(),
    model_error=ModelError(),
)

ARM_HOME = home_pose(ARM)
"""Start pose of both tasks [rad]: the keyframe "home" of the robot file."""
