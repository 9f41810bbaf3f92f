"""One study: a compensator's gains on one environment and variant."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import optuna
import pandas as pd
from optuna.trial import FrozenTrial, TrialState

from fo_gym.checks import choice, whole_number
from fo_gym.compensators import CompensatorError
from fo_gym.envs.registry import environment_of
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.episode.recording import References
from fo_gym.evaluation.runs.episodes import EpisodeSet, references_of
from fo_gym.evaluation.runs.seeds import TUNING_SEEDS, VALIDATION_SEEDS, first
from fo_gym.evaluation.runs.store import Store
from fo_gym.evaluation.runs.trial import Trial, trials_together
from fo_gym.tasks.variants import NOMINAL, VARIANTS
from fo_gym.tuning.space import default_gains, search_space

FINALISTS = 3
WORST = -1.0
"""What an episode counts at least: one that is lost is lost, however badly."""

TOGETHER = 4
"""Trials that are asked for before any of them is scored: they share a batch, in which a trial costs a third."""

MAX_SEARCH_SEED = 2**32 - 1

OnTrial = Callable[[str], None]

__all__ = ["FINALISTS", "WORST", "Case", "Outcome", "run_study"]


@dataclass(frozen=True)
class Case:
    """What is tuned, and with how much effort.

    Attributes:
        spec: compensator, with a `search_space`.
        env_id, variant: where; of an environment that is named "module:ID" or "file.py:ID" the id.
        trials: sets of gains that are tried; those that the compensator refuses cost nothing and do not count.
        episodes: of every trial; their seeds are the first tuning seeds.
        seed: of the search.
        final_episodes: validation episodes of each finalist; more than of a trial, since fast gains may ring in one
            episode of twenty.

    Raises:
        ValueError: one of them is not allowed.
    """

    spec: str
    env_id: str
    variant: str
    trials: int
    episodes: int
    seed: int
    final_episodes: int = 20

    def __post_init__(self) -> None:
        object.__setattr__(self, "env_id", environment_of(self.env_id).id)
        choice("variant", self.variant, VARIANTS)
        bounds = {"trials": (1, 1_000_000), "episodes": (1, len(TUNING_SEEDS)), "seed": (0, MAX_SEARCH_SEED)}
        for name, (low, high) in {**bounds, "final_episodes": (1, len(VALIDATION_SEEDS))}.items():
            whole_number(name, getattr(self, name), low, high)
        if self.variant == NOMINAL:
            raise ValueError("variant 'nominal' is one episode, the one that is scored; tune on one with draws")

    def competitor(self, gains: Mapping[str, float]) -> Competitor:
        """The compensator with these gains."""
        return Competitor(self.spec, self.spec, gains=gains)


@dataclass(frozen=True)
class Outcome:
    """What a study found.

    Attributes:
        case: what was tuned.
        gains: the chosen ones.
        trials: one row per trial: number, gains, mean FRR on the tuning seeds, and for finalists on validation seeds.
    """

    case: Case
    gains: Mapping[str, float]
    trials: pd.DataFrame


class _Scorer:
    """Mean FRR of sets of gains on the same episodes."""

    def __init__(self, case: Case, seeds: tuple[int, ...], store: Store) -> None:
        self._case = case
        self._episodes = EpisodeSet(case.env_id, case.variant, seeds, {})
        self._store = store

    @cached_property
    def _references(self) -> References:
        none, ideal = references_of(self._episodes)
        return References(ideal.motions, none.motions)

    def __call__(self, sets: Sequence[Mapping[str, float]]) -> list[float]:
        """One number for each set of gains, out of the store where it is there.

        Raises:
            CompensatorError: the compensator cannot be run with one of them.
        """
        competitors = [self._case.competitor(gains) for gains in sets]
        kept = ((i, self._store.load(self._episodes, each)) for i, each in enumerate(competitors))
        trials = {i: trial for i, trial in kept if trial is not None}
        missing = [i for i in range(len(sets)) if i not in trials]
        if missing:
            run = trials_together(self._episodes, [competitors[i] for i in missing], self._references)
            for i, trial in zip(missing, run, strict=True):
                self._store.save(self._episodes, competitors[i], trial)
                trials[i] = trial
        return [_mean_frr(trials[i], gains) for i, gains in enumerate(sets)]


def _mean_frr(trial: Trial, gains: Mapping[str, float]) -> float:
    if trial.failed:
        raise CompensatorError(f"with gains {dict(gains)}: {trial.rows['error'].iloc[0]}")
    frr = trial.rows["frr"].to_numpy(dtype=np.float64)
    return float(np.maximum(np.nan_to_num(frr, nan=WORST), WORST).mean())


def run_study(case: Case, store: Store, on_trial: OnTrial | None = None) -> Outcome:
    """Search, or go on searching, and choose.

    The first trial has the compensator's own gains; the best few and the first meet again on validation seeds, and the
    best there is chosen: where nothing is better than what was published, that stays.

    Args:
        case: what is asked for.
        store: keeps the trials. The search itself is cheap and asks for the same ones again, so that one that was
            killed goes on as if it had not been.
        on_trial: called with a label after some trials.
    """
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    sampler = optuna.samplers.TPESampler(seed=case.seed, multivariate=True, constant_liar=True)
    study = optuna.create_study(direction="maximize", sampler=sampler)
    study.enqueue_trial(default_gains(case.spec))
    score = _Scorer(case, first(TUNING_SEEDS, case.episodes), store)
    asked = _accepted(case, study)
    done = 0
    while done < case.trials:
        together = [next(asked) for _ in range(min(TOGETHER, case.trials - done))]
        for trial, value in zip(together, score([trial.params for trial in together]), strict=True):
            study.tell(trial, value)
        done += len(together)
        if on_trial is not None:
            on_trial(f"{case.env_id} {case.variant}: trial {done} of {case.trials}, best {study.best_value:.4f}")
    return _choose(case, study.get_trials(states=(TrialState.COMPLETE,)), store)


def _accepted(case: Case, study: optuna.Study) -> Iterator[optuna.Trial]:
    """Trials that a compensator can be made with; others are pruned."""
    space = search_space(case.spec)
    while True:
        trial = study.ask()
        gains = {name: trial.suggest_float(name, low, high, log=True) for name, (low, high) in space.items()}
        try:
            with case.competitor(gains).playing(case.env_id, case.variant):
                pass
        except ValueError:
            study.tell(trial, state=TrialState.PRUNED)
        else:
            yield trial


def _choose(case: Case, complete: Sequence[FrozenTrial], store: Store) -> Outcome:
    best = sorted(complete, key=lambda trial: trial.value or WORST, reverse=True)[:FINALISTS]
    finalists = list({trial.number: trial for trial in [complete[0], *best]}.values())
    score = _Scorer(case, first(VALIDATION_SEEDS, case.final_episodes), store)
    values = score([trial.params for trial in finalists])
    finals = {trial.number: value for trial, value in zip(finalists, values, strict=True)}
    table = [
        {"trial": place, **trial.params, "frr_tuning": trial.value, "frr_validation": finals.get(trial.number)}
        for place, trial in enumerate(complete)
    ]
    chosen = max(finalists, key=lambda trial: finals[trial.number])
    return Outcome(case, chosen.params, pd.DataFrame(table))
