"""FJRStiction-v0: the paper's single link, a step of one centimetre into stiction."""

from __future__ import annotations

import numpy as np

from envs_assets import asset_path
from fo_gym.envs.single import JointEnv
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.hardware import (
    CommandDelay,
    GearRipple,
    Hardware,
    LinkFriction,
    LoadFriction,
    ModelError,
    MotorEncoder,
    PushTime,
    SensorModel,
    Temperature,
    TorqueSaturation,
    TorqueSensor,
)
from fo_gym.parameters import FlexibleJoint, LuGre, PDGains
from fo_gym.plant import Robot
from fo_gym.tasks.scenario import Push
from fo_gym.tasks.task import Randomization, Task

# Parameters of arXiv:1907.00553, section V; the torque limit, the randomized ranges and the hardware are ours. A
# robot's joint turns about ten times as far as this link moves, so its hardware is the arm's, divided by ten.
STICTION = Task(
    robot=Robot(asset_path("single_link"), joints=("joint",), camera="view"),
    joint_unit="m",
    joints=FlexibleJoint(stiffness=3000.0, damping=0.0, motor_inertia=1.0, torque_limit=10.0),
    friction=LuGre(sigma_0=1e5, sigma_1=float(np.sqrt(1e5)), sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=0.001),
    gains=PDGains(kp=50.0, kd=5.0),
    duration=20.0,
    accuracy=1e-3,
    q_start=np.zeros(1),
    step=np.array([0.01]),
    step_time=0.0,
    path=None,
    push=None,
    random_push=Push(time=0.0, duration=0.5, torque=np.array([1.5])),
    limit_cycle_window=(10.0, 20.0),
    randomization=Randomization(start=0.002, push_time=(5.0, 8.0)),
    hardware=Hardware(
        sensors=SensorModel(
            MotorEncoder(resolution=1e-7, cutoff=2.0 * np.pi * 150.0),
            TorqueSensor(noise=0.005, offset=0.02, cutoff=2.0 * np.pi * 200.0),
        ),
        delay=CommandDelay(1e-3),
        saturation=TorqueSaturation(),
        link_friction=LinkFriction(coulomb=0.05, viscous=0.1, width=1e-3),
        ripple=GearRipple(amplitude=0.05, period=2e-3),
        load=LoadFriction(0.063),
        temperature=Temperature(),
        model_error=ModelError(),
        push_time=PushTime((4.0, 9.0)),
    ),
)


class StictionEnv(JointEnv):
    """A motor of 1 kg and a link of 1 kg, joined by a spring, on a rail: a step of 10 mm against stiction.

    The task's controller is motor PD, tau_c = -K_p (theta_* - theta_d) - K_d theta_*', with theta_* the measured or
    the nominal motor (`feedback`). What is missing is the friction torque, which the agent estimates. Uncompensated,
    the motor does not move at all; an integrating estimate hunts; one without integral stops off the target.

    ## Action

    | Num | Meaning                         | Min | Max | Joint (MJCF) | Unit |
    |-----|---------------------------------|-----|-----|--------------|------|
    | 0   | tau_f_hat, friction estimate    | -10 | 10  | joint        | N    |

    The motor gets tau_m = tau_c - tau_f_hat. With `action_mode="torque"` the action is tau_m itself. The bounds are
    -+torque_limit; what lies outside is clipped.

    ## Observation

    | Num | Meaning                                             | Min  | Max | Joint (MJCF) | Unit |
    |-----|-----------------------------------------------------|------|-----|--------------|------|
    | 0   | theta, motor position                               | -Inf | Inf | joint        | m    |
    | 1   | theta_dot, motor velocity                           | -Inf | Inf | joint        | m/s  |
    | 2   | tau_j, measured joint torque                        | -Inf | Inf | joint        | N    |
    | 3   | theta_n, nominal motor position                     | -Inf | Inf | joint        | m    |
    | 4   | theta_n_dot, nominal motor velocity                 | -Inf | Inf | joint        | m/s  |
    | 5   | theta_d, desired motor position                     | -Inf | Inf | joint        | m    |
    | 6   | tau_c, control torque of the coming step            | -Inf | Inf | joint        | N    |
    | 7   | tau_m, motor torque applied in the past step        | -Inf | Inf | joint        | N    |
    | 8   | time since the start                                | -Inf | Inf |              | s    |

    ## Reward

    closeness * (1 - 0.1 roughness). closeness = 1 / (1 + |theta - theta_d| / 1 mm), in (0, 1]. roughness is the change
    of tau_m since the previous step as a share of torque_limit, at most 1. It is best at the target, at rest, and
    always above 0, so that ending the episode never pays.

    ## Start and end

    Link and motor rest at 0 (randomized: within 2 mm of it). The episode is truncated after 20 s, and terminated with
    `info["termination"]` = "joint_limit" when the link leaves the rail, or "non_finite".

    ## Arguments

    Those of `fo_gym.Settings`, and `render_mode` ("human" or "rgb_array"). `reset` takes the options "target" and
    "push".

    ## Version history

    * v0: first version.
    """

    task = STICTION


class StictionVectorEnv(JointVectorEnv):
    """`num_envs` copies of StictionEnv in one batch."""

    task = STICTION
