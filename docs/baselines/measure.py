"""Measure what docs/baselines.md tells of the rows with a friction model: `python docs/baselines/measure.py` (minutes).

Writes drift.csv (which drawn number drives the arm away), shares.csv (what it helps to cancel less) and adaptive.csv
beside itself. Validation seeds, six of each set.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import pandas as pd

import fo_gym
from fo_gym.files import atomic, csv

HERE = Path(__file__).parent
ARM, LINK = "FJRRegulation-v0", "FJRStiction-v0"
SEEDS = 6
PARTS = {
    "Coulomb friction": "friction",
    "stiction's excess over it": "stiction",
    "Stribeck velocity": "stribeck",
    "bristle stiffness": "bristle",
    "viscous friction": "viscous",
}


def made(name: str, **gains: float) -> Any:
    """A row with other gains."""
    own = fo_gym.make_compensator(name)
    for gain, value in gains.items():
        assert hasattr(own, gain), gain
        setattr(own, gain, value)
    return own


def arm(compensator: Any, **ranges: tuple[float, float]) -> pd.DataFrame:
    """Randomized episodes of the arm with some ranges in place of the task's."""
    env: Any = gym.make(ARM, variant="randomized", physics_dt="auto")
    drawn = replace(env.unwrapped.simulation.task.randomization, **ranges)
    return fo_gym.evaluate(compensator, ARM, variant="randomized", seeds=SEEDS, physics_dt="auto", randomization=drawn)


def told(rows: pd.DataFrame) -> tuple[float, float, int]:
    """The least and the largest FRR of the episodes, and how many end early."""
    return round(rows["frr"].min(), 2), round(rows["frr"].max(), 2), int((rows["status"] != "ok").sum())


def drift() -> Iterator[dict[str, object]]:
    """One drawn number at a time, with and without the observer's own gain."""
    exact = dict.fromkeys(PARTS.values(), (1.0, 1.0))
    cases = {"nothing of friction": exact, "all of it": {}}
    cases |= {name: {each: one for each, one in exact.items() if each != part} for name, part in PARTS.items()}
    for drawn, ranges in cases.items():
        least, most, lost = told(arm("lugre-nominal", **ranges))
        worst, best, _ = told(arm(made("lugre-nominal", k=0.0), **ranges))
        scores = {"least FRR of six episodes": least, "largest": most, "lost at a joint limit": lost}
        yield {"drawn": drawn, **scores, "least with k = 0": worst, "largest with k = 0": best}


def shares() -> Iterator[dict[str, object]]:
    """All of friction drawn, and less of the model cancelled."""
    for dry, viscous in ((1.0, 1.0), (1.0, 0.05), (0.6, 0.05), (0.6, 0.5)):
        least, most, lost = told(arm(made("lugre-nominal", dry=dry, viscous=viscous)))
        yield {"dry": dry, "viscous": viscous, "least FRR": least, "largest FRR": most, "lost": lost}


def adaptive() -> Iterator[dict[str, object]]:
    """The adaptive row beside a perfect model, beside all of what it learned, and beside its feedback alone."""
    columns = [
        (f"{what}, {variant}", env, variant)
        for what, env in (("regulation", ARM), ("single link", LINK))
        for variant in ("nominal", "randomized")
    ]
    compared = {
        "`lugre-identified` (a reference)": "lugre-identified",
        "`lugre-adaptive`": "lugre-adaptive",
        "the same, share = 1": made("lugre-adaptive", share=1.0),
        "`pd-high`, its feedback alone": "pd-high",
    }
    for row, compensator in compared.items():
        scores = {}
        for column, env, variant in columns:
            found = fo_gym.evaluate(compensator, env, variant=variant, seeds=None if variant == "nominal" else SEEDS)
            scores[column] = round(found["frr"].mean(), 3)
        yield {"row": row, **scores}


if __name__ == "__main__":
    for table in (drift, shares, adaptive):
        atomic(HERE / f"{table.__name__}.csv", csv(pd.DataFrame(table())))
        print("wrote", table.__name__)
