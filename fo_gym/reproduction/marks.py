"""What of arXiv:1907.00553 lies on a map of gains: both sets of gains, and the condition L_p^2 > 2 L_i."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fo_gym.compensators import CompensatorError
from fo_gym.evaluation.results.map import Map
from fo_gym.evaluation.results.map_drawing import Marks
from fo_gym.reproduction.runs import GAINS
from fo_gym.tasks.variants import NOMINAL

_SMALL = 1e-9
"""An L_i that no L_p refuses."""

__all__ = ["paper_marks"]


def paper_marks(plan: Map) -> Marks:
    """The paper's gains that lie in the plane of a map, and on one over L_i the line L_p^2 = 2 L_i.

    A set lies in the plane where the compensator that is made with its x and y has all of its gains: the paper's
    observers have them as attributes. On maps of other compensators, or of friction, nothing is marked.
    """
    x, y = plan.x[0], plan.y[0]
    if not {x, y} <= set(GAINS["low"]) or plan.competitor.guarded:
        return Marks()
    points = {}
    for level, gains in GAINS.items():
        made = _attributes(plan, {x: gains[x], y: gains[y]})
        if made and all(made[name] == gains[name] for name in gains if name in made):
            points[f"paper's {level} gains"] = (gains[x], gains[y])
    return Marks(points, *_condition(plan))


def _attributes(plan: Map, gains: Mapping[str, float]) -> Mapping[str, Any]:
    """What the compensator with these gains has of the paper's; nothing where it is refused."""
    try:
        made = plan.competitor.with_gains(gains).make(plan.episode.env_id, NOMINAL)
    except (ValueError, TypeError, CompensatorError):
        return {}
    return {name: getattr(made, name) for name in GAINS["low"] if hasattr(made, name)}


def _condition(plan: Map) -> tuple[Any, str]:
    """The points (n, 2) of L_p^2 = 2 L_i over x and its name; None where y is not L_i."""
    x, values = plan.x
    if plan.y[0] != "Li":
        return None, ""
    made = [_attributes(plan, {x: value, "Li": _SMALL}) for value in values]
    line = [(value, each["Lp"] ** 2 / 2.0) for value, each in zip(values, made, strict=True) if "Lp" in each]
    return (np.array(line), "$L_p^2 = 2 L_i$") if line else (None, "")
