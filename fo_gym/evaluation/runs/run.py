"""Run a protocol: every competitor on every set of episodes, in parallel, one row per episode."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import pandas as pd

from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.episode.recording import References
from fo_gym.evaluation.runs.backends import Backend, BackendError, Processes
from fo_gym.evaluation.runs.contest import Contest, Results, contests_in
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.evaluation.runs.store import Store
from fo_gym.evaluation.runs.trial import REFERENCES, Trial, failed_trial, reference_trials, trials_together
from fo_gym.specs import BUILT_IN

OnRun = Callable[[str], None]
"""Called with a label after every run, the references counted as one."""

ENDED = "it ended the process that it ran in"
"""The error of a competitor that takes its process down, as a crash in compiled code does."""

_Crew = tuple[int, tuple[int, ...]]
"""The number of a contest, and the places of those who go to a worker together, where they share batches."""

_CREW = 160
"""Episodes of a crew, about: more of them gain little time, and are lost when the run is killed."""

__all__ = ["ENDED", "run_contests", "run_protocol"]


class _Runner:
    """The trials of some contests while they come in, by contest and place in it."""

    def __init__(self, contests: Sequence[Contest], store: Store | None, announce: OnRun) -> None:
        self.contests = contests
        self.store = store
        self.announce = announce
        self.trials: dict[tuple[int, int], Trial] = {}
        self.stored = 0

    def take_stored(self) -> None:
        """What need not be computed."""
        for number, contest in enumerate(self.contests):
            for place, competitor in enumerate(contest.everybody):
                trial = self.store.load(contest.episodes, competitor) if self.store else None
                if trial is not None:
                    self.trials[number, place] = trial
        for number, contest in enumerate(self.contests):
            # The rows of the references may be there, but if anybody else's are not, their motions are needed.
            references = () if self.missing(number) else (0,)
            competing = range(len(REFERENCES), len(contest.everybody))
            others = (place for place in competing if (number, place) in self.trials)
            for place in (*references, *others):
                self.stored += 1
                self._tell(number, place, ", from the store")

    def missing(self, number: int) -> list[int]:
        """Places of a contest whose trials are not there."""
        return [place for place in range(len(self.contests[number].everybody)) if (number, place) not in self.trials]

    def _tell(self, number: int, place: int, how: str = "") -> None:
        contest = self.contests[number]
        who = ", ".join(BUILT_IN) if place < len(REFERENCES) else contest.everybody[place].name
        self.announce(f"{contest.episodes.label}: {who}{how}")

    def _keep(self, number: int, place: int, trial: Trial) -> None:
        contest = self.contests[number]
        if (number, place) not in self.trials:
            self.trials[number, place] = trial
            if self.store:
                self.store.save(contest.episodes, contest.everybody[place], trial)

    def run_references(self, backend: Backend) -> dict[int, References]:
        """The references of every contest in which something is missing: the scores of all need them."""
        needed = [number for number in range(len(self.contests)) if self.missing(number)]
        found: dict[int, References] = {}
        for place, result in backend.run(reference_trials, [(self.contests[n].episodes,) for n in needed]):
            number = needed[place]
            if result is None:
                episodes = self.contests[number].episodes
                raise BackendError(
                    f"the process that ran the references of {episodes.env_id}, {episodes.variant} was killed each "
                    "time it was tried; is there enough memory? Use fewer --jobs"
                )
            found[number], trials = result
            for reference, trial in enumerate(trials):
                self._keep(number, reference, trial)
            self._tell(number, 0)
        return found

    def run_competitors(self, backend: Backend, references: dict[int, References]) -> None:
        """Everybody else whose trial is missing."""
        missing = {number: self.missing(number) for number in sorted(references)}
        fair = math.ceil(sum(map(len, missing.values())) / backend.workers)
        crews = []
        for number, left in missing.items():
            size = max(1, min(_CREW // len(self.contests[number].episodes.seeds), fair))
            crews += [(number, tuple(left[start : start + size])) for start in range(0, len(left), size)]
        lost = self._run_crews(backend, references, crews)
        suspects = [(number, (place,)) for number, places in lost if len(places) > 1 for place in places]
        dead = [crew for crew in lost if len(crew[1]) == 1]
        for number, (place,) in [*dead, *self._run_crews(backend, references, suspects)]:
            contest = self.contests[number]
            self._keep(number, place, failed_trial(contest.episodes, contest.everybody[place], ENDED))
            self._tell(number, place)

    def _run_crews(self, backend: Backend, references: dict[int, References], crews: Sequence[_Crew]) -> list[_Crew]:
        """Run some crews; returns those that took their process down."""
        lost: list[_Crew] = []
        tasks = [
            (self.contests[n].episodes, [self.contests[n].everybody[place] for place in places], references[n])
            for n, places in crews
        ]
        for task, trials in backend.run(trials_together, tasks):
            number, places = crews[task]
            if trials is None:
                lost.append(crews[task])
                continue
            for place, trial in zip(places, trials, strict=True):
                self._keep(number, place, trial)
                self._tell(number, place)
        return lost

    def labelled(self, protocol: str) -> Iterator[Trial]:
        """All trials in order, under the names of this run."""
        for number, contest in enumerate(self.contests):
            for place, competitor in enumerate(contest.everybody):
                yield self.trials[number, place].labelled(contest.episodes, competitor, protocol)


def run_contests(
    contests: Sequence[Contest],
    protocol: str,
    *,
    backend: Backend,
    store: Store | None = None,
    on_run: OnRun | None = None,
) -> Results:
    """Run some sets of episodes; see `run_protocol`.

    Args:
        contests: what is run.
        protocol: what the rows say they belong to.
        backend: who does the work.
        store: what was computed before is taken from there, what is computed now is kept there.
        on_run: who is told.
    """
    runner = _Runner(contests, store, on_run or _silence)
    runner.take_stored()
    if any(runner.missing(number) for number in range(len(contests))):
        runner.run_competitors(backend, runner.run_references(backend))
    trials = list(runner.labelled(protocol))
    everybody = (competitor for contest in contests for competitor in contest.competitors)
    return Results(
        episodes=pd.concat([trial.rows for trial in trials], ignore_index=True),
        timing=pd.DataFrame([trial.timing for trial in trials if trial.timing is not None]),
        traces=[trace for trial in trials for trace in trial.traces],
        competitors=tuple({competitor.name: competitor for competitor in everybody}.values()),
        runs=sum(contest.runs for contest in contests),
        stored=runner.stored,
    )


def run_protocol(
    protocol: Protocol,
    *,
    submissions: Sequence[Competitor] = (),
    traced: bool = False,
    jobs: int = 1,
    backend: Backend | None = None,
    store: Store | None = None,
    on_run: OnRun | None = None,
) -> Results:
    """Run everything that a protocol names. The rows do not depend on who does the work, nor on the store.

    Args:
        protocol: what is run.
        submissions: further competitors.
        traced: whether the worst, median and best episodes of every variant are kept tick by tick.
        jobs: worker processes; -1 = one per core. With 1 everything runs in this process.
        backend: who does the work, instead of `jobs` processes.
        store: what was computed before is taken from there, what is computed now is kept there; None = neither.
        on_run: called with a label after every run, the references counted as one.

    Raises:
        ValueError: an entry is not allowed, or two competitors have the same name.
        BackendError: the workers were lost; what they finished is in the store.
    """
    contests = contests_in(protocol, submissions, traced=traced)
    return run_contests(contests, protocol.stamp, backend=backend or Processes(jobs), store=store, on_run=on_run)


def _silence(label: str) -> None:
    """Nobody listens."""
