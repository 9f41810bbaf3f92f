"""Energy from nowhere: long random episodes of the environments, with an account of every joule.

    python tests/energy_search.py 1e9        # joint micro-steps, shared among the cases of CASES

What motors and world put into a plant, tau_m (theta - theta_before) + tau_ext (q - q_before) in a control period with
torques held, is exact. Links, springs, motors and bristles may store no more than that, ever: stored less put in may
only fall. The largest rise above its lowest value so far is reported as a share of the energy turned over. Left to the
method is its own swing, (h omega)^2 / 8 of the spring's energy, and on the arms the inertia held for a control period.

Torques go up to half of the limits, so that the arms come to poses that no task has, with the wrist's axes aligned.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import fo_gym
from fo_gym.robots import robot_of
from fo_gym.simulation.settings import Settings
from fo_gym.simulation.simulation import Simulation
from fo_gym.tasks.regulation import regulation
from fo_gym.tasks.square import square
from fo_gym.tasks.stiction import stiction
from fo_gym.tasks.task import TaskLike

UNDAMPED = {"friction": replace(robot_of("single_link").friction, sigma_1=0.0), "physics_dt": "auto"}
"""A bristle without damping: the default step cannot follow it."""

CASES: dict[str, tuple[str, TaskLike, dict[str, Any]]] = {
    f"{name}-{variant}{'-undamped' if more else ''}": (robot, task, {"variant": variant, **more})
    for name, robot, task, undamped in (
        ("stiction", "single_link", stiction, UNDAMPED),
        (
            "regulation",
            "miro_like",
            regulation,
            UNDAMPED | {"friction": replace(robot_of("miro_like").friction, sigma_1=0.0)},
        ),
        ("square", "miro_like", square, None),
    )
    for variant in ("randomized", "hardware")
    for more in ({}, undamped)
    if more is not None
}

JOINTS = 1024  # in a batch
EVERY = 10  # control periods between two looks at the account


@dataclass
class Result:
    """What a search found: joint micro-steps taken, largest rise as a share of the energy turned over, episodes."""

    micro_steps: int
    rise: float
    finite: bool
    episodes: int


class Account:
    """Energy of every environment of a plant since its last reset; sits between a simulation and its plant."""

    def __init__(self, simulation: Simulation) -> None:
        self.plant = simulation.plant
        self._model, size = self.plant.body.model, simulation.num_envs
        (share,) = self.plant.body.shares
        self._position = share._batch.bind("xipos")
        self.put_in, self.turned_over, self.lowest = np.zeros(size), np.zeros(size), np.zeros(size)
        self._advance = self.plant.advance
        self.plant.advance = self.advance  # type: ignore[method-assign]

    def begin(self, ids: np.ndarray) -> None:
        """Environments that have just been reset."""
        self.put_in[ids] = 0.0
        self.lowest[ids] = self.stored()[ids]
        self.turned_over[ids] = 0.0

    def advance(self) -> None:
        """The plant's `advance`, with its torques' work."""
        q, theta = self.plant.q.copy(), self.plant.theta.copy()
        self._advance()
        tau_m, tau_ext = self.plant.tau_m + self.plant.motor_torque, self.plant.tau_ext
        work = np.concatenate([tau_m * (self.plant.theta - theta), tau_ext * (self.plant.q - q)], axis=1)
        self.put_in += work.sum(axis=1)
        self.turned_over += np.abs(work).sum(axis=1)

    def stored(self) -> np.ndarray:
        """Energy of links, springs, motors and bristles, (num_envs,) [J]."""
        plant = self.plant
        inertia = plant.body.dense_inertia(plant.q)
        weight = self._model.body_mass * plant.body.mass_scale[:, None]
        bristles = plant._friction["sigma_0"] * plant.z**2
        joints = plant.stiffness * (plant.theta - plant.q) ** 2 + plant.motor_inertia * plant.theta_dot**2 + bristles
        links = np.einsum("ni,nij,nj->n", plant.q_dot, inertia, plant.q_dot)
        height = self._position.reshape(len(weight), -1, 3) @ self._model.opt.gravity
        return 0.5 * (links + joints.sum(axis=1)) - (weight * height).sum(axis=1)

    def rise(self) -> np.ndarray:
        """How far stored less put in lies above its lowest so far, as a share of what was turned over, (num_envs,)."""
        balance = self.stored() - self.put_in
        self.lowest = np.minimum(self.lowest, balance)
        return (balance - self.lowest) / (self.turned_over + 1e-3)


def search(case: str, micro_steps: float, joints: int = JOINTS, seed: int = 0) -> Result:
    """Episodes of a case under random waves of torque until so many joint micro-steps are taken."""
    robot, task, arguments = CASES[case]
    num_envs = joints // robot_of(robot).dof
    simulation = Simulation(robot, task, num_envs, Settings(action_mode="torque", **arguments))
    rng, everyone, dof = np.random.default_rng(seed), np.arange(num_envs), simulation.dof
    account, limit = Account(simulation), np.asarray(simulation.torque_limit)
    size, rate, phase, holding = (np.zeros((num_envs, dof)) for _ in range(4))

    def begin(ids: np.ndarray) -> None:
        simulation.reset(ids, [np.random.default_rng(each) for each in rng.integers(0, 2**32, len(ids))])
        size[ids] = limit * 10.0 ** rng.uniform(-2.0, -0.3, (len(ids), dof))
        rate[ids] = 10.0 ** rng.uniform(0.0, 2.0, (len(ids), dof)) * simulation.settings.control_dt
        phase[ids] = rng.uniform(0.0, 2.0 * np.pi, (len(ids), dof))
        holding[ids] = simulation.plant.tau_j[ids]
        account.begin(ids)

    begin(everyone)
    result, per_tick = Result(0, 0.0, True, num_envs), num_envs * dof * simulation.plant.steps
    while result.micro_steps < micro_steps:
        for _ in range(EVERY):
            action = holding + size * np.sin(rate * simulation.ticks[:, None] + phase)
            _, terminated, truncated, reasons = simulation.step(action)
            result.micro_steps += per_tick
            result.finite &= "non_finite" not in reasons.values()
            over = np.flatnonzero(terminated | truncated)
            if len(over):
                result.rise = max(result.rise, float(account.rise().max()))
                begin(over)
                result.episodes += len(over)
        result.rise = max(result.rise, float(account.rise().max()))
    return result


def main(micro_steps: float) -> None:
    """Search every case and print what was found."""
    total = 0
    for case in CASES:
        found = search(case, micro_steps / len(CASES))
        total += found.micro_steps
        print(
            f"{case:30} {found.micro_steps:14,} joint micro-steps, {found.episodes:7,} episodes, "
            f"finite: {found.finite}, largest rise {found.rise:.1e} of the energy turned over",
            flush=True,
        )
    print(f"{'in all':30} {total:14,} joint micro-steps, fo-gym {fo_gym.__version__}")


if __name__ == "__main__":
    main(float(sys.argv[1]))
