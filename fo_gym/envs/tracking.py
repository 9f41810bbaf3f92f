"""FJRTracking-v0: the 7-joint arm swings all its joints, each on a sinusoid of its own."""

from __future__ import annotations

from fo_gym.envs.single import JointEnv
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.tasks.tracking import tracking


class TrackingEnv(JointEnv):
    """A 7-joint MIRO-like arm swings about its home for 10 s, every joint on a sinusoid of its own, then holds.

    q_d = home + s(t) A sin(2 pi f t + phase), with A = 0.3 rad (0.24 rad at joint 4) and f from 0.15 Hz at joint 1 to
    0.3 Hz at joint 7; s(t) swells from 0 to 1 in 2 s, and dies away in the last 2 s. Phases are a golden angle apart:
    joints seldom reverse together, and reversals are where friction shows.

    The task's controller is motor PD with gravity at the desired pose, tau_c = -K_p (theta_* - theta_d) -
    K_d theta_*' + g(q_d), with theta_* the measured or the nominal motor (`feedback`). It knows no desired velocity:
    without friction, too, joints lag, by up to 0.09 rad (RMS). What a compensator is to give back is that motion.

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

    At rest in the robot file's "home" (randomized: each joint within 0.02 rad of it). Nothing pushes the nominal arm;
    randomized episodes have a sin^2 pulse of 0.5 s, of 5 to 15 N m either way at joint 2, at 5 to 6 s (hardware: 3 to
    8 s). The episode is truncated after 12 s, and terminated with `info["termination"]` = "joint_limit" when a link
    leaves its joint's range, or "non_finite".

    ## Arguments

    Those of `fo_gym.Settings`, and `render_mode` ("human" or "rgb_array"). `robot` takes any arm that can swing about
    its home; actions and observations then have its joints, limits and units, and the swing is fitted to it. `reset`
    takes the option "push".

    ## Version history

    * v0: first version.
    """

    robot = "miro_like"
    task = staticmethod(tracking)


class TrackingVectorEnv(JointVectorEnv):
    """`num_envs` copies of TrackingEnv in one batch."""

    robot = "miro_like"
    task = staticmethod(tracking)
