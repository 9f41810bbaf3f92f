"""Timing by turns: what is compared runs in the same seconds on the same machine, and only ratios count."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from timeit import Timer
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Clock = Callable[[], float]

__all__ = ["Clock", "Spread", "Subject", "calls_per_slice", "interleaved", "seconds", "spread"]


@dataclass(frozen=True)
class Subject:
    """Something whose speed is measured.

    Attributes:
        call: what is timed.
        prepare: puts it back to its start before every slice, so that all slices are the same work; not timed.
    """

    call: Callable[[], object]
    prepare: Callable[[], object]


class Spread(NamedTuple):
    """What a few measurements have in common: their median, and the quartiles around it."""

    median: float
    q1: float
    q3: float


def spread(values: Array) -> Spread:
    """Median, lower and upper quartile of the values, (n,)."""
    q1, median, q3 = np.quantile(values, (0.25, 0.5, 0.75))
    return Spread(float(median), float(q1), float(q3))


def seconds(subject: Subject, calls: int, clock: Clock = time.perf_counter) -> float:
    """Time of one slice of that many calls [s], from the subject's start, without garbage collection."""
    subject.prepare()
    subject.call()  # the caches are still full of what came before
    return Timer(subject.call, timer=clock).timeit(calls)


def calls_per_slice(subject: Subject, slice_seconds: float, clock: Clock = time.perf_counter) -> int:
    """How many calls take about `slice_seconds`; at least one. It warms the subject up, too."""
    calls = 1
    while (taken := seconds(subject, calls, clock)) < 0.5 * slice_seconds:
        calls *= 2
    return max(1, round(calls * slice_seconds / taken))


def interleaved(
    subjects: Sequence[Subject], repeats: int, slice_seconds: float, clock: Clock = time.perf_counter
) -> Array:
    """Seconds per call of every subject in every round, (repeats, subjects).

    A round times one slice of each in turn. Every other round goes backwards, so that over two rounds nobody comes
    before another more often than after it, and a machine that slows down steadily slows everybody alike.
    """
    calls = [calls_per_slice(subject, slice_seconds, clock) for subject in subjects]
    times = np.empty((repeats, len(subjects)))
    for turn in range(repeats):
        order = range(len(subjects))
        for i in order if turn % 2 == 0 else reversed(order):
            times[turn, i] = seconds(subjects[i], calls[i], clock) / calls[i]
    return times
