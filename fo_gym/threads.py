"""Threads of a batch: how many there are, and which environments each of them takes. Nobody else decides."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from typing import Any

from fo_gym.checks import shown, whole_number
from fo_gym.crew import Crew

VARIABLE = "FO_GYM_NUM_THREADS"
"""Environment variable that says how many threads a batch has that is not told."""

MAX_THREADS = 256

_LEAST_WORK = 256
"""Joints of a thread, and two more for every environment: less is done sooner than a thread wakes."""

__all__ = ["MAX_THREADS", "VARIABLE", "Threads", "number_of_threads"]


def number_of_threads(wanted: Any) -> int:
    """As many as are asked for; None asks for what FO_GYM_NUM_THREADS says, and where it says nothing for one.

    Raises:
        ValueError: it is no whole number from 1 to MAX_THREADS.
    """
    if wanted is not None:
        return whole_number("num_threads", wanted, 1, MAX_THREADS)
    said = os.environ.get(VARIABLE, "").strip() or "1"
    if not said.isdecimal():
        raise ValueError(f"{VARIABLE} is {shown(said)}; give a whole number from 1 to {MAX_THREADS}, or unset it")
    return whole_number(VARIABLE, int(said), 1, MAX_THREADS)


class Threads:
    """Shares the environments of a batch among threads; what they compute does not depend on how many there are.

    Args:
        num_envs: size of the batch.
        dof: joints of an environment.
        wanted: threads at most; a small batch has fewer.

    Attributes:
        count: of threads.
        shares: (first, last) environment of every thread, this one's first.
    """

    def __init__(self, num_envs: int, dof: int, wanted: int) -> None:
        self.count = max(1, min(wanted, num_envs * (dof + 2) // _LEAST_WORK))
        self.shares = list(pairwise(num_envs * share // self.count for share in range(self.count + 1)))

    def run(self, works: Sequence[Callable[[], object]]) -> None:
        """Call every thread's work, or the only one, and wait for all of them; see `fo_gym.crew`.

        Raises:
            BaseException: what one of them raised.
        """
        if self.count == 1:
            works[0]()
        else:
            _crew(self.count - 1).run(works)


@cache
def _crew(helpers: int) -> Crew:
    """The threads beside this one; batches with as many of them, which are stepped in turn, share them."""
    return Crew(helpers)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_crew.cache_clear)  # a forked process has none of its parent's threads
