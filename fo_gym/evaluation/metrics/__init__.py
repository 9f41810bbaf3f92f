"""Metrics: what an episode is worth, one small function each.

To add a metric, write a function from `Episode` to a number in the file of its family and decorate it with
`metric`; the column, its unit and its place in every table follow. NaN means "does not apply".
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

from fo_gym.evaluation.episode.record import Episode
from fo_gym.evaluation.metrics import cost, energy, estimate, rejection, rest, tracking
from fo_gym.evaluation.metrics.registry import HEADLINE, Metric, metrics_of

__all__ = ["METRICS", "Metric", "score"]

_FAMILIES = (rejection, rest, tracking, estimate, energy, cost)

METRICS: Mapping[str, Metric] = MappingProxyType(
    {each.name: each for family in _FAMILIES for each in metrics_of(family.__name__)}
)
"""Every metric by its column name, in the order of the columns."""


def score(episode: Episode) -> dict[str, float]:
    """Every metric of one episode, in the order of `METRICS`.

    An episode that ended early has no rest, no complete path and no comparable effort: all but the friction
    rejection ratio, which counts the frozen remainder of its motion, are NaN.
    """
    if episode.termination:
        return {name: each.function(episode) if name == HEADLINE else math.nan for name, each in METRICS.items()}
    return {name: each.function(episode) for name, each in METRICS.items()}
