"""Who is apart from whom: a test of every pair, corrected for their number, and the smallest difference that counts."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import wilcoxon

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

LEVEL = 0.05
"""What p must be below: at most one table in twenty of competitors that are all the same shows two of them apart."""

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
    """Two-sided p of the test that a is better than b as often, and by as much, as the other way round.

    Wilcoxon's signed-rank test (Biometrics Bulletin 1, 1945; for comparisons of methods: Demsar, JMLR 7, 2006) of the
    differences seed by seed, the mean over the strata. It asks of equals only that their differences are symmetric. A
    t test would find who is lost in every episode, by any amount, too scattered to be apart from anybody.

    Args:
        a: one array per stratum, one number per seed; seeds at which one is NaN are left out, and those beyond the
            shortest stratum.
        b: the same strata and seeds.

    Returns:
        p; NaN if no seed is left. A single one has nothing to test: its difference counts as it is, p is 0, or 1 if
        there is none.
    """
    count = min(map(np.size, a))
    differences = np.mean([np.subtract(x, y)[:count] for x, y in zip(a, b, strict=True)], axis=0)
    differences = differences[~np.isnan(differences)]
    if not len(differences):
        return math.nan
    if len(differences) == 1 or not differences.any():
        return float(not differences.any())
    return float(wilcoxon(differences).pvalue)


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
