"""What may be tuned: the gains that a compensator declares, and where they start."""

from __future__ import annotations

import math
from collections.abc import Mapping

from fo_gym.compensators import declared_gains
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.competitors.guard.proxy import Guarded

Space = Mapping[str, tuple[float, float]]

__all__ = ["Space", "default_gains", "search_space"]


def _declared(spec: str) -> Mapping[str, tuple[float, float, float]]:
    """Gains with their range and the compensator's own value, as `declared_gains` has them."""
    with Competitor(spec, spec).playing("", "") as compensator:
        return compensator.declared() if isinstance(compensator, Guarded) else declared_gains(compensator)


def search_space(spec: str) -> Space:
    """The gains of a compensator with their ranges, searched on a logarithmic scale: its attribute `search_space`.

    Raises:
        ValueError: it declares none, or a range is not 0 < low < high.
    """
    space = {name: (low, high) for name, (low, high, _) in _declared(spec).items()}
    if not space:
        raise ValueError(
            f"compensator {spec!r} declares no gains to tune; give its class an attribute "
            'search_space = {"gain": (low, high), ...}'
        )
    for name, (low, high) in space.items():
        if not 0 < low < high < math.inf:
            raise ValueError(f"compensator {spec!r}: search_space[{name!r}] is ({low}, {high}); give 0 < low < high")
    return space


def default_gains(spec: str) -> dict[str, float]:
    """The gains that a compensator has by default: the attributes that are named as in its `search_space`.

    Raises:
        ValueError: an attribute is missing.
    """
    own = {name: value for name, (_, _, value) in _declared(spec).items()}
    missing = [name for name, value in own.items() if math.isnan(value)]
    if missing:
        raise ValueError(f"compensator {spec!r} has no attributes {missing}; the search starts from them")
    return own
