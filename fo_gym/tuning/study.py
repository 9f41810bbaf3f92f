"""One study: a compensator's gains on one environment and variant."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import optuna
import pandas as pd
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend
from optuna.trial import FrozenTrial, TrialState

from fo_gym.checks import choice, whole_number
from fo_gym.envs.registry import known_environments
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.episode.recording import References
from fo_gym.evaluation.runs.episodes import EpisodeSet, references_of, rows
from fo_gym.evaluation.runs.seeds import TUNING_SEEDS, VALIDATION_SEEDS, first
from fo_gym.tasks.variants import NOMINAL, VARIANTS
from fo_gym.tuning.space import default_gains, search_space

FINALISTS = 3
WORST = -1.0
"""What an episode counts at least: one that is lost is lost, however badly."""

MAX_SEARCH_SEED = 9999
"""Every trial has a sampler of its own, whose seed has 32 bits."""

OnTrial = Callable[[str], None]

__all__ = ["FINALISTS", "WORST", "Case", "Outcome", "run_study"]


@dataclass(frozen=True)
class Case:
    """What is tuned, and with how much effort.

    Attributes:
        spec: compensator, with a `search_space`.
        env_id, variant: where.
        trials: sets of gains that are tried; those that the compensator refuses cost nothing and do not count.
        episodes: of every trial; their seeds are the first tuning seeds.
        seed: of the search.
        final_episodes: validation episodes of each finalist; more than of a trial, since fast gains may ring in one
            episode of twenty.
    """

    spec: str
    env_id: str
    variant: str
    trials: int
    episodes: int
    seed: int
    final_episodes: int = 20

    def __post_init__(self) -> None:
        choice("env", self.env_id, known_environments())
        choice("variant", self.variant, VARIANTS)
        bounds = {"trials": (1, 1_000_000), "episodes": (1, len(TUNING_SEEDS)), "seed": (0, MAX_SEARCH_SEED)}
        for name, (low, high) in {**bounds, "final_episodes": (1, len(VALIDATION_SEEDS))}.items():
            whole_number(name, getattr(self, name), low, high)
        if self.variant == NOMINAL:
            raise ValueError("variant 'nominal' is one episode, the one that is scored; tune on one with draws")

    @property
    def name(self) -> str:
        """What to call it, also as a file."""
        return f"{self.spec}-{self.env_id}-{self.variant}".replace(":", "-").replace("/", "-")

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
    """Mean FRR of gains on one set of episodes."""

    def __init__(self, case: Case, seeds: tuple[int, ...]) -> None:
        self._case = case
        self._episodes = EpisodeSet(case.env_id, case.variant, seeds, {})
        none, ideal = references_of(self._episodes)
        self._references = References(ideal.motions, none.motions)

    def __call__(self, gains: Mapping[str, float]) -> float:
        with self._case.competitor(gains).playing(self._case.env_id, self._case.variant) as compensator:
            recording = self._episodes.record(compensator, self._case.spec)
        frr = rows(self._episodes, self._case.spec, recording, self._references, compensator)["frr"].to_numpy()
        return float(np.maximum(np.nan_to_num(frr, nan=WORST), WORST).mean())


def run_study(case: Case, folder: Path, on_trial: OnTrial | None = None) -> Outcome:
    """Search, or go on searching, and choose.

    The first trial has the compensator's own gains; the best few and the first meet again on validation seeds, and the
    best there is chosen: where nothing is better than what was published, that stays.

    Args:
        case: what is asked for.
        folder: keeps the study's journal, from which a search that was killed goes on as if it had not been.
        on_trial: called with a label after every trial that counts.
    """
    space, start = search_space(case.spec), default_gains(case.spec)
    folder.mkdir(parents=True, exist_ok=True)
    study = _open(case, folder)
    if not _decided(study):
        study.enqueue_trial(start)
    score = _Scorer(case, first(TUNING_SEEDS, case.episodes))

    def objective(trial: optuna.Trial) -> float:
        """The score of the gains that the trial suggests; those that nothing can be made with are pruned."""
        gains = {name: trial.suggest_float(name, low, high, log=True) for name, (low, high) in space.items()}
        try:
            with case.competitor(gains).playing(case.env_id, case.variant):
                pass
        except ValueError as error:
            raise optuna.TrialPruned(str(error)) from error
        return score(gains)

    while len(_complete(study)) < case.trials:
        # A sampler of its own for every trial: what it draws depends on the seed and on the trials so far alone.
        place = case.seed * 100_000 + len(_decided(study))
        study.sampler = optuna.samplers.TPESampler(seed=place, multivariate=True)
        study.optimize(objective, n_trials=1)
        done = len(_complete(study))
        if on_trial is not None and study.trials[-1].state is TrialState.COMPLETE:
            on_trial(f"{case.env_id} {case.variant}: trial {done} of {case.trials}, best {study.best_value:.4f}")
    return _choose(case, study)


def _open(case: Case, folder: Path) -> optuna.Study:
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    storage = JournalStorage(JournalFileBackend(str(folder / f"{case.name}.journal")))
    study = optuna.create_study(
        study_name=f"{case.name}-{case.seed}-{case.episodes}",
        storage=storage,
        direction="maximize",
        load_if_exists=True,
    )
    for trial in study.trials:  # what a killed process left behind: it is drawn again, as it was
        if not trial.state.is_finished():
            study.tell(trial.number, state=TrialState.FAIL)
    return study


def _decided(study: optuna.Study) -> list[FrozenTrial]:
    """Trials that were scored, or that the compensator refused."""
    return [trial for trial in study.trials if trial.state in (TrialState.COMPLETE, TrialState.PRUNED)]


def _complete(study: optuna.Study) -> list[FrozenTrial]:
    return [trial for trial in study.trials if trial.state is TrialState.COMPLETE]


def _choose(case: Case, study: optuna.Study) -> Outcome:
    complete = _complete(study)[: case.trials]
    best = sorted(complete, key=lambda trial: trial.value or WORST, reverse=True)[:FINALISTS]
    score = _Scorer(case, first(VALIDATION_SEEDS, case.final_episodes))
    finals = {trial.number: score(trial.params) for trial in {t.number: t for t in [complete[0], *best]}.values()}
    table = [
        {"trial": place, **trial.params, "frr_tuning": trial.value, "frr_validation": finals.get(trial.number)}
        for place, trial in enumerate(complete)
    ]
    chosen = max(finals, key=lambda number: finals[number])
    gains = next(trial.params for trial in complete if trial.number == chosen)
    return Outcome(case, gains, pd.DataFrame(table))
