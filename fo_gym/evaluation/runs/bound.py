"""The reference `bound` on a set of episodes: the best of a few lags."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fo_gym.compensators import BOUND_RATES, Bound
from fo_gym.evaluation.competitors.team import Team
from fo_gym.evaluation.episode.recording import Recording, References
from fo_gym.evaluation.metrics.rejection import friction_rejection_ratio
from fo_gym.evaluation.runs.episodes import EpisodeSet

__all__ = ["bound_of"]


def bound_of(episodes: EpisodeSet, references: References) -> Recording:
    """What `bound` does with the lag that is best on average over these episodes, by FRR; of equals the first.

    Args:
        episodes: what is met.
        references: that the scores are relative to.
    """
    team = Team([Bound(rate) for rate in BOUND_RATES], len(episodes.seeds))
    together = replace(episodes, seeds=episodes.seeds * len(BOUND_RATES)).record(team, "bound")
    runs = [together.part(team.rows(place)) for place in range(len(BOUND_RATES))]
    return max(runs, key=lambda run: _mean_frr(run, references))


def _mean_frr(recording: Recording, references: References) -> float:
    """Over the episodes to which it applies; 0 where there is none."""
    count = len(recording.ended)
    scores = np.array([friction_rejection_ratio(recording.episode(i, references)) for i in range(count)])
    return float(np.mean(scores[np.isfinite(scores)])) if np.isfinite(scores).any() else 0.0
