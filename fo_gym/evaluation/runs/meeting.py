"""Before a competitor runs for minutes: does it run at all?"""

from __future__ import annotations

from dataclasses import replace

from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.runs.episodes import EpisodeSet

_DURATION = 0.05
"""How long the first meeting lasts, s of simulated time."""

__all__ = ["meet"]


def meet(competitor: Competitor, episodes: EpisodeSet) -> None:
    """Make a competitor and run it on the first moments of one of the episodes.

    Raises:
        ValueError, TypeError: it cannot be made, see `make_compensator`.
        CompensatorError: it raised, or returned what is not a finite (num_envs, dof) array.
    """
    beginning = replace(episodes, seeds=episodes.seeds[:1], env_kwargs={**episodes.env_kwargs, "duration": _DURATION})
    with competitor.playing(episodes.env_id, episodes.variant) as compensator:
        beginning.record(compensator, competitor.name)
