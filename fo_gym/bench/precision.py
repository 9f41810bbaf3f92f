"""How fine a step a peer needs to err as little as the plant does: errors against the certificate's solver."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fo_gym.bench.bars import INTEGRATORS, LSODA, STICTION, twin_with
from fo_gym.certificate.cases import ARM, PERIOD, Case, arm_case, paper_case
from fo_gym.certificate.steppers import Stepper, motion, plant, solver, twin

Array = NDArray[np.float64]

SEED = 20240614
STEPS = (1, 2, 4, 8, 16, 32, 64, 128)
"""Steps of the twin in a control period that are tried, until one errs as little as the plant."""

_ON_THE_LINK = ("pid-low", "pd-low", "letien-low", "pid-high", "pd-high", "letien-high")

TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
"""Relative tolerances of LSODA that are tried; the absolute one is a thousandth of that [m | rad | m/s | rad/s]."""

__all__ = ["STEPS", "TOLERANCES", "Match", "Precision", "cases_of", "lsoda", "precision", "steps_to_reach"]


@dataclass(frozen=True)
class Match:
    """What makes a peer err as little as the plant.

    Attributes:
        peer: its name.
        tried: (steps of the twin in a control period | relative tolerance of LSODA, its largest error) of what was run.
        setting: that with which it errs as little.
        note: that in words.
    """

    peer: str
    tried: tuple[tuple[float, float], ...]
    setting: float
    note: str


@dataclass(frozen=True)
class Precision:
    """Largest distances of links and motors from the solver, over a few motions.

    Attributes:
        unit: of errors, "m" or "rad".
        ours: error of the plant at its defaults.
        twins: the twin by its integrators.
        lsoda: SciPy's solver at looser tolerances than the reference's.
    """

    unit: str
    ours: float
    twins: tuple[Match, ...]
    lsoda: Match


def steps_to_reach(target: float, steps: Sequence[int], errors: Sequence[float]) -> tuple[int, bool]:
    """Steps in a control period at which an error falls to the target, and whether they lie among those tried.

    Between two tries, and beyond the last one, the error is taken to follow a power of the number of steps.

    Args:
        target: error.
        steps: tried, rising; two at least.
        errors: of them.

    Raises:
        ValueError: the error does not fall at the end, so that nothing can be said of more steps.
    """
    below = np.flatnonzero(np.asarray(errors) <= target)
    place = int(below[0]) if len(below) else len(steps) - 1
    if place == 0:
        return steps[0], True
    (few, many), (before, after) = steps[place - 1 : place + 1], errors[place - 1 : place + 1]
    order = np.log(before / after) / np.log(many / few)
    if order <= 0.0:
        raise ValueError(f"errors {before:.1e} and {after:.1e} at {few} and {many} steps do not fall; try more steps")
    return int(np.ceil(few * (before / target) ** (1.0 / order) * (1.0 - 1e-9))), bool(len(below))


def cases_of(env_id: str, count: int, periods: int) -> list[Case]:
    """Motions on which errors are compared: the paper's six observers on the link, or random joints on the arm."""
    if env_id == STICTION:
        cases = [paper_case(name) for name in _ON_THE_LINK]
    else:
        draws = (np.random.default_rng([SEED, i]) for i in range(count))
        cases = [arm_case(ARM.link_side, ARM.home, draw, i) for i, draw in enumerate(draws)]
    return [replace(case, tau_ext=case.tau_ext[:periods]) for case in cases[:count]]


def lsoda(case: Case, tolerance: float) -> Stepper:
    """SciPy's LSODA on a case at a relative tolerance."""
    return solver(case, rtol=tolerance, atol=1e-3 * tolerance)


def precision(env_id: str, count: int, periods: int) -> Precision:
    """Measure the errors of plant, twins and LSODA on the motions of `cases_of`."""
    cases = cases_of(env_id, count, periods)
    truths = [motion(case, solver(case)) for case in cases]
    unit = "m" if env_id == STICTION else "rad"

    def error(stepper: Callable[[Case], Stepper]) -> float:
        pairs = zip(cases, truths, strict=True)
        return max(float(np.abs(motion(case, stepper(case)) - truth).max()) for case, truth in pairs)

    ours = error(plant)
    twins = tuple(_twin_match(integrator, ours, unit, error) for integrator in INTEGRATORS)
    return Precision(unit, ours, twins, _lsoda_match(ours, unit, error))


_Error = Callable[[Callable[[Case], Stepper]], float]


def _twin_match(integrator: str, ours: float, unit: str, error: _Error) -> Match:
    def at(count: int) -> float:
        return error(lambda case: twin(case, PERIOD / count, integrator))

    errors: list[float] = []
    for count in STEPS:
        errors.append(at(count))
        if errors[-1] <= ours and len(errors) > 1:
            break
    tried = list(zip(STEPS[: len(errors)], errors, strict=True))
    steps, inside = steps_to_reach(ours, STEPS[: len(errors)], errors)
    if inside:
        found = dict(tried).get(steps) or at(steps)
        tried.append((steps, found))
        note = f"{steps} steps a period; errors {found:.2g} {unit}, ours {ours:.2g} {unit}"
    else:
        last = f"{errors[-1]:.2g} {unit} at {STEPS[-1]}"
        note = f"{steps} steps a period, extrapolated from an error of {last}; ours {ours:.2g} {unit}"
    return Match(twin_with(integrator), tuple(dict(sorted(tried)).items()), steps, note)


def _lsoda_match(ours: float, unit: str, error: _Error) -> Match:
    tried: list[tuple[float, float]] = []
    for tolerance in TOLERANCES:
        tried.append((tolerance, error(lambda case, rtol=tolerance: lsoda(case, rtol))))  # type: ignore[misc]
        if tried[-1][1] <= ours:
            break
    tolerance, found = tried[-1]
    note = f"rtol {tolerance:g}; errors {found:.2g} {unit}, ours {ours:.2g} {unit}"
    return Match(LSODA, tuple(tried), tolerance, note)
