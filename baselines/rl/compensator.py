"""The learned compensator: an observer with a policy beside it, for any robot and any number of joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baselines.rl.design import Design
from baselines.rl.loop import PolicyLoop
from baselines.rl.network import Network
from baselines.rl.storage import POLICY, load_policy
from fo_gym import JointInfo, Signals

Array = NDArray[np.float64]

SHIPPED = Path(__file__).parent / "weights"
"""The folders of the trainings whose policies come with the package."""

__all__ = ["SHIPPED", "LearnedCompensator", "rl_direct", "rl_residual"]


class LearnedCompensator(PolicyLoop):
    """tau_f_hat of an observer and a policy; see `PolicyLoop` for its equations. One policy serves all joints.

    Args:
        design: observer, rate, bound.
        network: the policy.
    """

    learned = True

    def __init__(self, design: Design, network: Network) -> None:
        super().__init__(design)
        self.network = network

    @classmethod
    def load(cls, weights: str | Path) -> LearnedCompensator:
        """From a file NAME.safetensors with its card. Raises ValueError where they cannot be trusted or used."""
        return cls(*load_policy(Path(weights)))

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes. Raises ValueError where control_dt does not suit the observer or the policy."""
        super().reset(joints, num_envs)
        self._tick = 0

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        if self._tick % self.hold == 0:
            self.act(self.network(self.features(signals)), signals)
        self._tick += 1
        return super().estimate(signals)


def rl_residual(weights: str | Path = SHIPPED / "rl-residual" / POLICY) -> LearnedCompensator:
    """A policy added to the PID-type observer with the paper's high gains, trained on the randomized single link."""
    return LearnedCompensator.load(weights)


def rl_direct(weights: str | Path = SHIPPED / "rl-direct" / POLICY) -> LearnedCompensator:
    """A policy without an observer, trained on the randomized single link."""
    return LearnedCompensator.load(weights)
