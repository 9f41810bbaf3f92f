"""Learn the table: friction against speed, from what a joint measures, on training seeds of the single link.

python examples/plugin_compensator/learn.py

The motor's own equation, B theta'' + tau_j = tau_m + tau_f, gives tau_f; the table holds its median in bins of speed.
"""

import gymnasium as gym
import numpy as np
from tabulated_friction import TABLE

import fo_gym

EPISODES = 32
BINS = 24
FASTEST = 0.05


def samples(observer: fo_gym.Compensator) -> tuple[np.ndarray, np.ndarray]:
    """Speed, and friction per motor inertia against the motion, at every tick of every joint."""
    envs = gym.make_vec("FJRStiction-v0", num_envs=EPISODES, variant="randomized", feedback=observer.feedback)
    joints = envs.unwrapped.joint_info
    obs, _ = envs.reset(seed=0)  # seeds 0, 1, 2, ...: small numbers are for training
    observer.reset(joints, EPISODES)
    speeds, frictions, done = [], [], np.zeros(EPISODES, dtype=bool)
    while not done.any():
        now = fo_gym.Signals.from_observation(obs, joints.dof)
        action = observer.estimate(now)
        obs, _, terminated, truncated, _ = envs.step(action)
        done = terminated | truncated
        after = fo_gym.Signals.from_observation(obs, joints.dof)
        acceleration = (after.theta_dot - now.theta_dot) / joints.control_dt
        tau_f = joints.motor_inertia * acceleration + now.tau_j - (now.tau_c - action)
        speed = (after.theta_dot + now.theta_dot) / 2
        speeds.append(np.abs(speed).ravel())
        frictions.append((-tau_f * np.sign(speed) / joints.motor_inertia).ravel())
    return np.concatenate(speeds), np.concatenate(frictions)


def main() -> None:
    """Write the table beside the compensator."""
    speed, friction = samples(fo_gym.make_compensator("pd-high"))
    edges = np.geomspace(1e-3, FASTEST, BINS + 1)
    bins = np.digitize(speed, edges)
    middle = np.sqrt(edges[1:] * edges[:-1])
    table = [np.median(friction[bins == i + 1]) for i in range(BINS)]
    np.savez(TABLE, speed=np.array([0.0, *middle]), friction=np.array([0.0, *table]))
    print(f"wrote {TABLE}: friction per inertia from {min(table):.3f} to {max(table):.3f}")


if __name__ == "__main__":
    main()
