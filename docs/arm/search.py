"""Search the arm's friction: `python docs/arm/search.py` writes search.csv beside this file, in a quarter of an hour.

Screened are points of two Sobol sequences, a wide and a narrower one, and a grid of round numbers, each on the
regulation experiment of 20 s under the PD- and the PID-type at low gains. The best of the wide one that rest and
hunt as they should are held on under all of the paper's observers; theirs are the rows with a verdict.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import qmc

import fo_gym
from fo_gym.files import atomic, csv
from fo_gym.friction import LuGre
from fo_gym.reproduction.arms import ARM, Arm, run_arms
from fo_gym.reproduction.runs import PAPER
from fo_gym.simulation.settings import Settings
from fo_gym.tasks.regulation import regulation

Array = NDArray[np.float64]

HERE = Path(__file__).parent
NUMBERS = ["f_c", "ratio", "v_s", "sigma_2", "deflection"]
"""f_c of joints 1 to 4 [N m], f_s / f_c, v_s [rad/s], sigma_2 [N m s/rad], f_c / sigma_0 [rad]."""
WRIST = np.array([1.0] * 4 + [0.75] * 3)
"""Friction of the joints, as shares of f_c."""
PAPER_ERRORS = 3.6, 1.9
"""Where the paper's joint 2 rests under the PD-type at low gains, before and after the push [mrad]."""
JOINT, BATCH, BEST = 1, 64, 15


@dataclass(frozen=True)
class Stage:
    """Where is searched, log-uniformly.

    Attributes:
        low, high: ends of the ranges, in the order of NUMBERS.
        count: of points.
        seed: of the sequence.
        physics_dt: micro-step [s]; the hardest bristles ask for a shorter one than the default.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    count: int
    seed: int
    physics_dt: float

    def points(self) -> Array:
        """Where it looks, (count, 5)."""
        low, high = np.array(self.low), np.array(self.high)
        sequence = qmc.Sobol(len(low), seed=self.seed)
        return np.asarray(low * (high / low) ** sequence.random(self.count))


WIDE = Stage((3.5, 1.5, 1e-3, 2.4, 4e-5), (8.0, 2.8, 1e-2, 4.0, 1.2e-4), 512, 2, 1.25e-4)
NARROW = Stage((5.0, 1.9, 1.5e-3, 2.4, 5.5e-5), (7.5, 2.5, 5e-3, 3.3, 1.2e-4), 256, 3, 2e-4)
AXES = (5.2, 5.35, 5.5), (2.0, 2.15, 2.3), (2e-3, 2.25e-3, 2.5e-3), (np.sqrt(10.0),), (1e-4,)
"""Of the grid, in the order of NUMBERS."""


def law_of(point: Array) -> LuGre:
    """The friction that a point stands for; its bristles are damped by a half."""
    f_c, ratio, v_s, sigma_2, deflection = point
    levels = f_c * WRIST
    sigma_0 = levels / deflection
    return LuGre(sigma_0, np.sqrt(sigma_0 * ARM.flexible.motor_inertia), sigma_2, levels, ratio * levels, v_s)


def run(names: tuple[str, ...], points: Array, duration: float, physics_dt: float) -> dict[str, list[Arm]]:
    """The named ones on an arm for every point."""
    members = {name: fo_gym.make_compensator(name) for name in names}
    settings = Settings(duration=duration, physics_dt=physics_dt)
    return run_arms(members, regulation, settings, frictions=[law_of(point) for point in points])


def span(arm: Arm, start: float, end: float) -> float:
    """Peak to peak of joint 2 [mrad]."""
    return float(np.ptp(arm.errors(start, end, JOINT)))


def screened(stage: str, points: Array, physics_dt: float) -> pd.DataFrame:
    """Where the PD-type rests, whether it rests, and how far the PID-type moves [mrad]."""
    rows = []
    for batch in np.array_split(points, -(-len(points) // BATCH)):
        arms = run(("pd-low", "pid-low"), batch, 20.0, physics_dt)
        for point, pd_low, pid_low in zip(batch, arms["pd-low"], arms["pid-low"], strict=True):
            before, after = (float(pd_low.errors(end - 1.0, end, JOINT).mean()) for end in (13.0, 20.0))
            moves = {"pd_low_moves": span(pd_low, 9.0, 13.0), "pid_low_moves": span(pid_low, 8.0, 13.0)}
            numbers = {"stage": stage, **dict(zip(NUMBERS, point, strict=True))}
            rows.append({**numbers, "before": before, "after": after, **moves})
    table = pd.DataFrame(rows)
    ratios = np.abs(table[["before", "after"]].to_numpy()) / PAPER_ERRORS
    right = (table["pd_low_moves"] < 0.1) & (table["pid_low_moves"] > 3.0)
    return table.assign(distance=np.where(right, np.hypot(*np.log(ratios).T), np.inf))


def judged(table: pd.DataFrame) -> pd.DataFrame:
    """What everybody moves over 40-50 s [mrad] on the best of the wide stage, and whether that is as the paper says."""
    best = table.nsmallest(BEST, "distance")
    arms = run(PAPER, best[NUMBERS].to_numpy(), 50.0, 2e-4)
    moves = pd.DataFrame({name: [span(arm, 40.0, 50.0) for arm in arms[name]] for name in PAPER}, index=best.index)
    hunting = (moves[["pid-low", "letien-low", "letien-high"]] > 1.0).all(axis=1)
    resting = (moves[["pd-low", "pd-high"]] < 0.01).all(axis=1) & (moves["pid-high"] < 0.1)
    return table.join(moves.assign(verdicts=np.where(hunting & resting, "hold", "do not hold")))


if __name__ == "__main__":
    grid = np.array(list(product(*AXES)))
    found = [
        judged(screened("wide", WIDE.points(), WIDE.physics_dt)),
        screened("narrow", NARROW.points(), NARROW.physics_dt),
        screened("grid", grid, NARROW.physics_dt),
    ]
    atomic(HERE / "search.csv", csv(pd.concat(found, ignore_index=True).sort_values("distance", kind="stable")))
