"""A sweep: one compensator with many sets of gains, all on the same episodes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from numbers import Integral, Real
from typing import Any

import pandas as pd

from fo_gym.compensators import CompensatorError
from fo_gym.evaluation.competitors.competitor import MAX_SETS, Competitor
from fo_gym.evaluation.competitors.entry import competitor_of
from fo_gym.evaluation.results.statistics import interquartile_mean
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.contest import Contest, Results
from fo_gym.evaluation.runs.episodes import FAILED, KEY, OK, SET, TERMINATED, EpisodeSet, failed_rows
from fo_gym.evaluation.runs.evaluate import check_arguments, evaluation_seeds
from fo_gym.evaluation.runs.run import run_contests
from fo_gym.evaluation.runs.trial import failed_trial

Gains = Mapping[str, Sequence[float]]

__all__ = ["Grid", "Plan", "summary_of", "sweep"]


@dataclass(frozen=True)
class Grid:
    """A compensator, and the sets of gains that it is swept over: every combination, the last gain running fastest.

    Attributes:
        spec: a registered name, "module:Class", "file.py:Class" or an entry (*.toml).
        gains: the values of each gain.
    """

    spec: str
    gains: Gains

    def __post_init__(self) -> None:
        if not self.gains:
            raise ValueError("no gain is swept; give the values of at least one, such as {'L': [50, 100, 200]}")
        taken = set(failed_rows(EpisodeSet("FJRStiction-v0", "nominal", (0,), {}), "", "").columns)
        for name in self.gains:
            if name in taken:
                raise ValueError(f"gain {name!r} has the name of a column of the results; sweep it under another name")
        # Once: a generator has its values no second time.
        object.__setattr__(self, "gains", {name: _checked_values(name, each) for name, each in self.gains.items()})
        count = math.prod(len(values) for values in self.gains.values())
        if count > MAX_SETS:
            raise ValueError(f"the gains make {count} sets; at most {MAX_SETS} are swept: give fewer values")

    @property
    def sets(self) -> list[dict[str, float]]:
        """Every combination; whole numbers stay whole, as a class may count with them."""
        numbers = ([_plain(value) for value in values] for values in self.gains.values())
        return [dict(zip(self.gains, values, strict=True)) for values in product(*numbers)]

    @cached_property
    def competitors(self) -> tuple[Competitor, ...]:
        """A competitor for every set, named by it. Raises ValueError as `competitor_of` does."""
        own = competitor_of(self.spec)
        return tuple(own.with_gains(gains) for gains in self.sets)


def _plain(value: Any) -> float:
    """The number as Python has it, of NumPy too."""
    return int(value) if isinstance(value, Integral) else float(value)


def _is_number(value: Any) -> bool:
    return not isinstance(value, bool) and isinstance(value, Real) and math.isfinite(value)


def _checked_values(name: str, values: Any) -> tuple[float, ...]:
    """The values of a gain. Raises ValueError for what cannot be swept over."""
    listed = tuple(values) if isinstance(values, Iterable) else ()
    numbers = [value for value in listed if _is_number(value)]
    if not listed or len(set(numbers)) < len(listed):
        raise ValueError(f"gain {name!r} is {values!r}; give a list of finite numbers, at least one and none twice")
    return listed


def sweep(
    compensator: str,
    env_id: str,
    gains: Gains,
    *,
    variant: str = "nominal",
    seeds: int | Sequence[int] | None = None,
    jobs: int = 1,
    **env_kwargs: Any,
) -> pd.DataFrame:
    """Score a compensator with every combination of some gains, on the same episodes.

    Args:
        compensator: a registered name, "module:Class", "file.py:Class" or an entry (*.toml).
        env_id: a registered environment, such as "FJRStiction-v0".
        gains: values of each gain by the name of the keyword argument, such as {"L": [50, 100], "Lp": [10, 20]}.
        variant: variant of it.
        seeds: as for `evaluate`.
        jobs: worker processes; -1 = one per core. With 1 everything runs in this process.
        env_kwargs: further arguments of the environment.

    Returns:
        One row per set of gains and episode, as of `evaluate`, with a column for each gain. Sets that the compensator
        refuses, or with which it fails, have the status "failed", the reason in `error`, and no scores.

    Raises:
        ValueError, TypeError, CompensatorError: an argument is not allowed, or no set of gains is.
    """
    check_arguments(env_id, variant, env_kwargs)
    episodes = EpisodeSet(env_id, variant, evaluation_seeds(variant, seeds), env_kwargs)
    backend = Processes(jobs)
    plan = Plan(Grid(compensator, gains), [episodes])
    return plan.table(run_contests(plan.contests, "", backend=backend))


class Plan:
    """What has to be run for a sweep, and what comes of it.

    Args:
        grid: who is scored, with which gains.
        sets: the episodes; the references of each run once.

    Attributes:
        contests: what is to be run: sets of gains that the compensator refuses are not.

    Raises:
        ValueError, TypeError, CompensatorError: the compensator accepts no set, so that it is not the values.
    """

    def __init__(self, grid: Grid, sets: Sequence[EpisodeSet]) -> None:
        self._grid = grid
        self._gains = dict(zip((each.name for each in grid.competitors), grid.sets, strict=True))
        self._refused: list[pd.DataFrame] = []
        self.contests: list[Contest] = []
        for episodes in sets:
            errors = _refusals(grid.competitors, episodes)
            accepted = tuple(each for each in grid.competitors if each.name not in errors)
            if not accepted:
                raise next(iter(errors.values()))
            self.contests.append(Contest(episodes, accepted))
            for each in grid.competitors:
                if each.name in errors:
                    error = errors[each.name]
                    trial = failed_trial(episodes, each, f"{type(error).__name__}: {error}")
                    self._refused.append(trial.labelled(episodes, each, "").rows)

    def table(self, results: Results) -> pd.DataFrame:
        """The rows of all sets of gains, those that were refused included; see `sweep`."""
        everything = pd.concat([results.episodes, *self._refused], ignore_index=True)
        sets = [
            (contest.episodes.env_id, contest.episodes.robot.name, contest.episodes.variant)
            for contest in self.contests
        ]
        runs = dict(iter(everything.groupby(KEY, sort=False)))
        rows = pd.concat([runs[*each, name] for each in sets for name in self._gains], ignore_index=True)
        for number, gain in enumerate(self._grid.gains):
            rows.insert(len(KEY) + number, gain, [self._gains[name][gain] for name in rows["compensator"]])
        return rows.assign(compensator=competitor_of(self._grid.spec).name)


def _refusals(competitors: Sequence[Competitor], episodes: EpisodeSet) -> dict[str, Exception]:
    """What the sets of gains raise that the compensator does not accept, by the name of the set."""
    found: dict[str, Exception] = {}
    for competitor in competitors:
        try:
            with competitor.playing(episodes.env_id, episodes.variant):
                pass
        except (ValueError, TypeError, CompensatorError) as error:
            found[competitor.name] = error
    return found


def summary_of(table: pd.DataFrame, gains: Sequence[str]) -> pd.DataFrame:
    """What each set of gains is worth: one row per environment, robot, variant and set, in the order of the sweep.

    Args:
        table: as `sweep` gives it.
        gains: names of its gains.

    Returns:
        env, robot, variant, the gains, `frr` (interquartile mean), `frr_worst` and `frr_best` of the episodes, `status`
        (of the worst kind among them) and `error` (the first).
    """
    groups = table.groupby([*SET, *gains], sort=False)
    rows = [
        {
            **dict(zip([*SET, *gains], key, strict=True)),
            "frr": interquartile_mean(group["frr"].to_numpy()),
            "frr_worst": group["frr"].min(),
            "frr_best": group["frr"].max(),
            "status": next((status for status in (FAILED, TERMINATED) if (group["status"] == status).any()), OK),
            "error": next((error for error in group["error"] if error), ""),
        }
        for key, group in groups
    ]
    return pd.DataFrame(rows)
