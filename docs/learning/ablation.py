"""Measure what each part of the adaptive compensator is worth, into ablation.csv beside this file.

    python docs/learning/ablation.py BUILD

Validation seeds only. Four trainings of equal length go to the folder BUILD: as it is shipped, and with one part taken
away each; an hour on one core, and a killed run goes on there.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from adaptive import LAWS, TWO_LINKS  # beside this file

import fo_gym
from baselines.rl.adaptive import AdaptiveCompensator, AdaptiveDesign
from baselines.rl.adaptive.course import Shares
from baselines.rl.adaptive.memory import Memory
from baselines.rl.adaptive.training import AdaptivePlan, train_adaptive
from baselines.rl.adaptive.weights import SHAPES, Weights
from fo_gym import Signals
from fo_gym.files import atomic, csv
from fo_gym.robots import robot_of

HERE = Path(__file__).parent
SEEDS = 8
SEGMENTS = 2
TRAININGS = {
    "trained for as long": Shares(),
    "trained with LuGre alone": Shares(laws=0.0),
    "trained on the single link alone": Shares(links=1.0),
    "trained on random chains alone": Shares(links=0.0),
}
HARDWARE, EXACT = "hardware", "randomized"
EPISODES = {
    "link": ("FJRStiction-v0", HARDWARE, {}),
    "regulation": ("FJRRegulation-v0", HARDWARE, {}),
    "square": ("FJRSquare-v0", HARDWARE, {}),
    **{
        f"square, {law.__name__}": ("FJRSquare-v0", HARDWARE, {"friction": law.like(robot_of("miro_like").friction)})
        for law in LAWS
    },
    "two_links, exact signals": ("FJRRegulation-v0", EXACT, {"robot": TWO_LINKS}),
}
"""Environment, variant and arguments."""


class Forgetful(AdaptiveCompensator):
    """It remembers a second at most."""

    def _end_block(self, signals: Signals) -> None:
        super()._end_block(signals)
        if self._memory is not None and self._tick * self._dt % 1.0 < 0.5 * self._dt:
            self._memory = Memory(self._memory.weights, self.zero.shape)


def competitors(build: Path) -> dict[str, Callable[[], AdaptiveCompensator]]:
    """Everybody, by what is said of them."""
    shipped = fo_gym.make_compensator("rl-adaptive")
    assert isinstance(shipped, AdaptiveCompensator)
    design, weights = shipped.design, shipped.weights
    made: dict[str, Callable[[], AdaptiveCompensator]] = {
        "as shipped": lambda: AdaptiveCompensator(design, weights),
        "nothing learned: the observer beneath": lambda: AdaptiveCompensator(design, None),
        "a regression that trusts all rows alike": lambda: AdaptiveCompensator(AdaptiveDesign(), _alike()),
        "a memory of one second": lambda: Forgetful(design, weights),
        "it is sure that signals are not exact": lambda: AdaptiveCompensator(design, _sure(weights)),
    }
    for name, shares in TRAININGS.items():
        out = build / name.replace(" ", "-")
        file = train_adaptive(AdaptivePlan(shares=shares, segments=SEGMENTS), out, on_steps=_said)
        made[name] = lambda file=file: AdaptiveCompensator.load(file)  # type: ignore[misc]
    return made


def _alike() -> Weights:
    """No networks and no prior: every row is worth 1, and so is the trust in all of them."""
    return Weights(**{name: np.zeros(shape) for name, shape in SHAPES.items()})


def _sure(weights: Weights | None) -> Weights:
    """All of what the regression finds is corrected."""
    assert weights is not None
    return replace(weights, odds=np.array([30.0, 0.0]))


def _said(label: str, steps: int) -> None:
    if steps == 0:
        print(label, file=sys.stderr)


def main(build: str) -> None:
    """Write the table: mean 1 - FRR by competitor and episodes."""
    rows = []
    for name, make in competitors(Path(build)).items():
        row: dict[str, object] = {"compensator": name}
        for column, (env_id, variant, kwargs) in EPISODES.items():
            table = fo_gym.evaluate(make(), env_id, variant=variant, seeds=SEEDS, physics_dt="auto", **kwargs)
            row[column] = float(f"{1.0 - table['frr'].mean():.6g}")
        rows.append(row)
        print(f"measured {row}", file=sys.stderr)
    atomic(HERE / "ablation.csv", csv(pd.DataFrame(rows)))


if __name__ == "__main__":
    main(sys.argv[1])
