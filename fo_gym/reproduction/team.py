"""Several compensators on the same episode, in one batch: what each of them did."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.compensators import Compensator
from fo_gym.evaluation.competitors.team import Team, alike
from fo_gym.evaluation.episode.recorder import record
from fo_gym.evaluation.episode.recording import Recording

Array = NDArray[np.float64]

__all__ = ["Run", "run_team"]


@dataclass(frozen=True)
class Run:
    """One member's row of a recording."""

    recording: Recording
    row: int

    @property
    def time(self) -> Array:
        """Time of the ticks, (ticks,), s."""
        return np.asarray(self.recording.dt * np.arange(len(self.recording.ticks["theta"])))

    def tick(self, name: str, joint: int = 0) -> Array:
        """A tick array of the recording, (ticks,): theta, theta_n, theta_d, q, ..."""
        return self.recording.ticks[name][:, self.row, joint]

    def period(self, name: str, joint: int = 0) -> Array:
        """A period array of the recording, (periods,): tau_f_hat, tau_m, tau_f, tau_ext."""
        return self.recording.periods[name][:, self.row, joint]

    def parameter(self, name: str, joint: int = 0) -> float:
        """A field of the episode's FlexibleJoint or LuGre, such as "motor_inertia" or "f_s"."""
        scenario = self.recording.scenarios[self.row]
        owner = scenario.joints if hasattr(scenario.joints, name) else scenario.friction
        return float(np.broadcast_to(getattr(owner, name), scenario.q_start.shape)[joint])

    def tool(self, name: str = "tool") -> Array:
        """The tool's path, (ticks, 3), m; `reference` is where it should be."""
        return self.recording.ticks[name][:, self.row]


def run_team(
    members: Mapping[str, Compensator], env_id: str, *, variant: str = "nominal", seed: int = 0, **env_kwargs: Any
) -> dict[str, Run]:
    """Run every member on the same episode; members that are alike are batched, which changes no result.

    Raises:
        RuntimeError: an episode ended early.
    """
    runs: dict[str, Run] = {}
    for names in alike(members):
        team = Team([members[name] for name in names])
        recording = record(team, "team", env_id, variant, [seed] * len(names), env_kwargs)
        if any(recording.terminations):
            raise RuntimeError(f"{env_id}: {dict(zip(names, recording.terminations, strict=True))} ended early")
        runs |= {name: Run(recording, row) for row, name in enumerate(names)}
    return {name: runs[name] for name in members}
