"""FJRStiction-v0: the paper's single link, a step of one centimetre into stiction."""

from __future__ import annotations

from fo_gym.envs.single import JointEnv
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.tasks.stiction import stiction


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

    Those of `fo_gym.Settings`, and `render_mode` ("human" or "rgb_array"). `robot` takes any single slide. `reset`
    takes the options "target" and "push".

    ## Version history

    * v0: first version.
    """

    robot = "single_link"
    task = staticmethod(stiction)


class StictionVectorEnv(JointVectorEnv):
    """`num_envs` copies of StictionEnv in one batch."""

    robot = "single_link"
    task = staticmethod(stiction)
