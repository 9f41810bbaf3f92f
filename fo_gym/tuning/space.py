"""What may be tuned: the gains that a compensator declares, and where they start."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fo_gym.compensators import make_compensator

Space = Mapping[str, tuple[float, float]]

__all__ = ["Space", "default_gains", "search_space"]


def search_space(spec: str) -> Space:
    """The gains of a compensator with their ranges, searched on a logarithmic scale: its attribute `search_space`.

    Raises:
        ValueError: it declares none, or a range is not 0 < low < high.
    """
    compensator: Any = make_compensator(spec)
    space: Space = getattr(compensator, "search_space", {})
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
    compensator = make_compensator(spec)
    missing = [name for name in search_space(spec) if not hasattr(compensator, name)]
    if missing:
        raise ValueError(f"compensator {spec!r} has no attributes {missing}; the search starts from them")
    return {name: float(getattr(compensator, name)) for name in search_space(spec)}
