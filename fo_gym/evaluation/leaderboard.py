"""From episodes to the leaderboard: one row per environment, variant and competitor, and who beats whom."""

from __future__ import annotations

import hashlib

import numpy as np
import pandas as pd

from fo_gym.compensators import BUILT_IN
from fo_gym.evaluation.evaluate import FAILED, OK, TERMINATED
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.statistics import bootstrap_interval, interquartile_mean, paired_difference, tied

KEY = ["env", "variant", "compensator"]
SET = ["env", "variant"]

__all__ = ["KEY", "SET", "leaderboard", "standings"]


def _generator(*names: str) -> np.random.Generator:
    """A generator of its own for every row, so that adding a competitor leaves the other intervals alone."""
    digest = hashlib.sha256("/".join(names).encode()).digest()
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


def leaderboard(episodes: pd.DataFrame) -> pd.DataFrame:
    """One row per environment, variant and competitor, in the order of `episodes`.

    Metrics are interquartile means over the seeds; frr has a 95 % bootstrap interval.

    Args:
        episodes: rows as `evaluate` gives them.

    Returns:
        env, variant, compensator, status, error, episodes, frr, frr_ci_low, frr_ci_high, the other metrics,
        joint_unit, provenance.
    """
    provenance = [name for name in map(str, episodes) if name == "protocol" or name.startswith("version_")]
    table = []
    for key, group in episodes.groupby(KEY, sort=False):
        env, variant, name = (str(part) for part in key)
        status, error = _status(group)
        low, high = bootstrap_interval(group["frr"].to_numpy(), _generator(env, variant, name))
        scores = {metric: interquartile_mean(group[metric].to_numpy()) for metric in METRICS}
        table.append(
            {
                "env": env,
                "variant": variant,
                "compensator": name,
                "status": status,
                "error": error,
                "episodes": len(group),
                "frr": scores.pop("frr"),
                "frr_ci_low": low,
                "frr_ci_high": high,
                **scores,
                **group[["joint_unit", *provenance]].iloc[0],
            }
        )
    return pd.DataFrame(table)


def standings(episodes: pd.DataFrame) -> pd.DataFrame:
    """Rank and verdict of every competitor in its set, by frr.

    The leader has the highest frr; every other competitor is compared with it seed by seed.

    Returns:
        env, variant, compensator, rank (1 = best; the built-in references and failed rows have none) and verdict:
        "best", "tied" (the interval of the paired difference to the best holds zero), "behind", or "".
    """
    table = leaderboard(episodes)
    scored = table[~table["compensator"].isin(BUILT_IN) & table["frr"].notna()]
    result = []
    for key, group in scored.groupby(SET, sort=False):
        env, variant = (str(part) for part in key)
        here = episodes[(episodes["env"] == env) & (episodes["variant"] == variant)]
        by_name = here.pivot_table(index="seed", columns="compensator", values="frr")
        ordered = group.sort_values("frr", ascending=False, kind="stable")["compensator"].tolist()
        best = ordered[0]
        for rank, name in enumerate(ordered, start=1):
            _, low, high = paired_difference(by_name[best], by_name[name], _generator(env, variant, name, "paired"))
            verdict = "best" if name == best else "tied" if tied(low, high) else "behind"
            result.append({"env": env, "variant": variant, "compensator": name, "rank": rank, "verdict": verdict})
    return pd.DataFrame(result, columns=[*KEY, "rank", "verdict"])
