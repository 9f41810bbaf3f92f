"""Cells of a map: one competitor meets the nominal episode many times in one batch.

Each time it has other gains, or the robot other friction.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from fo_gym.compensators import Compensator, Ideal, NoCompensation, has_array_gains, make_compensator
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.competitors.team import Team
from fo_gym.evaluation.episode.recording import Motions, Recording, References
from fo_gym.evaluation.runs.backends import Backend
from fo_gym.evaluation.runs.episodes import EpisodeSet, failed_rows, rows
from fo_gym.evaluation.runs.run import ENDED, OnRun
from fo_gym.evaluation.runs.store import Store
from fo_gym.evaluation.runs.trial import Trial
from fo_gym.friction import FrictionLaw
from fo_gym.tasks.task import Task
from fo_gym.tasks.variants import NOMINAL

__all__ = ["Cell", "CellSet", "cells_trial", "changed_law", "friction_names", "run_cells"]


@dataclass(frozen=True)
class Cell:
    """What is different in one episode of a map.

    Attributes:
        gains: that replace the competitor's own.
        friction: that replaces the robot's, see `changed_law`.
    """

    gains: Mapping[str, float]
    friction: Mapping[str, float]


@dataclass(frozen=True)
class CellSet(EpisodeSet):
    """The nominal episode once for each of some cells, which either all have gains, of the same names, or none has."""

    cells: tuple[Cell, ...] = ()

    @classmethod
    def of(cls, episode: EpisodeSet, cells: Sequence[Cell]) -> CellSet:
        """These cells of an episode."""
        return cls(episode.env_id, NOMINAL, (0,) * len(cells), episode.env_kwargs, cells=tuple(cells))

    def start(self, env: JointVectorEnv) -> None:
        """Give every episode the friction of its cell, except where none acts."""
        simulation = env.simulation
        if not simulation.settings.disturbed or not any(cell.friction for cell in self.cells):
            return
        state = simulation.get_state()
        pairs = zip(state.scenarios, self.cells, strict=True)
        scenarios = (replace(each, friction=changed_law(each.friction, cell.friction)) for each, cell in pairs)
        simulation.set_state(replace(state, scenarios=tuple(scenarios)))


def friction_names(law: FrictionLaw) -> tuple[str, ...]:
    """What of a friction law may be changed: its fields of numbers, and the ratio of stiction and Coulomb friction."""
    names = [name for name, value in vars(law).items() if not isinstance(value, tuple)]
    return (*names, "f_s/f_c") if {"f_s", "f_c"} <= set(names) else (*names,)


def changed_law(law: FrictionLaw, values: Mapping[str, float]) -> FrictionLaw:
    """The law with some of its `friction_names` changed; the ratio f_s/f_c changes f_s.

    Raises:
        ValueError: the law cannot have such a value.
    """
    new: dict[str, float] = {name: value for name, value in values.items() if name != "f_s/f_c"}
    if "f_s/f_c" in values:
        new["f_s"] = values["f_s/f_c"] * new.get("f_c", vars(law)["f_c"])
    changed: FrictionLaw = replace(cast("Any", law), **new)
    return changed


def _window(task: Task) -> tuple[float, float] | None:
    """Where limit cycles are looked for: in the last half of the episode, not before the task's window."""
    window = task.limit_cycle_window
    if window is None:
        return None
    start = window[0] if window[1] <= task.duration else 0.0
    return max(start, task.duration / 2.0), task.duration


@contextmanager
def _playing(competitor: Competitor, cells: CellSet) -> Iterator[Compensator]:
    """One compensator that has in each environment the gains of its cell."""
    where = cells.env_id, cells.variant
    names = list(cells.cells[0].gains)
    if not names or len(cells.cells) == 1:
        with competitor.with_gains(cells.cells[0].gains).playing(*where) as compensator:
            yield compensator
    elif has_array_gains(first := competitor.with_gains(cells.cells[0].gains).make(*where)):
        arrays = {name: np.array([[cell.gains[name]] for cell in cells.cells]) for name in names}
        yield make_compensator(competitor.spec, **{**competitor.gains_on(*where), **arrays})
    else:
        yield Team([first, *(competitor.with_gains(cell.gains).make(*where) for cell in cells.cells[1:])])


