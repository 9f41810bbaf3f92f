"""Time at equal accuracy: our default beside a twin and a solver that err as little. Needs Pinocchio."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from fo_gym.bench.bars import ACCURACY, INTEGRATORS, LSODA, REGULATION, STICTION, twin_with
from fo_gym.bench.measure import Subject
from fo_gym.bench.measurement import PRECISION, RATIOS, Comparison, Measurement, Row, Tables, rows_without
from fo_gym.bench.size import Size
from fo_gym.bench.subjects import batch, one, twin

if TYPE_CHECKING:
    from fo_gym.bench.precision import Precision
    from fo_gym.certificate.cases import Case
    from fo_gym.certificate.steppers import Stepper

PLANTS = (STICTION, REGULATION)
"""Environments whose controller the certificate's solver has."""

__all__ = ["PLANTS", "accuracies", "errors_of", "one_beside_lsoda", "some_beside_twins"]


@contextmanager
def some_beside_twins(env_id: str, num_envs: int, steps: Sequence[int]) -> Iterator[list[Subject]]:
    """A control period of `num_envs` environments, and of their twins, one per integrator with its number of steps."""
    with batch(env_id, num_envs) as (held, simulation):
        dt = simulation.settings.control_dt
        pairs = zip(INTEGRATORS, steps, strict=True)
        yield [held, *(twin(simulation, dt / count, integrator) for integrator, count in pairs)]


class _Solved:
    """A solver's control periods, one after the other, from the start of a case, without a push."""

    def __init__(self, case: Case, begin: Callable[[Case], Stepper]) -> None:
        self.case = case
        self.begin = begin
        self.still = np.zeros(case.robot.dof)
        self.prepare()

    def prepare(self) -> None:
        """Go back to the start."""
        self.period = self.begin(self.case)

    def call(self) -> None:
        """One control period, its control included."""
        self.period(self.still)


@contextmanager
def one_beside_lsoda(env_id: str, tolerance: float) -> Iterator[list[Subject]]:
    """A control period of one environment, and of SciPy's LSODA on the same equations under sampled control."""
    from fo_gym.bench.precision import cases_of, lsoda  # noqa: PLC0415

    (case,) = cases_of(env_id, 1, 1)
    solved = _Solved(case, partial(lsoda, tolerance=tolerance))
    with one(env_id) as (held, _):
        yield [held, Subject(call=solved.call, prepare=solved.prepare)]


def errors_of(env_id: str, found: Precision) -> list[Row]:
    """Everything that was tried, as rows: what, its setting, and its largest error."""
    rows: list[Row] = [{"env": env_id, "method": "ours", "setting": "", "error": found.ours, "unit": found.unit}]
    for match in (*found.twins, found.lsoda):
        what = "rtol" if match is found.lsoda else "steps a period"
        rows += [
            {"env": env_id, "method": match.peer, "setting": f"{value:g} {what}", "error": error, "unit": found.unit}
            for value, error in match.tried
        ]
    return rows


def _measured(env_id: str, size: Size) -> Tables:
    twins = tuple(map(twin_with, INTEGRATORS))
    try:
        from fo_gym.bench.precision import precision  # noqa: PLC0415
    except ModuleNotFoundError as error:
        many = rows_without(error, env_id, ACCURACY, twins, size.num_envs)
        return {RATIOS: [*many, *rows_without(error, env_id, ACCURACY, (LSODA,), 1)]}
    found = precision(env_id, size.cases, size.periods)
    steps = [int(match.setting) for match in found.twins]
    some = Comparison(
        env_id,
        ACCURACY,
        size.num_envs,
        twins,
        partial(some_beside_twins, env_id, size.num_envs, steps),
        notes=tuple(match.note for match in found.twins),
    )
    alone = Comparison(
        env_id,
        ACCURACY,
        1,
        (LSODA,),
        partial(one_beside_lsoda, env_id, found.lsoda.setting),
        notes=(found.lsoda.note,),
    )
    return {RATIOS: some.rows(size) + alone.rows(size), PRECISION: errors_of(env_id, found)}


def accuracies(env_ids: Sequence[str], size: Size) -> list[Measurement]:
    """Those of the link and of the arm in joint space."""
    return [
        Measurement(f"{env_id}, {ACCURACY}", partial(_measured, env_id, size)) for env_id in PLANTS if env_id in env_ids
    ]
