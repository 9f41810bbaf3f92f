"""A trained policy as a compensator."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import POSITIVE, choice, number, whole_number
from fo_gym.parameters import JointInfo
from fo_gym.scaling import ACTION_SHARES, scaled, torque_share
from fo_gym.signals import Signals
from fo_gym.wrappers.view import Frames

Array = NDArray[np.float64]

__all__ = ["AgentCompensator", "Policy"]


class Policy(Protocol):
    """What every model and policy of Stable-Baselines3 has."""

    def predict(
        self, observation: Any, state: Any = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Any, Any]:
        """Actions (num_envs, dof) in [-1, 1] for observations (num_envs, size), and the memory of a recurrent one."""


class AgentCompensator:
    """A policy that was trained through `AgentView`, to be scored: `fo_gym.evaluate(AgentCompensator(model), ...)`.

    It sees what `AgentView` showed it and acts at the rate at which it was trained; in between its action is held. Of
    one trained with `action_mode="torque"` the estimate is tau_f_hat = tau_c - tau_m, so that the motor gets tau_m,
    unless the two are further apart than the torque limit, to which estimates are clipped.

    Args:
        policy: such as a Stable-Baselines3 model, recurrent ones included.
        period: time between two actions [s]: decimation times control_dt in training.
        feedback: "measured" or "nominal", as in training.
        action_mode: "compensation" or "torque", likewise.
        stack, action_share: as of the AgentView in training.

    Raises:
        ValueError: an argument is not allowed.
    """

    learned = True

    def __init__(
        self,
        policy: Policy,
        period: float,
        *,
        feedback: str = "measured",
        action_mode: str = "compensation",
        stack: int = 1,
        action_share: float | None = None,
    ) -> None:
        choice("feedback", feedback, ("measured", "nominal"))
        choice("action_mode", action_mode, ACTION_SHARES)
        self.feedback = feedback
        self._policy = policy
        self._period = number("period", period, POSITIVE, "s")
        self._torque = action_mode == "torque"
        self._share = torque_share(action_mode, action_share)
        self._stack = whole_number("stack", stack, 1)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes.

        Raises:
            ValueError: the period is no whole number of control periods.
        """
        self._hold = joints.ticks("the policy acts", self._period)
        self._joints, self._tick = joints, 0
        self._frames, self._state = Frames(self._stack), None
        self._action, self._applied = np.zeros((2, num_envs, joints.dof))
        self._scale = self._share * joints.torque_limit

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        # What was applied is, as in training, the mean since the last action; at first, what has held the joints.
        self._applied = self._applied + signals.tau_m / (self._hold if self._tick else 1)
        if self._tick % self._hold == 0:
            self._act(replace(signals, tau_m=self._applied))
            self._applied = np.zeros_like(self._applied)
        self._tick += 1
        return signals.tau_c - self._action if self._torque else self._action

    def _act(self, signals: Signals) -> None:
        """Ask the policy for the action that is held from now on."""
        start = np.full(len(signals.theta), self._tick == 0)
        frame = scaled(signals, self._joints.motor_inertia, self._joints.torque_limit)
        seen = self._frames.see(frame, start)
        action, self._state = self._policy.predict(seen, self._state, start, deterministic=True)
        self._action = np.clip(np.asarray(action, dtype=np.float64), -1.0, 1.0) * self._scale