_Outcome = tuple[Recording, Compensator] | BaseException
"""What happened, and whose doing it is; or what was raised."""


def _outcomes(competitor: Competitor, cells: CellSet) -> Iterator[tuple[CellSet, _Outcome]]:
    """What happens in the cells, in their order, as many together as can be.

    Where something goes wrong in a batch, its halves run one after the other, down to the cell whose fault it is. Gains
    of what has a process of its own are tried one by one in any case.
    """
    alone = len(cells.cells) == 1
    if alone or not (competitor.guarded and cells.cells[0].gains):
        try:
            with _playing(competitor, cells) as compensator:
                recording = cells.record(compensator, competitor.name)
        except (Exception, SystemExit) as error:
            if alone:
                yield cells, error
                return
        else:
            yield cells, (recording, compensator)
            return
    middle = len(cells.cells) // 2
    for part in (cells.cells[:middle], cells.cells[middle:]):
        yield from _outcomes(competitor, CellSet.of(cells, part))


class _Scorer:
    """Scores cells beside their references: `ideal` is the same for all, `none` differs with the friction."""

    def __init__(self, cells: CellSet) -> None:
        self._kinds = list(dict.fromkeys(tuple(cell.friction.items()) for cell in cells.cells))
        rubbing = CellSet.of(cells, [Cell({}, dict(kind)) for kind in self._kinds])
        self._none = rubbing.record(NoCompensation(), "none").motions
        self._ideal = CellSet.of(cells, rubbing.cells[:1]).record(Ideal(), "ideal").motions

    def rows(self, cells: CellSet, name: str, recording: Recording, compensator: Compensator) -> pd.DataFrame:
        """A row for each cell, as `fo_gym.evaluation.runs.episodes.rows` gives them."""
        places = np.array([self._kinds.index(tuple(cell.friction.items())) for cell in cells.cells])
        references = References(_taken(self._ideal, 0 * places), _taken(self._none, places))
        recording = replace(recording, task=replace(recording.task, limit_cycle_window=_window(recording.task)))
        return rows(cells, name, recording, references, compensator)


def _taken(motions: Motions, places: NDArray[np.intp]) -> Motions:
    """The episodes at these places of a batch."""
    parts = (motions.theta, motions.tool, motions.f_hand, motions.lost)
    return Motions(*(None if part is None else part[:, places] for part in parts))  # type: ignore[arg-type]


def cells_trial(cells: CellSet, competitor: Competitor) -> Trial:
    """The scores of some cells: a row for each, in their order, failed ones included."""
    scorer = _Scorer(cells)
    tables = []
    for part, outcome in _outcomes(competitor, cells):
        if isinstance(outcome, BaseException):
            tables.append(failed_rows(part, competitor.name, f"{type(outcome).__name__}: {outcome}"))
        else:
            tables.append(scorer.rows(part, competitor.name, *outcome))
    return Trial(pd.concat(tables, ignore_index=True), None, ())


def run_cells(
    sets: Sequence[CellSet],
    competitor: Competitor,
    *,
    backend: Backend,
    store: Store | None = None,
    on_run: OnRun | None = None,
) -> list[Trial]:
    """The trials of some sets of cells, in their order.

    Args:
        sets: what is run, each as one batch.
        competitor: who meets them.
        backend: who does the work.
        store: what was computed before is taken from there, what is computed now is kept there.
        on_run: called with a label after every cell.
    """

    def tell(cells: CellSet, how: str = "") -> None:
        if on_run is not None:
            for _ in cells.cells:
                on_run(f"{cells.label}: {competitor.name}{how}")

    found = {place: store.load(cells, competitor) if store else None for place, cells in enumerate(sets)}
    missing = [place for place, trial in found.items() if trial is None]
    for place in found.keys() - set(missing):
        tell(sets[place], ", from the store")
    for number, outcome in backend.run(cells_trial, [(sets[place], competitor) for place in missing]):
        place = missing[number]
        trial = Trial(failed_rows(sets[place], competitor.name, ENDED), None, ()) if outcome is None else outcome
        if store:
            store.save(sets[place], competitor, trial)
        found[place] = trial
        tell(sets[place])
    return [trial for trial in found.values() if trial is not None]
