"""A measurement, and the rows that come of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass

import numpy as np

from fo_gym.bench.bars import BARS, MORE_IS_BETTER, NOT_MEASURED, verdict
from fo_gym.bench.measure import Array, Subject, interleaved, spread
from fo_gym.bench.size import Size
from fo_gym.extras import install_command

Row = dict[str, object]
Tables = dict[str, list[Row]]
"""Rows by the name of their table."""

RATIOS, GROWTHS, PRECISION, MEMORY, JOB = "bench", "growth", "precision", "memory", "job"
"""Tables: ratios, the times whose growth they tell, the errors that make accuracy equal, memory, and shares of a job.
"""

__all__ = [
    "GROWTHS",
    "JOB",
    "MEMORY",
    "PRECISION",
    "RATIOS",
    "Comparison",
    "Measurement",
    "Row",
    "Tables",
    "ratio_row",
    "rows_without",
]


@dataclass(frozen=True)
class Measurement:
    """Something to be measured.

    Attributes:
        label: what to call it.
        run: measures it.
    """

    label: str
    run: Callable[[], Tables]


def ratio_row(
    env_id: str,
    measured: str,
    beside: str,
    num_envs: int,
    ratios: Array,
    *,
    ours: Array,
    theirs: Array,
    note: str = "",
) -> Row:
    """A row of ratios.

    Args:
        env_id: environment.
        measured: see `fo_gym.bench.bars`.
        beside: the peer.
        num_envs: of ours.
        ratios: one per round, (repeats,).
        ours: seconds per environment and control period, (repeats,).
        theirs: likewise.
        note: what else there is to say.
    """
    ratio = spread(ratios)
    bar = BARS.get((env_id, measured, beside, num_envs), np.nan)
    return {
        "env": env_id,
        "measured": measured,
        "beside": beside,
        "num_envs": num_envs,
        "ratio": ratio.median,
        "q1": ratio.q1,
        "q3": ratio.q3,
        "bar": bar,
        "verdict": verdict(measured, ratio.median, bar),
        "ours_us": 1e6 * spread(ours).median,
        "peer_us": 1e6 * spread(theirs).median,
        "note": note,
    }


def rows_without(
    error: ModuleNotFoundError, env_id: str, measured: str, peers: Sequence[str], num_envs: int
) -> list[Row]:
    """The rows of peers that are not installed: no numbers, and how to get them."""
    nothing = np.full(1, np.nan)
    reason = f"{NOT_MEASURED}: {error}; install it with: {install_command('bench')}"
    rows = (ratio_row(env_id, measured, peer, num_envs, nothing, ours=nothing, theirs=nothing) for peer in peers)
    return [row | {"verdict": reason} for row in rows]


@dataclass(frozen=True)
class Comparison:
    """What is timed by turns: ours, and its peers.

    Attributes:
        env_id: environment.
        measured: see `fo_gym.bench.bars`.
        num_envs: of ours.
        peers: their names.
        open: gives what is timed, ours first, then the peers. Raises ModuleNotFoundError where one is not installed.
        peer_counts: what a call of each peer counts as, in environments and control periods; None for `num_envs`.
        notes: what else there is to say of each peer.
    """

    env_id: str
    measured: str
    num_envs: int
    peers: tuple[str, ...]
    open: Callable[[], AbstractContextManager[list[Subject]]]
    peer_counts: int | None = None
    notes: tuple[str, ...] = ()

    def rows(self, size: Size) -> list[Row]:
        """One for each peer."""
        try:
            with self.open() as subjects:
                ours, *peers = interleaved(subjects, size.repeats, size.slice_seconds).T
        except ModuleNotFoundError as error:  # peers are heavy, and nothing else here needs them
            return rows_without(error, self.env_id, self.measured, self.peers, self.num_envs)
        ours = ours / self.num_envs
        notes = self.notes or ("",) * len(self.peers)
        rows = []
        for peer, times, note in zip(self.peers, peers, notes, strict=True):
            theirs = times / (self.peer_counts or self.num_envs)
            ratios = theirs / ours if self.measured in MORE_IS_BETTER else ours / theirs
            named = self.env_id, self.measured, peer, self.num_envs
            rows.append(ratio_row(*named, ratios, ours=ours, theirs=theirs, note=note))
        return rows

    def measurement(self, size: Size) -> Measurement:
        """To be made at this size."""
        label = f"{self.env_id}, {self.measured} of {self.num_envs}, beside {', '.join(self.peers)}"
        return Measurement(label, lambda: {RATIOS: self.rows(size)})
