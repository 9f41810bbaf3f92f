"""FJRInteraction-v0: a hand guides the tool of the 7-joint arm, and lets it go."""

from __future__ import annotations

from fo_gym.envs.single import JointEnv
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.tasks.interaction import interaction


class InteractionEnv(JointEnv):
    """A hand grips the tool of a 7-joint MIRO-like arm, guides it to and fro three times, and lets it go.

    The task's controller is an impedance that holds the tool at home, tau_c = J^T(theta_*) (-K_p e_x - K_d e_x') +
    g(q_bar(theta_*)), on tool position, tool orientation and the third joint's angle, with theta_* the measured or the
    nominal motor (`feedback`). Position is soft, K_p = 239 N/m and K_d = 155 N s/m: a quarter of the designed
    stiffness, as damped. What friction leaves the hand to do, and what the arm does once it is free, is what counts.

    The hand is a spring and a damper, 1000 N/m and 30 N s/m, between the tool and a point of its own. It grips the tool
    where that is at 1 s; its point goes 15 cm sideways, back, and there again, each stroke in 2 s, half of it at
    0.1 m/s; it rests for 0.5 s and lets go at 7.5 s, within 0.1 s, while the tool is away from home. It is passive: see
    `fo_gym.Hand`. No sensor shows it but the joints' own.

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

    `info` has, beside what every environment gives, f_hand, the force of the hand on the tool in the world, N, (3,),
    mean over the past step. tau_ext contains it as J^T f_hand.

    ## Reward

    closeness * (1 - 0.1 roughness). closeness = 1 / (1 + d / 2 mm), in (0, 1], d the distance of the tool from home.
    roughness is the mean over the joints of the change of tau_m since the previous step as a share of torque_limit, at
    most 1. It is always above 0, so that ending the episode never pays.

    ## Start and end

    At rest in the robot file's "home" (randomized: each joint within 0.02 rad of it). Randomized episodes have strokes
    of 0.7 to 1 times the length, 0.8 to 1.3 times as fast for it, anywhere between sideways and down; their hand is 0.5
    to 1 times as stiff, and as damped. The episode is truncated after 12 s, and terminated with `info["termination"]`
    = "joint_limit" when a link leaves its joint's range, or "non_finite".

    ## Arguments

    Those of `fo_gym.Settings`, and `render_mode` ("human" or "rgb_array"). `robot` takes any arm with a tool and three
    joints at least, six for the orientation; actions and observations then have its joints, limits and units, and the
    hand is fitted to it. `reset` takes the option "push".

    ## Version history

    * v0: first version.
    """

    robot = "miro_like"
    task = staticmethod(interaction)


class InteractionVectorEnv(JointVectorEnv):
    """`num_envs` copies of InteractionEnv in one batch."""

    robot = "miro_like"
    task = staticmethod(interaction)
