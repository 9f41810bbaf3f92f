"""FJRRegulation-v0: the 7-joint arm holds, steps by -5 degrees and is pushed."""

from __future__ import annotations

from fo_gym.envs.single import JointEnv
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.tasks.regulation import regulation


class RegulationEnv(JointEnv):
    """A 7-joint MIRO-like arm holds its pose, steps by -5 degrees on every joint at 3 s, and is pushed at 13 s.

    The task's controller is motor PD with gravity at the desired pose, tau_c = -K_p (theta_* - theta_d) -
    K_d theta_*' + g(q_d), with theta_* the measured or the nominal motor (`feedback`). The joints are under-damped
    without friction, and what friction the estimate leaves decides where they come to rest, and whether they do.

    ## Action

    | Num | Meaning                         | Min  | Max | Joint (MJCF) | Unit |
    |-----|---------------------------------|------|-----|--------------|------|
    | 0   | tau_f_hat, friction estimate    | -150 | 150 | joint1       | N m  |
    | 1   | tau_f_hat, friction estimate    | -150 | 150 | joint2       | N m  |
    | 2   | tau_f_hat, friction estimate    | -100 | 100 | joint3       | N m  |
    | 3   | tau_f_hat, friction estimate    | -100 | 100 | joint4       | N m  |
    | 4   | tau_f_hat, friction estimate    | -50  | 50  | joint5       | N m  |
    | 5   | tau_f_hat, friction estimate    | -40  | 40  | joint6       | N m  |
    | 6   | tau_f_hat, friction estimate    | -40  | 40  | joint7       | N m  |

    The motors get tau_m = tau_c - tau_f_hat. With `action_mode="torque"` the action is tau_m itself. The bounds are
    -+torque_limit; what lies outside is clipped.

    ## Observation

    | Num   | Meaning                                  | Min  | Max | Joints (MJCF)   | Unit  |
    |-------|------------------------------------------|------|-----|-----------------|-------|
    | 0-6   | theta, motor positions                   | -Inf | Inf | joint1...joint7 | rad   |
    | 7-13  | theta_dot, motor velocities              | -Inf | Inf | joint1...joint7 | rad/s |
    | 14-20 | tau_j, measured joint torques            | -Inf | Inf | joint1...joint7 | N m   |
    | 21-27 | theta_n, nominal motor positions         | -Inf | Inf | joint1...joint7 | rad   |
    | 28-34 | theta_n_dot, nominal motor velocities    | -Inf | Inf | joint1...joint7 | rad/s |
    | 35-41 | theta_d, desired motor positions         | -Inf | Inf | joint1...joint7 | rad   |
    | 42-48 | tau_c, control torques of the coming step | -Inf | Inf | joint1...joint7 | N m   |
    | 49-55 | tau_m, motor torques of the past step    | -Inf | Inf | joint1...joint7 | N m   |
    | 56    | time since the start                     | -Inf | Inf |                 | s     |

    ## Reward

    closeness * (1 - 0.1 roughness). closeness = 1 / (1 + d / 5 mrad), in (0, 1], d the root mean square over the joints
    of theta - theta_d. roughness is the mean over the joints of the change of tau_m since the previous step as a share
    of torque_limit, at most 1. It is always above 0, so that ending the episode never pays.

    ## Start and end

    At rest in the robot file's "home" (randomized: each joint within 0.02 rad of it). The push is a sin^2 pulse of
    0.5 s with a peak of 10 N m at joint 2. The episode is truncated after 50 s, and terminated with
    `info["termination"]` = "joint_limit" when a link leaves its joint's range, or "non_finite".

    ## Arguments

    Those of `fo_gym.Settings`, and `render_mode` ("human" or "rgb_array"). `robot` takes any arm, also one whose joints
    slide; actions and observations then have its joints, limits and units, gains and push are fitted to it. `reset`
    takes the options "target" and "push".

    ## Version history

    * v0: first version.
    """

    robot = "miro_like"
    task = staticmethod(regulation)


class RegulationVectorEnv(JointVectorEnv):
    """`num_envs` copies of RegulationEnv in one batch."""

    robot = "miro_like"
    task = staticmethod(regulation)
