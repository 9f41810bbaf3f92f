"""What the adaptive compensator believes of zero and inertia, tick by tick, and what is true."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from baselines.rl.adaptive import AdaptiveCompensator
from fo_gym import Signals

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Beliefs:
    """Of the episodes of a batch.

    Attributes:
        dt: control period [s].
        unit: of the zero, N or N m.
        believed: (control periods, num_envs, dof) by name: zero [N | N m], and inertia, the error of B as
            a share of it.
        true: likewise, (num_envs, dof).
    """

    dt: float
    unit: str
    believed: dict[str, Array]
    true: dict[str, Array]


def beliefs(compensator: AdaptiveCompensator, env_id: str, seeds: Sequence[int], duration: float) -> Beliefs:
    """Let it compensate in the variant `hardware`, for `duration` [s]."""
    env: Any = gym.make_vec(env_id, len(seeds), variant="hardware", feedback="measured", duration=duration)
    obs, _ = env.reset(seed=list(seeds))
    simulation = env.unwrapped.simulation
    robot, dt = simulation.robot, simulation.joint_info.control_dt
    compensator.reset(simulation.joint_info, len(seeds))
    memory = simulation.get_state().hardware.memory
    inertia = np.array([np.broadcast_to(each.joints.motor_inertia, robot.dof) for each in simulation.scenarios])
    true = {"zero": memory[robot.hardware.sensors.torque.name]["zero"].copy()}
    true["inertia"] = 1.0 - inertia / simulation.joint_info.motor_inertia
    zeros, errors = [], []
    for _ in range(round(duration / dt) - 1):
        obs, *_ = env.step(compensator.estimate(Signals.from_observation(obs, robot.dof)))
        zeros.append(compensator.zero)
        errors.append(compensator.error)
    env.close()
    unit = "N" if robot.joint_unit == "m" else "N m"
    return Beliefs(dt, unit, {"zero": np.array(zeros), "inertia": np.array(errors)}, true)
