"""The tables of docs/learning.md, from what was measured: `python docs/tables.py` puts them there."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

from fo_gym.evaluation.results.statistics import interquartile_mean, paired_difference
from fo_gym.evaluation.results.tables import Ranking, markdown
from fo_gym.evaluation.runs.episodes import SET, label_of
from fo_gym.files import read_csv
from fo_gym.tasks.variants import NOMINAL

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
POLICIES = ("rl-residual", "rl-direct")
ADAPTIVE = "rl-adaptive"
SHIPPED = (*POLICIES, ADAPTIVE)
BESIDE = {"hunting_ratio": "pid-high", "steady_state_error_ju": "pid-high", "torque_roughness_ratio": "pid-tuned"}
"""Further metrics of the adaptive compensator, and beside whom they are shown."""
PAPER = ("pid-low", "pid-high", "pd-low", "pd-high", "letien-low", "letien-high")


def _csv(file: Path) -> pd.DataFrame:
    return read_csv(file.read_text(encoding="utf-8"))


def learned() -> str:
    """FRR of the learned compensators beside the paper's observers and the tuned ones, from the leaderboard."""
    episodes = _csv(ROOT / "leaderboard" / "episodes.csv")
    cells = []
    for (env, robot, variant), rows in episodes.groupby(SET, sort=False):
        frr = rows.pivot(index="seed", columns="compensator", values="frr")
        mean = frr.apply(interquartile_mean)
        paper, tuned = str(mean[list(PAPER)].idxmax()), str(mean.filter(regex="-tuned$").idxmax())
        ratio = (1.0 - mean["rl-residual"]) / (1.0 - mean[paper])
        _, low, high = paired_difference(frr["rl-residual"], frr[paper], np.random.default_rng(0))
        shown = (f"{mean[name]:.4f}" for name in POLICIES)
        best, other = (f"{name} {mean[name]:.4f}" for name in (paper, tuned))
        cells.append(
            [label_of(env, robot, variant), best, *shown, f"{ratio:.2f}", f"{low:+.4f} ... {high:+.4f}", other]
        )
    headings = ["episodes", "best with the paper's gains", *POLICIES]
    headings += ["ratio of 1 - FRR", "paired difference, 95 %", "best tuned"]
    return markdown(Ranking("", headings, cells))


def outside() -> str:
    """1 - FRR inside and outside the training range, beside the observer that the policy is added to."""
    sweep = _csv(HERE / "sweep.csv")
    names = list(dict.fromkeys(sweep["compensator"]))
    cells = []
    for (env, parameter, factor), rows in sweep.groupby(["env", "parameter", "factor"], sort=False):
        if (parameter, factor) not in (("friction", 1.0), ("friction", 2.0), ("motor_inertia", 1.5)):
            continue
        mean = rows.set_index("compensator")["residual_mean"]
        what = "as scored" if factor == 1.0 else f"{parameter.replace('_', ' ')} x {factor:g}"
        ratio = mean["rl-residual"] / mean["pid-high"]
        cells.append([str(env), what, *(f"{mean[name]:.4f}" for name in names), f"{ratio:.2f}"])
    return markdown(Ranking("", ["environment", "episodes", *names, "rl-residual over pid-high"], cells))


def ticks() -> str:
    """Time of one control tick."""
    table = _csv(HERE / "ticks.csv")
    cells = [[name, f"{median:.3g}", f"{high:.3g}"] for name, _, median, high in table.itertuples(index=False)]
    return markdown(Ranking("", ["compensator", "median [us]", "99th percentile [us]"], cells))


def training() -> str:
    """How long the trainings of the shipped weights took, and how much of it the environment."""
    cells = []
    for name in SHIPPED:
        timing = _csv(ROOT / "baselines" / "rl" / "weights" / name / "timing.csv").sum()
        share = timing["environment_seconds"] / timing["seconds"]
        cells.append([name, f"{timing['seconds'] / 60:.1f} min", f"{100 * share:.0f} %"])
    return markdown(Ranking("", ["weights", "training", "of it the environment's"], cells))


def adaptive() -> str:
    """FRR of the adaptive compensator beside the best tuned classical row and the bound, from the leaderboard."""
    cells = []
    for (env, robot, variant), rows in _csv(ROOT / "leaderboard" / "episodes.csv").groupby(SET, sort=False):
        if variant == NOMINAL:
            continue  # one episode: no interval
        frr = rows.pivot(index="seed", columns="compensator", values="frr")
        mean = frr.apply(interquartile_mean)
        best = str(mean.filter(regex="-tuned$").idxmax())
        _, low, high = paired_difference(frr[ADAPTIVE], frr[best], np.random.default_rng(0))
        gap = (mean[ADAPTIVE] - mean[best]) / (mean["bound"] - mean[best])
        shown = (f"{mean[ADAPTIVE]:.4f}", f"{best} {mean[best]:.4f}", f"{low:+.4f} ... {high:+.4f}")
        others = (_beside(rows, metric, other) for metric, other in BESIDE.items())
        cells.append([label_of(env, robot, variant), *shown, f"{mean['bound']:.4f}", f"{gap:.2f}", *others])
    headings = ["episodes", ADAPTIVE, "best tuned", "paired difference, 95 %", "bound", "gap"]
    return markdown(Ranking("", [*headings, *(f"{metric}, {other}'s" for metric, other in BESIDE.items())], cells))


def _beside(rows: pd.DataFrame, metric: str, other: str) -> str:
    """A metric's means: of the adaptive compensator, and of another; nothing where it does not apply."""
    means = rows.groupby("compensator")[metric].mean()[[ADAPTIVE, other]]
    return "" if means.isna().all() else " / ".join(f"{value:.2g}" for value in means)


def adaptive_outside() -> str:
    """1 - FRR of the adaptive compensator and of the observer beneath it where nobody trained."""
    cells = []
    for _, row in _csv(HERE / "adaptive_outside.csv").iterrows():
        own, beneath = row["rl-adaptive"], row["the observer beneath"]
        cells.append(
            [row["case"], f"{row['env']}, {row['variant']}", f"{own:.4f}", f"{beneath:.4f}", f"{own / beneath:.2f}"]
        )
    return markdown(Ranking("", ["what", "episodes", "rl-adaptive", "the observer beneath", "ratio"], cells))


def told() -> str:
    """What the adaptive compensator leaves of zero and inertia error, by time."""
    table = _csv(HERE / "adaptive_told.csv").pivot(index="env", columns="time", values=["zero", "inertia"])
    cells = [
        [env, what, *(f"{value:.2f}" for value in table.loc[env, what])]
        for env in table.index
        for what in ("zero", "inertia")
    ]
    times = [f"{time:g} s" for time in table["zero"].columns]
    return markdown(Ranking("", ["episodes", "of the", *times], cells))


def ablated() -> str:
    """1 - FRR of the adaptive compensator with a part taken away, from docs/learning/ablation.csv."""
    table = _csv(HERE / "ablation.csv")
    cells = [[name, *(f"{value:.4f}" for value in values)] for name, *values in table.itertuples(index=False)]
    return markdown(Ranking("", list(table), cells))


LEARNING: dict[str, Callable[[], str]] = {
    "learned": learned,
    "outside": outside,
    "ticks": ticks,
    "training": training,
    "told": told,
    "adaptive": adaptive,
    "adaptive outside": adaptive_outside,
    "ablated": ablated,
}
"""What stands between the marks of each name."""
