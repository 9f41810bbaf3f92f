"""A map: one compensator over a grid of two parameters, gains of its own or friction of the robot, cell by cell."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, cast

import gymnasium as gym
import pandas as pd

from fo_gym.checks import choice
from fo_gym.compensators import CompensatorError
from fo_gym.evaluation.competitors.competitor import Competitor, Gains
from fo_gym.evaluation.competitors.entry import competitor_of
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.results.sweep import Grid
from fo_gym.evaluation.runs.backends import Backend
from fo_gym.evaluation.runs.cells import Cell, CellSet, changed_law, friction_names, run_cells
from fo_gym.evaluation.runs.episodes import KEY, EpisodeSet, failed_rows
from fo_gym.evaluation.runs.evaluate import check_arguments
from fo_gym.evaluation.runs.run import OnRun
from fo_gym.evaluation.runs.store import Store
from fo_gym.evaluation.runs.trial import fitting
from fo_gym.tasks.variants import NOMINAL

SHORT_NAMES = {"hunting": "limit_cycle_peak_to_peak_ju", "rest": "steady_state_error_ju", "frr": "frr"}
"""What a map mostly shows, by a name for a command line; any other metric goes by the name of its column."""

_BATCH = 200
"""Cells of a batch at most: more of them save little time, and are lost when the run is killed."""

__all__ = ["SHORT_NAMES", "Map", "column_of", "map_table"]


def column_of(metric: str) -> str:
    """The column of a metric: of `SHORT_NAMES`, or of `METRICS`. Raises ValueError for anything else."""
    choice("metric", metric, (*SHORT_NAMES, *METRICS))
    return SHORT_NAMES.get(metric, metric)


@dataclass(frozen=True)
class Map:
    """What is mapped, over what.

    Attributes:
        spec: the compensator: a registered name, "module:Class", "file.py:Class" or an entry (*.toml).
        x, y: name and values of both parameters: a gain, or of the robot's friction one of `friction_names`.
        env_id: a registered environment; the nominal episode of seed 0 is run.
        gains: further gains, the same everywhere.
        env_kwargs: further arguments of the environment.
        cell_size: ticks and joints of an episode.

    Raises:
        ValueError, TypeError: one of them is not allowed.
        FileNotFoundError: there is no such robot file.
    """

    spec: str
    x: tuple[str, Sequence[float]]
    y: tuple[str, Sequence[float]]
    env_id: str = "FJRStiction-v0"
    gains: Gains = field(default_factory=dict)
    env_kwargs: Mapping[str, Any] = field(default_factory=dict)
    cell_size: tuple[int, int] = field(init=False)

    def __post_init__(self) -> None:
        if self.x[0] == self.y[0]:
            raise ValueError(f"x and y are both {self.x[0]!r}; a map is over two different parameters")
        check_arguments(self.env_id, NOMINAL, self.env_kwargs)
        simulation = cast("Any", gym.make(self.episode.env_id, **self.env_kwargs).unwrapped).simulation
        object.__setattr__(self, "cell_size", (simulation.last_tick + 1, simulation.dof))

    @cached_property
    def grid(self) -> Grid:
        """Every combination of both, y running fastest."""
        return Grid(self.spec, dict((self.x, self.y)))

    @cached_property
    def competitor(self) -> Competitor:
        """Who is mapped, with the gains that are the same everywhere."""
        own = competitor_of(self.spec)
        return own.with_gains(self.gains) if self.gains else own

    @cached_property
    def episode(self) -> EpisodeSet:
        """The episode of every cell, as it is where nothing is changed."""
        return EpisodeSet(self.env_id, NOMINAL, (0,), self.env_kwargs)

    @cached_property
    def cells(self) -> list[Cell]:
        """The cells, in the order of the grid."""
        rubs = friction_names(self.episode.robot.friction)
        return [
            Cell(
                {name: value for name, value in each.items() if name not in rubs},
                {name: value for name, value in each.items() if name in rubs},
            )
            for each in self.grid.sets
        ]

    @cached_property
    def refused(self) -> dict[int, str]:
        """Why some cells are not run: the compensator or the friction law refuses them; by their place.

        What has a process of its own is not asked before it runs.

        Raises:
            ValueError, TypeError, CompensatorError: none is accepted, so that it is not the values.
        """
        found: dict[int, Exception] = {}
        for place, cell in enumerate(self.cells):
            try:
                changed_law(self.episode.robot.friction, cell.friction)
                if not self.competitor.guarded:
                    self.competitor.with_gains(cell.gains).make(self.episode.env_id, NOMINAL)
            except (ValueError, TypeError, CompensatorError) as error:
                found[place] = error
        if len(found) == len(self.cells):
            raise next(iter(found.values()))
        return {place: f"{type(error).__name__}: {error}" for place, error in found.items()}


def map_table(plan: Map, backend: Backend, store: Store | None = None, on_run: OnRun | None = None) -> pd.DataFrame:
    """The rows of all cells, in the order of the grid, with a column for each of both parameters.

    Cells that are refused, or that fail, have the status "failed", the reason in `error`, and no scores. Limit cycles
    are looked for in the last half of the episode, and where the task's window for them lies in it not before that.

    Args:
        plan: what is mapped.
        backend: who does the work.
        store: what was computed before is taken from there, what is computed now is kept there.
        on_run: called with a label after every cell.
    """
    accepted = [place for place in range(len(plan.cells)) if place not in plan.refused]
    ticks, dof = plan.cell_size
    size = min(_BATCH, fitting(ticks, 1, dof), math.ceil(len(accepted) / backend.workers))
    batches = [accepted[start : start + size] for start in range(0, len(accepted), size)]
    sets = [CellSet.of(plan.episode, [plan.cells[place] for place in batch]) for batch in batches]
    tables = [failed_rows(plan.episode, plan.competitor.name, error) for error in plan.refused.values()]
    trials = run_cells(sets, plan.competitor, backend=backend, store=store, on_run=on_run)
    tables += [trial.rows for trial in trials]
    rows = pd.concat(tables, ignore_index=True)
    rows.index = pd.Index([*plan.refused, *accepted])
    rows = rows.sort_index().assign(compensator=plan.competitor.name, origin=plan.competitor.origin)
    for number, name in enumerate(plan.grid.gains):
        rows.insert(len(KEY) + number, name, [each[name] for each in plan.grid.sets])
    return rows
