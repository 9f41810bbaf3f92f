"""FJRSquare-v0: the 7-joint arm draws a square under task-space impedance."""

from __future__ import annotations

from fo_gym.envs.single import JointEnv
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.tasks.square import square


class SquareEnv(JointEnv):
    """A 7-joint MIRO-like arm draws a square of 15 cm in 5 s with its tool, then holds.

    The task's controller is an impedance, tau_c = J^T(theta_*) (-K_p e_x - K_d e_x') + g(q_bar(theta_*)), on tool
    position, tool orientation and the third joint's angle, with theta_* the measured or the nominal motor
    (`feedback`). Each side of the square is smooth up to acceleration; at the corners joints reverse, which is where
    friction shows.

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

    | Num   | Meaning                                   | Min  | Max | Element (MJCF)  | Unit  |
    |-------|-------------------------------------------|------|-----|-----------------|-------|
    | 0-6   | theta, motor positions                    | -Inf | Inf | joint1...joint7 | rad   |
    | 7-13  | theta_dot, motor velocities               | -Inf | Inf | joint1...joint7 | rad/s |
    | 14-20 | tau_j, measured joint torques             | -Inf | Inf | joint1...joint7 | N m   |
    | 21-27 | theta_n, nominal motor positions          | -Inf | Inf | joint1...joint7 | rad   |
    | 28-34 | theta_n_dot, nominal motor velocities     | -Inf | Inf | joint1...joint7 | rad/s |
    | 35-41 | theta_d, desired motor positions          | -Inf | Inf | joint1...joint7 | rad   |
    | 42-48 | tau_c, control torques of the coming step | -Inf | Inf | joint1...joint7 | N m   |
    | 49-55 | tau_m, motor torques of the past step     | -Inf | Inf | joint1...joint7 | N m   |
    | 56    | time since the start                      | -Inf | Inf |                 | s     |
    | 57-59 | reference, desired tool position, world   | -Inf | Inf | tool            | m     |

    ## Reward

    closeness * (1 - 0.1 roughness). closeness = 1 / (1 + d / 2 mm), in (0, 1], d the distance of the tool from its
    reference. roughness is the mean over the joints of the change of tau_m since the previous step as a share of
    torque_limit, at most 1. It is always above 0, so that ending the episode never pays.

    ## Start and end

    At rest in the robot file's "home", a corner of the square (randomized: each joint within 0.02 rad of it). The
    episode is truncated after 8 s, and terminated with `info["termination"]` = "joint_limit" when a link leaves its
    joint's range, or "non_finite".

    ## Arguments

    Those of `fo_gym.Settings`, and `render_mode` ("human" or "rgb_array"). `robot` takes any arm with a tool and three
    joints at least, six for the orientation; actions and observations then have its joints, limits and units, and side
    and plane of the square are fitted to it. `reset` takes the option "push".

    ## Version history

    * v0: first version.
    """

    robot = "miro_like"
    task = staticmethod(square)


class SquareVectorEnv(JointVectorEnv):
    """`num_envs` copies of SquareEnv in one batch."""

    robot = "miro_like"
    task = staticmethod(square)
