"""From episodes to the leaderboard: one row per environment, variant and competitor, and who beats whom."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import rankdata

from fo_gym.evaluation.competitors.competitor import BASELINE
from fo_gym.evaluation.episode.record import Array
from fo_gym.evaluation.metrics import METRICS, Metric
from fo_gym.evaluation.results.statistics import (
    interquartile_mean,
    rank_intervals,
    stratified_interval,
    stratified_mean,
)
from fo_gym.evaluation.results.ties import Difference, compared_pairs, tied_groups
from fo_gym.evaluation.runs.episodes import FAILED, KEY, OK, SET, TERMINATED, place_of
from fo_gym.evaluation.runs.provenance import is_provenance, is_reference
from fo_gym.specs import spec_of

OVERALL = "overall"
"""What stands in the column env where all environments count together."""

TO_BEST = ["frr_to_best", "frr_to_best_ci_low", "frr_to_best_ci_high", "frr_to_best_p"]
TO_BASELINE = ["frr_to_baseline", "frr_to_baseline_ci_low", "frr_to_baseline_ci_high"]
STANDING = ["rank", "rank_ci_low", "rank_ci_high", "tied_group", "verdict", *TO_BEST, *TO_BASELINE]
"""Columns that compare a row with the others of its set; empty for references and rows without a score."""

_Row = list[Any]

__all__ = ["OVERALL", "STANDING", "is_baseline", "leaderboard", "overall", "standings"]


def is_baseline(name: str, origin: str, *, learned: bool) -> bool:
    """Whether a row is a classical baseline, as the difference to the best baseline means it.

    That is a registered compensator that did not learn.

    Args:
        name: of the compensator. "module:Class" and files are none.
        origin: where it comes from; submissions and references are none. "" (outside a protocol) says nothing.
        learned: whether it says that it learned; such are none.
    """
    return origin in (BASELINE, "") and not learned and spec_of(name).kind == "name"


def leaderboard(episodes: pd.DataFrame) -> pd.DataFrame:
    """One row per environment, robot, variant and competitor, in the order of `episodes`.

    Metrics are interquartile means over the seeds, shares of episodes where they are 1 or 0 in one, and of hunting its
    size and period where there is some; frr has a 95 % bootstrap interval.

    Args:
        episodes: rows as `evaluate` gives them.

    Returns:
        env, robot, variant, compensator, status, error, episodes, frr, frr_ci_low, frr_ci_high, `STANDING` (see
        `standings`), the other metrics, joint_unit, provenance.
    """
    others = [metric for metric in METRICS if metric != "frr"]
    table = []
    for key, group in episodes.groupby(KEY, sort=False):
        name = [str(part) for part in key]
        scores = {metric: _told_of(METRICS[metric], group) for metric in others}
        headline = _headline(group, [group["frr"].to_numpy()], name)
        told = _told(group, ["joint_unit"])
        table.append({**dict(zip(KEY, name, strict=True)), **headline, **scores, **told})
    return _with_standings(pd.DataFrame(table), standings(episodes))


def overall(episodes: pd.DataFrame) -> pd.DataFrame:
    """One row per variant and competitor over all environments and robots of the variant, each counting the same.

    frr is the mean over the environments of the interquartile means; intervals resample the seeds within each
    environment on its own. (Both arm environments draw the same arm from the same seed; at a correlation of 0.5
    between them a 95 % interval holds the true value in 92 % of cases.) Who has no score in one of the environments
    has none here. Variants with a single environment have no rows.

    Args:
        episodes: rows as `evaluate` gives them.

    Returns:
        The columns of `leaderboard` without the other metrics and joint_unit; env is "overall", robot "".
    """
    table, compared = [], list[_Row]()
    for variant, rows in episodes.groupby("variant", sort=False):
        everybody = rows["compensator"].unique()
        strata = [_by_seed(part).reindex(columns=everybody) for _, part in rows.groupby(SET, sort=False)]
        if len(strata) < 2:
            continue
        label = [OVERALL, "", str(variant)]
        for name, group in rows.groupby("compensator", sort=False):
            headline = _headline(group, [values[name].to_numpy() for values in strata], [*label, str(name)])
            table.append({**dict(zip(KEY, [*label, str(name)], strict=True)), **headline, **_told(group, [])})
        compared += _compared(strata, label, rows)
    if not table:
        return pd.DataFrame(columns=[*KEY, *STANDING])
    return _with_standings(pd.DataFrame(table), pd.DataFrame(compared, columns=[*KEY, *STANDING]))


def standings(episodes: pd.DataFrame) -> pd.DataFrame:
    """Rank and comparisons of every competitor in its set (environment, robot and variant), by frr.

    References and rows without a score are left out. All intervals are 95 % bootstrap intervals over the
    seeds; differences are paired, seed by seed, and positive where the row is better than what it is compared with.
    With one episode every interval is its value. Whether two rows are tied says `Difference.tied`.

    Args:
        episodes: rows as `evaluate` gives them.

    Returns:
        env, robot, variant, compensator, and, best first in every set:
        rank (1 = best, equal values share the better one), rank_ci_low, rank_ci_high;
        tied_group: letters; two rows are tied where they share one;
        verdict: "best", "tied" (with the best) or "behind";
        frr_to_best: difference to the best row, with frr_to_best_ci_low, frr_to_best_ci_high, and frr_to_best_p, the
        p-value of no difference, corrected for the number of all pairs of the set;
        frr_to_baseline: difference to the best baseline (`is_baseline`), with its interval; empty without one.
    """
    compared: list[_Row] = []
    for key, rows in episodes.groupby(SET, sort=False):
        compared += _compared([_by_seed(rows)], [str(part) for part in key], rows)
    return pd.DataFrame(compared, columns=[*KEY, *STANDING])


def _generator(env_id: str, robot: str, *names: str) -> np.random.Generator:
    """A generator of its own for every number, so that adding a competitor or a robot leaves other intervals alone."""
    digest = hashlib.sha256("/".join([place_of(env_id, robot), *names]).encode("utf-8", "surrogatepass")).digest()
    return np.random.default_rng(int.from_bytes(digest[:8], "little"))


def _status(group: pd.DataFrame) -> tuple[str, str]:
    failed = group[group["status"] == FAILED]
    if len(failed):
        return FAILED, str(failed["error"].iloc[0])
    ended = group[group["status"] == TERMINATED]
    if len(ended):
        return TERMINATED, f"{len(ended)} of {len(group)} episodes ended early, the first: {ended['error'].iloc[0]}"
    missing = int(group["frr"].isna().sum())
    return OK, f"frr does not apply to {missing} of {len(group)} episodes" if missing else ""


def _headline(group: pd.DataFrame, strata: Sequence[Array], name: Sequence[str]) -> dict[str, object]:
    """How the episodes of a row went, and its frr with its interval."""
    status, error = _status(group)
    low, high = stratified_interval(strata, _generator(*name))
    frr = {"frr": stratified_mean(strata), "frr_ci_low": low, "frr_ci_high": high}
    return {"status": status, "error": error, "episodes": len(group), **frr}


def _told_of(metric: Metric, group: pd.DataFrame) -> float:
    """What a row says of a metric: see `Metric.share` and `Metric.where`; NaN where it applies to no episode."""
    values = group[metric.name].to_numpy(dtype=np.float64)
    if metric.where:
        values = values[group[metric.where].to_numpy() == 1.0]
    if metric.share:
        values = values[~np.isnan(values)]
        return float(np.mean(values)) if len(values) else np.nan
    return interquartile_mean(values)


def _told(group: pd.DataFrame, more: list[str]) -> dict[str, object]:
    """The columns `more` of a row, then its provenance."""
    columns = [*more, *(name for name in map(str, group) if is_provenance(name))]
    return {str(name): value for name, value in group[columns].iloc[0].items()}


def _baselines(rows: pd.DataFrame) -> set[str]:
    """Names of the classical baselines among the competitors of these rows."""
    told = rows.drop_duplicates("compensator")[["compensator", "origin", "learned"]].itertuples(index=False)
    return {str(name) for name, origin, learned in told if is_baseline(str(name), str(origin), learned=bool(learned))}


def _with_standings(table: pd.DataFrame, compared: pd.DataFrame) -> pd.DataFrame:
    """The table with the columns `STANDING` after the headline's interval."""
    columns = list(table)
    place = columns.index("frr_ci_high") + 1
    return table.merge(compared, on=KEY, how="left")[[*columns[:place], *STANDING, *columns[place:]]]


