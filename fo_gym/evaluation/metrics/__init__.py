"""Metrics: what an episode is worth, one small function each.

To add a metric, write a function from `Episode` to a number in the file of its family and decorate it with
`metric`; the column, its unit and its place in every table follow. NaN means "does not apply".

Another package adds metrics by naming the module that has them under the entry points `fo_gym.metrics`: worker
processes and the store then know them as well.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from importlib.metadata import entry_points

from fo_gym.evaluation.episode.record import Episode
from fo_gym.evaluation.metrics import cost, energy, estimate, hunting, interaction, rejection, rest, tracking
from fo_gym.evaluation.metrics.registry import HEADLINE, Metric, Tolerance, metric, metrics_of

GROUP = "fo_gym.metrics"
"""Entry points of modules that register metrics when they are imported."""

__all__ = ["GROUP", "METRICS", "Episode", "Metric", "Tolerance", "metric", "score"]

_FAMILIES = (rejection, rest, hunting, tracking, estimate, energy, interaction, cost)


class Metrics(Mapping[str, Metric]):
    """Every metric by its column name, in the order of the columns: the project's, then those of other packages.

    The modules of others are imported when a metric is first asked for: they import this package themselves.

    Raises:
        ValueError: one of these modules cannot be imported, or takes the name of another metric; it is named.
    """

    @cached_property
    def sources(self) -> tuple[str, ...]:
        """Modules of other packages that register metrics."""
        entries = sorted(entry_points(group=GROUP), key=lambda entry: entry.name)
        for entry in entries:
            try:
                entry.load()
            except Exception as error:
                raise ValueError(
                    f"the metrics of {entry.value} cannot be loaded: {type(error).__name__}: {error}; mend or "
                    "uninstall the package that has them"
                ) from error
        return tuple(dict.fromkeys(entry.module for entry in entries))

    @cached_property
    def _all(self) -> dict[str, Metric]:
        modules = (*(family.__name__ for family in _FAMILIES), *self.sources)
        return {each.name: each for module in modules for each in metrics_of(module)}

    def __getitem__(self, name: str) -> Metric:
        return self._all[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)


METRICS = Metrics()


def score(episode: Episode) -> dict[str, float]:
    """Every metric of one episode, in the order of `METRICS`.

    An episode that ended early has no rest, no complete path and no comparable effort: all but the friction
    rejection ratio, which counts the frozen remainder of its motion, are NaN.
    """
    if episode.termination:
        return {name: each.function(episode) if name == HEADLINE else math.nan for name, each in METRICS.items()}
    return {name: each.function(episode) for name, each in METRICS.items()}
