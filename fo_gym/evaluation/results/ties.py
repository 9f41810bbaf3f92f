"""Who is apart from whom: a test of every pair, corrected for their number, and the smallest difference that counts."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import t as student

from fo_gym.evaluation.episode.record import Array
from fo_gym.evaluation.results.statistics import stratified_difference

RELEVANT = 1e-3
"""The smallest difference in FRR that counts: a thousandth of what friction does to the motion.

Below it no robot could show the difference. Without compensation friction moves the tool of the square by 30 mm (RMS),
so that 1e-3 is 30 um there, and arms repeat a pose within 30 to 100 um (ISO 9283, data sheets of UR5e, Panda, iiwa
7). In regulation it is 0.09 mrad a joint, which is 0.07 mm at a reach of 0.8 m; on the single link 10 um of a step of
10 mm. It is also above what another processor changes in an episode that is not chaotic (4e-4 in the variant
"hardware", docs/processors.md).
"""

LEVEL = 0.02
"""What p must be below. So at most one table in twenty of competitors that are all the same shows two of them apart.

Yuen's test is liberal far out, where the correction looks: of simulated tables of 6 to 25 equal competitors with 10 to
40 seeds, with normal, exponential, t and uniform noise, up to 10.5 % show a pair apart at 0.05, and 1 to 5.3 % at 0.02.
"""

__all__ = ["LEVEL", "RELEVANT", "Difference", "compared_pairs", "holm", "paired_p", "tied_groups"]


@dataclass(frozen=True)
class Difference:
    """The paired difference of two rows.

    Attributes:
        mean: interquartile mean over the seeds, positive where the first is better.
        low, high: its 95 % bootstrap interval, of this pair alone.
        p: of the test that there is none, corrected for the number of pairs of the table.
    """

    mean: float = 0.0
    low: float = 0.0
    high: float = 0.0
    p: float = 1.0

    @property
    def turned(self) -> Difference:
        """The same, of the second row to the first."""
        return Difference(-self.mean, -self.high, -self.low, self.p)

    @property
    def tied(self) -> bool:
        """Whether the interval holds zero, or lies within `RELEVANT` of it, or p is not below `LEVEL`."""
        holds_zero = self.low <= 0.0 <= self.high
        irrelevant = self.low > -RELEVANT and self.high < RELEVANT
        return holds_zero or irrelevant or not self.p < LEVEL


def compared_pairs(
    rows: Mapping[str, Sequence[Array]], generator: Callable[[str, str], np.random.Generator]
) -> dict[tuple[str, str], Difference]:
    """The difference of every two competitors, either way round, p-values corrected by Holm.

    Args:
        rows: FRR of each competitor: one array per stratum, one number per seed.
        generator: of the bootstrap of two competitors, in alphabetical order.
    """
    names = sorted(rows)
    keys = list(combinations(names, 2))
    found = [Difference(*stratified_difference(rows[a], rows[b], generator(a, b))) for a, b in keys]
    corrected = holm([paired_p(rows[a], rows[b]) for a, b in keys])
    pairs = {(name, name): Difference() for name in names}
    for (a, b), difference, p in zip(keys, found, corrected, strict=True):
        pairs[a, b] = replace(difference, p=float(p))
        pairs[b, a] = pairs[a, b].turned
    return pairs


def paired_p(a: Sequence[ArrayLike], b: Sequence[ArrayLike]) -> float:
    """Two-sided p of the test that the mean over the strata of the interquartile means of a - b is zero.

    Yuen's trimmed t test (Biometrika 61, 1974) on the differences seed by seed: the variance of an interquartile mean
    is that of the winsorised differences, with as many degrees of freedom as there are differences left, less one;
    strata add up as in Welch's test. Unlike the bootstrap's, its tails are right far out, where the correction for two
    hundred pairs looks.

    Args:
        a: one array per stratum, one number per seed; seeds at which either is NaN are left out.
        b: the same strata and seeds.

    Returns:
        p; NaN if a stratum has no pair left. A stratum of a single episode has no spread: its difference counts as it
        is, and where there is nothing else p is 0, or 1 if there is no difference.
    """
    parts = [_trimmed(np.subtract(one, other)) for one, other in zip(a, b, strict=True)]
    means, variances, freedoms = np.array(parts).T
    if np.isnan(means).any():
        return math.nan
    mean, variance = float(np.sum(means)), float(np.sum(variances))
    if variance <= np.finfo(float).tiny:
        return float(mean == 0.0)
    freedom = variance**2 / float(np.sum(np.square(variances) / freedoms))
    return float(2.0 * student.sf(abs(mean) / math.sqrt(variance), freedom))


def _trimmed(differences: Array) -> tuple[float, float, float]:
    """Mean without the lowest and the highest quarter, its variance and its degrees of freedom; NaN values left out."""
    ordered = np.sort(differences[~np.isnan(differences)])
    count, cut = len(ordered), len(ordered) // 4
    if count == 0:
        return math.nan, math.nan, math.nan
    if count == 1:
        return float(ordered[0]), 0.0, 1.0
    left = count - 2 * cut
    winsorised = np.clip(ordered, ordered[cut], ordered[-1 - cut])
    spread = float(np.sum(np.square(winsorised - np.mean(winsorised))))
    return float(np.mean(ordered[cut : count - cut])), spread / (left * (left - 1)), left - 1.0


def holm(p_values: Sequence[float]) -> Array:
    """Holm's correction (Scand. J. Stat. 6, 1979): p-values for one level, however many there are.

    The smallest of m is multiplied by m, the next by m - 1, and so on; none becomes smaller than one before it, or
    larger than 1. Where all nulls are true, one or more fall below a level in at most that share of cases. NaN stays,
    and does not count.
    """
    values = np.asarray(p_values, dtype=np.float64)
    order = np.argsort(values, kind="stable")[: np.count_nonzero(~np.isnan(values))]
    corrected = np.full(len(values), math.nan)
    corrected[order] = np.minimum(np.maximum.accumulate(values[order] * np.arange(len(order), 0, -1)), 1.0)
    return corrected


def tied_groups(ties: NDArray[np.bool_]) -> list[str]:
    """The letters of each competitor: two that are tied share at least one, two that are not share none.

    A compact letter display (Piepho, J. Comput. Graph. Stat. 13, 2004, "insert and absorb"): being tied is not
    transitive, so that a competitor may belong to several groups. "a" is a group of the first competitor.

    Args:
        ties: (n, n), symmetric, whether i and j are tied; in the order of the table.

    Returns:
        One string per competitor, such as "a", "ab", "b".
    """
    groups = [frozenset(range(len(ties)))]
    for i, j in combinations(range(len(ties)), 2):
        if not ties[i, j]:
            split: list[frozenset[int]] = []
            for group in groups:
                split += [group - {i}, group - {j}] if {i, j} <= group else [group]
            groups = [one for one in dict.fromkeys(split) if not any(one < other for other in split)]
    ordered = sorted(groups, key=sorted)
    return ["".join(_letter(k) for k, group in enumerate(ordered) if i in group) for i in range(len(ties))]


def _letter(k: int) -> str:
    """a, b, ..., z, a1, b1, ..."""
    turns, place = divmod(k, 26)
    return chr(ord("a") + place) + (str(turns) if turns else "")
