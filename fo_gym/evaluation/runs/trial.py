"""A trial: one competitor on one set of episodes, the unit that is run, kept and run again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from fo_gym.compensators import Bound, Compensator, Ideal, NoCompensation
from fo_gym.evaluation.competitors.competitor import REFERENCE, Competitor
from fo_gym.evaluation.competitors.team import Team, alike
from fo_gym.evaluation.episode.recording import Recording, References
from fo_gym.evaluation.episode.trace import Trace, traces_of
from fo_gym.evaluation.runs.bound import bound_of
from fo_gym.evaluation.runs.episodes import FAILED, EpisodeSet, failed_rows, references_of, rows
from fo_gym.specs import BUILT_IN
from fo_gym.tasks.variants import NOMINAL

REFERENCES = tuple(Competitor(name, name, REFERENCE) for name in BUILT_IN)
"""Who meets every set of episodes, in this order."""

_MEMORY, _ARRAYS = 2**31, 14
"""What the recording of a batch may take, about [bytes], and of how many arrays of all joints it consists."""

__all__ = [
    "REFERENCES",
    "Trial",
    "competitor_trial",
    "failed_trial",
    "fitting",
    "reference_trials",
    "trials_together",
]


@dataclass(frozen=True)
class Trial:
    """What a competitor did on a set of episodes.

    Attributes:
        rows: one per episode, as `rows` gives them.
        timing: median and 99th percentile of the time per call of `estimate`, for the whole batch; None if it failed.
        traces: the first nominal episode, thinned; of other variants the worst, the median and the best, where asked
            for.
    """

    rows: pd.DataFrame
    timing: Mapping[str, Any] | None
    traces: tuple[Trace, ...]

    @property
    def failed(self) -> bool:
        """Whether the competitor could not be run."""
        return bool((self.rows["status"] == FAILED).any())

    def labelled(self, episodes: EpisodeSet, competitor: Competitor, protocol: str) -> Trial:
        """The same with the names that this run gives it: a trial out of the store may have had others."""
        name = competitor.name
        content = competitor.hash_on(episodes.env_id, episodes.variant)
        reference = bool((self.rows["origin"] == REFERENCE).all())  # as who is privileged says of itself
        origin = REFERENCE if reference else competitor.origin
        return Trial(
            self.rows.assign(compensator=name, origin=origin, competitor_hash=content, protocol=protocol),
            None if self.timing is None else {**self.timing, "compensator": name},
            tuple(replace(trace, compensator=name) for trace in self.traces),
        )


def _timing(episodes: EpisodeSet, name: str, recording: Recording) -> dict[str, Any]:
    median, p99 = np.percentile(recording.seconds, [50, 99]) * 1e6
    return {
        "env": episodes.env_id,
        "robot": episodes.robot.name,
        "variant": episodes.variant,
        "compensator": name,
        "num_envs": len(episodes.seeds),
        "estimate_median_us": round(float(median), 2),
        "estimate_p99_us": round(float(p99), 2),
    }


def _trial(
    episodes: EpisodeSet, name: str, recording: Recording, references: References, compensator: Compensator
) -> Trial:
    scores = rows(episodes, name, recording, references, compensator)
    shown = scores[:1] if episodes.variant == NOMINAL else scores if episodes.traced else scores[:0]
    traces = traces_of(name, shown, recording, references)
    return Trial(scores, _timing(episodes, name, recording), traces)


def reference_trials(episodes: EpisodeSet) -> tuple[References, list[Trial]]:
    """What all scores of a set are relative to, then the trials of `REFERENCES`."""
    none, ideal = references_of(episodes)
    references = References(ideal.motions, none.motions)
    runs: list[tuple[Recording, Compensator]] = [(none, NoCompensation()), (ideal, Ideal())]
    runs.append((bound_of(episodes, references), Bound()))
    trials = [
        _trial(episodes, each.name, recording, references, compensator)
        for each, (recording, compensator) in zip(REFERENCES, runs, strict=True)
    ]
    return references, trials


def competitor_trial(episodes: EpisodeSet, competitor: Competitor, references: References) -> Trial:
    """One competitor on one set of episodes. Whatever goes wrong in it becomes its failed rows."""
    try:
        with competitor.playing(episodes.env_id, episodes.variant) as compensator:
            recording = episodes.record(compensator, competitor.name)
    except (Exception, SystemExit) as error:
        return failed_trial(episodes, competitor, f"{type(error).__name__}: {error}")
    return _trial(episodes, competitor.name, recording, references, compensator)


def trials_together(episodes: EpisodeSet, competitors: Sequence[Competitor], references: References) -> list[Trial]:
    """The trials of several competitors, in their order: as `competitor_trial` gives them, in as few batches as fit.

    Where something goes wrong in a batch, its members run one by one, which tells whose fault it is. Those that have
    processes of their own do so in any case.
    """
    if len(competitors) == 1:
        return [competitor_trial(episodes, competitors[0], references)]
    made: dict[int, Compensator] = {}
    for place, competitor in enumerate(competitors):
        if not competitor.guarded:
            with suppress(Exception, SystemExit):
                made[place] = competitor.make(episodes.env_id, episodes.variant)
    trials: dict[int, Trial] = {}
    size = fitting(*references.none.theta.shape)
    for places in (group[start : start + size] for group in alike(made) for start in range(0, len(group), size)):
        team = Team([made[place] for place in places], len(episodes.seeds))
        with suppress(Exception, SystemExit):
            recording = replace(episodes, seeds=episodes.seeds * len(places)).record(team, "team")
            for member, place in enumerate(places):
                own = replace(recording.part(team.rows(member)), seconds=np.array(team.seconds[member]))
                trials[place] = _trial(episodes, competitors[place].name, own, references, made[place])
    alone = (place for place in range(len(competitors)) if place not in trials)
    trials |= {place: competitor_trial(episodes, competitors[place], references) for place in alone}
    return [trials[place] for place in range(len(competitors))]


def fitting(ticks: int, num_envs: int, dof: int) -> int:
    """How many competitors with so many environments each fit into a batch of so many ticks."""
    return max(1, _MEMORY // (8 * _ARRAYS * ticks * num_envs * dof))


def failed_trial(episodes: EpisodeSet, competitor: Competitor, error: str) -> Trial:
    """The trial of a competitor that could not be run: no scores, and why."""
    return Trial(failed_rows(episodes, competitor.name, error), None, ())
