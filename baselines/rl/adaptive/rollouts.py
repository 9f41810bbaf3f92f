"""Episodes of the compensator as it is, with the truth about what is not friction beside them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baselines.rl.adaptive.compensator import AdaptiveCompensator
from baselines.rl.adaptive.course import Shares, training_batch
from baselines.rl.adaptive.rows import INERTIA, Block
from fo_gym import Signals

Array = NDArray[np.float64]

ROBOTS = 32
"""In a batch."""
BLOCKS = 890
"""Of an episode, as many as the shortest has."""

__all__ = ["BLOCKS", "ROBOTS", "rollout"]


class Noting(AdaptiveCompensator):
    """The compensator, which keeps its blocks."""

    def reset(self, joints: Any, num_envs: int) -> None:
        """See AdaptiveCompensator."""
        super().reset(joints, num_envs)
        self.blocks: list[Block] = []

    def _end_block(self, signals: Signals) -> None:
        super()._end_block(signals)
        self.blocks.append(self._block)

    @property
    def scales(self) -> tuple[Array, Array, Array]:
        """Of its rows."""
        return self._scales.inertia, self._scales.friction, self._scales.zero


def rollout(
    compensator: Noting, seeds: tuple[int, ...], first: int, shares: Shares
) -> Mapping[str, NDArray[np.float32]]:
    """One batch of episodes, joints apart; those that left their range are left out.

    Args:
        compensator: who compensates.
        seeds: of what is drawn for the batch.
        first: seed of the first episode.
        shares: of what may be drawn.

    Returns:
        blocks: (joints, BLOCKS, 4), fields of `Block`; scales: (joints, 3); truth: (joints, 2), the true coefficients
        of zero and inertia in the units of a row.
    """
    with TemporaryDirectory() as folder:
        env = training_batch(np.random.default_rng(seeds), Path(folder), ROBOTS, shares)
    obs, _ = env.reset(seed=first)
    inner: Any = env.unwrapped
    simulation = inner.simulation
    compensator.reset(simulation.joint_info, ROBOTS)
    zero, inertia = _truth(simulation)
    whole = np.ones(ROBOTS, dtype=bool)
    for _ in range(simulation.last_tick - 1):
        obs, _, ended, _, _ = env.step(compensator.estimate(Signals.from_observation(obs, simulation.dof)))
        whole &= ~ended
    believed, friction, unit = compensator.scales
    blocks = np.stack([np.stack(block, axis=-1) for block in compensator.blocks[:BLOCKS]], axis=2)
    truth = np.stack([zero / unit, (1.0 - inertia / believed) / INERTIA], axis=-1)
    parts = {"blocks": blocks, "scales": np.stack([believed, friction, unit], axis=-1), "truth": truth}
    env.close()
    return {name: np.concatenate(list(part[whole])).astype(np.float32) for name, part in parts.items()}


def _truth(simulation: Any) -> tuple[Array, Array]:
    """The zero of the torque sensor [N | N m] and B, (num_envs, dof) each, at the start of the episodes."""
    inertia = np.array([scenario.joints.motor_inertia for scenario in simulation.scenarios])
    inertia = np.broadcast_to(inertia.reshape(simulation.num_envs, -1), (simulation.num_envs, simulation.dof))
    hardware = simulation.robot.hardware
    if hardware is None or hardware.sensors.torque is None:
        return np.zeros(inertia.shape), inertia
    return simulation.get_state().hardware.memory[hardware.sensors.torque.name]["zero"], inertia