def _by_seed(rows: pd.DataFrame) -> pd.DataFrame:
    """The frr of one set, a row per seed and a column per competitor, in the order of the rows."""
    return rows.pivot(index="seed", columns="compensator", values="frr")[rows["compensator"].unique()]


def _compared(strata: Sequence[pd.DataFrame], label: Sequence[str], rows: pd.DataFrame) -> list[_Row]:
    """Rows of `standings` for competitors that met the same strata, each as `_by_seed` gives it of these rows."""
    references, baselines = set(rows.loc[is_reference(rows), "compensator"]), _baselines(rows)
    means = {str(name): stratified_mean([values[name] for values in strata]) for name in strata[0]}
    scored = {name: mean for name, mean in means.items() if name not in references and not np.isnan(mean)}
    names = sorted(scored, key=scored.__getitem__, reverse=True)
    if not names:
        return []
    numbers = {name: [values[name].to_numpy() for values in strata] for name in names}
    pairs = compared_pairs(numbers, lambda one, other: _generator(*label, one, other, "paired"))
    ties = np.array([[pairs[one, other].tied for other in names] for one in names])
    ranks = rankdata([-scored[name] for name in names], method="min")
    intervals = rank_intervals([values[names].to_numpy() for values in strata], _generator(*label, "ranks"))
    best, baseline = names[0], next((name for name in names if name in baselines), None)
    standing_rows: list[_Row] = []
    for i, (name, group) in enumerate(zip(names, tied_groups(ties), strict=True)):
        verdict = "best" if name == best else "tied" if ties[0, i] else "behind"
        to_best = pairs[name, best]
        against = [to_best.mean, to_best.low, to_best.high, to_best.p, *_interval(pairs, name, baseline)]
        standing = [ranks[i], *intervals[i], group, verdict, *against]
        standing_rows.append([*label, name, *standing])
    return standing_rows


def _interval(pairs: Mapping[tuple[str, str], Difference], name: str, other: str | None) -> tuple[float, float, float]:
    """The difference of a row to another one with its interval; NaN where there is none."""
    if other is None:
        return (np.nan,) * 3
    return pairs[name, other].mean, pairs[name, other].low, pairs[name, other].high
