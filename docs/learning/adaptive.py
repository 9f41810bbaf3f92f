"""Measure what a trained adaptive compensator is worth, into tables beside this file.

    python docs/learning/adaptive.py WEIGHTS

Validation seeds only; a quarter of an hour on two cores. What it scores beside others is on the leaderboard. WEIGHTS is
the policy.safetensors of a training.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from beliefs import beliefs  # beside this file

import fo_gym
from baselines.rl.adaptive import AdaptiveCompensator
from fo_gym import Dahl, ElastoPlastic, MaxwellSlip
from fo_gym.evaluation.runs.evaluate import evaluation_seeds
from fo_gym.files import atomic, csv
from fo_gym.robots import robot_of

HERE = Path(__file__).parent
ENVIRONMENTS = ("FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0")
LAWS = (ElastoPlastic, MaxwellSlip, Dahl)
ARMS = {"FJRRegulation-v0": "examples/arms/two_links.xml", "FJRTracking-v0": "examples/arms/two_links.xml"}
TOLD = (0.5, 1.0, 2.0, 4.0, 8.0)
"""When it is asked what is not friction [s]."""
SEEDS, FEW = 20, 8
Make = Callable[[], AdaptiveCompensator]


def elsewhere() -> Iterator[tuple[str, str, str, dict[str, Any]]]:
    """Where nobody trained: what to call it, environment, variant, arguments."""
    arm = robot_of("miro_like").friction
    for env_id in ("FJRStiction-v0", "FJRSquare-v0"):
        own = robot_of("single_link" if env_id == "FJRStiction-v0" else "miro_like").friction
        twice = replace(own, f_c=2.0 * own.f_c, f_s=2.0 * own.f_s)  # type: ignore[attr-defined, call-arg]
        yield "friction x 2", env_id, "hardware", {"friction": twice}
    for law in LAWS:
        yield law.__name__, "FJRSquare-v0", "hardware", {"friction": law.like(arm)}
    for env_id, file in ARMS.items():
        for variant in ("hardware", "randomized"):
            yield "two_links.xml", env_id, variant, {"robot": file}


def outside(make: Make) -> pd.DataFrame:
    """Mean 1 - FRR of it and of the observer beneath where nobody trained."""
    rows = []
    for name, env_id, variant, kwargs in elsewhere():
        row: dict[str, Any] = {"case": name, "env": env_id, "variant": variant}
        learned = make()
        for who, weights in (("rl-adaptive", learned.weights), ("the observer beneath", None)):
            compensator = AdaptiveCompensator(learned.design, weights)
            table = fo_gym.evaluate(compensator, env_id, variant=variant, seeds=FEW, physics_dt="auto", **kwargs)
            row[who] = 1.0 - table["frr"].mean()
        rows.append(row)
        print(f"measured {row}", file=sys.stderr)
    return pd.DataFrame(rows)


def told(make: Make) -> pd.DataFrame:
    """Root mean square of what is left of zero and inertia error once corrected, as a share of both, by time."""
    rows = []
    for env_id in ENVIRONMENTS:
        known = beliefs(make(), env_id, evaluation_seeds("hardware", SEEDS), TOLD[-1] + 0.1)
        for time in TOLD:
            believed = {name: values[round(time / known.dt)] for name, values in known.believed.items()}
            left = {name: _left(known.true[name], value) for name, value in believed.items()}
            rows.append({"env": env_id, "time": time, **left})
    return pd.DataFrame(rows)


def _left(true: Any, estimated: Any) -> float:
    """Of all joints, each as a share of its own."""
    return float(np.sqrt(np.mean(np.mean((true - estimated) ** 2, axis=0) / np.mean(true**2, axis=0))))


def main(weights: str | Path) -> None:
    """Write the tables."""

    def make() -> AdaptiveCompensator:
        return AdaptiveCompensator.load(weights)

    for name, measure in (("told", told), ("outside", outside)):
        atomic(HERE / f"adaptive_{name}.csv", csv(measure(make)))
        print(f"wrote {HERE / f'adaptive_{name}.csv'}")


if __name__ == "__main__":
    main(sys.argv[1])
