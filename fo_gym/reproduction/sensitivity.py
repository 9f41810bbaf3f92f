"""What the arm's experiments say when the numbers that nobody published are others."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any

import numpy as np

from fo_gym.certificate.statement import Finding
from fo_gym.certificate.subject import Subject
from fo_gym.compensators import NoCompensation
from fo_gym.friction import FRICTIONLESS, LuGre
from fo_gym.reproduction.arms import ARM, FRICTION, Arm, run_arms
from fo_gym.reproduction.runs import PAPER
from fo_gym.simulation.settings import Settings
from fo_gym.tasks.regulation import regulation
from fo_gym.tasks.square import square
from fo_gym.tasks.task import TaskLike

__all__ = ["AS_IT_IS", "VARIATIONS", "Quantity", "Runs", "Variation", "finding", "held_arms", "square_arms"]

Runs = Mapping[str, Arm]
"""ideal and others on one arm, by name."""

Quantity = Callable[[Runs], float]
"""The number that decides a statement."""


@dataclass(frozen=True)
class Variation:
    """The arm with some numbers changed.

    Attributes:
        name: of it, in tables.
        bristle: factor on sigma_0; sigma_1 gets its square root, which keeps the bristle's damping ratio.
        ratio: f_s / f_c; None leaves it.
        stribeck: factor on v_s.
        damping: factor on the controller's damping gains.
    """

    name: str
    bristle: float = 1.0
    ratio: float | None = None
    stribeck: float = 1.0
    damping: float = 1.0

    def friction(self, law: LuGre) -> LuGre:
        """Friction of the arm that has this one."""
        return replace(
            law,
            sigma_0=law.sigma_0 * self.bristle,
            sigma_1=law.sigma_1 * np.sqrt(self.bristle),
            f_s=law.f_s if self.ratio is None else law.f_c * self.ratio,
            v_s=law.v_s * self.stribeck,
        )

    def gains(self, gains: Any) -> Any:
        """Gains of the controller that has these."""
        names = [each.name for each in fields(gains) if each.name.startswith("kd")]
        return replace(gains, **{name: getattr(gains, name) * self.damping for name in names})


AS_IT_IS = Variation("as it is")
VARIATIONS = (
    Variation("sigma_0 x 2", bristle=2.0),
    Variation("f_s / f_c = 1.5", ratio=1.5),
    Variation("v_s x 2", stribeck=2.0),
    Variation("K_d x 0.5", damping=0.5),
    Variation("sigma_0 x 0.5", bristle=0.5),
    Variation("f_s / f_c = 2.5", ratio=2.5),
    Variation("v_s x 0.5", stribeck=0.5),
    Variation("K_d x 2", damping=2.0),
)
"""Each number that no source gives, halved and doubled, or within what gears show; a quick run has the first half."""


def _runs(
    subject: Subject, names: tuple[str, ...], task: TaskLike, gains: Any, duration: float | None = None
) -> dict[str, Runs]:
    """The ideal motion and the named ones on the arm as it is and under every variation, by the variation's name."""
    count = len(VARIATIONS) // 2 if subject.quick else len(VARIATIONS)
    groups: dict[float, list[Variation]] = {}
    for variation in (AS_IT_IS, *VARIATIONS[:count]):
        groups.setdefault(variation.damping, []).append(variation)
    found: dict[str, Runs] = {}
    for group in groups.values():  # which share a controller
        settings = Settings(physics_dt=subject.physics_dt, duration=duration, gains=group[0].gains(gains))
        (ideal,) = run_arms({"ideal": NoCompensation()}, task, settings, frictions=[FRICTIONLESS])["ideal"]
        members = {name: subject.make(name) for name in names}
        arms = run_arms(members, task, settings, frictions=[each.friction(FRICTION) for each in group])
        for i, variation in enumerate(group):
            found[variation.name] = {"ideal": ideal, **{name: arms[name][i] for name in members}}
    return {name: found[name] for name in (each.name for each in (AS_IT_IS, *VARIATIONS)) if name in found}


@lru_cache(maxsize=1)
def held_arms(subject: Subject) -> dict[str, Runs]:
    """The regulation experiment with a minute to come to rest, by variation."""
    return _runs(subject, PAPER, regulation, ARM.pd_gains, 60.0)


@lru_cache(maxsize=1)
def square_arms(subject: Subject) -> dict[str, Runs]:
    """The square, by variation."""
    return _runs(subject, ("none", *PAPER), square, ARM.impedance_gains)


def finding(arms: Mapping[str, Runs], quantity: Quantity, unit: str, low: float, high: float, measured: str) -> Finding:
    """The quantity on the arm as it is, between `low` and `high`; what it would be otherwise is told in `measured`."""
    found = Finding(quantity(arms[AS_IT_IS.name]), unit, low, high, measured)
    others = []
    for name, runs in arms.items():
        if name != AS_IT_IS.name:
            other = replace(found, number=quantity(runs))
            turned = "" if other.holds == found.holds else " (which turns it)"
            others.append(f"{other.number:.3g} with {name}{turned}")
    return replace(found, measured=f"{measured}. It would be {', '.join(others)}")
