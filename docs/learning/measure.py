"""Measure what docs/learning.md says, into the tables beside this file: `python docs/learning/measure.py`.

Validation seeds only; a few minutes on two cores.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pandas as pd
from joblib import Parallel, delayed

import fo_gym
from baselines import PIDObserver
from fo_gym.files import atomic, csv
from fo_gym.robots import robot_of

HERE = Path(__file__).parent
SEEDS = 10
FACTORS = (0.25, 0.4, 0.63, 1.0, 1.6, 2.0, 2.5, 4.0)
OBSERVER = "pid-high"
COMPETITORS: dict[str, Callable[[], Any]] = {
    OBSERVER: lambda: fo_gym.make_compensator(OBSERVER),
    "pid, L = 200": lambda: PIDObserver(L=200.0, Lp=40.0, Li=400.0),
    "rl-residual": lambda: fo_gym.make_compensator("rl-residual"),
    "rl-direct": lambda: fo_gym.make_compensator("rl-direct"),
}
LINK, ARM = robot_of("single_link"), robot_of("miro_like")
JOINTS = {"FJRStiction-v0": LINK.flexible, "FJRRegulation-v0": ARM.flexible, "FJRSquare-v0": ARM.flexible}
FRICTION = {"FJRStiction-v0": LINK.friction, "FJRRegulation-v0": ARM.friction, "FJRSquare-v0": ARM.friction}
PARAMETERS = {
    "friction": ("f_c", "f_s"),
    "stribeck": ("v_s",),
    "bristle": ("sigma_0",),
    "viscous": ("sigma_2",),
    "motor_inertia": ("motor_inertia",),
    "stiffness": ("stiffness",),
}
"""What is varied, named as in `fo_gym.Randomization`, and which fields that multiplies."""


def scaled(env_id: str, parameter: str, factor: float) -> dict[str, Any]:
    """Arguments of the environment with one parameter multiplied; the randomized draws come on top."""
    result = {}
    for name, values in (("joints", JOINTS[env_id]), ("friction", FRICTION[env_id])):
        fields = [field for field in PARAMETERS[parameter] if hasattr(values, field)]
        if fields:
            result[name] = replace(values, **{field: factor * getattr(values, field) for field in fields})
    return result


def score(env_id: str, parameter: str, factor: float, name: str) -> dict[str, Any]:
    """One competitor on the randomized episodes of one environment with one parameter multiplied."""
    # The default micro-step does not follow the hardest bristles and the lightest motors among these.
    arguments = {"physics_dt": "auto", **scaled(env_id, parameter, factor)}
    rows = fo_gym.evaluate(COMPETITORS[name](), env_id, variant="randomized", seeds=SEEDS, **arguments)
    return {
        "env": env_id,
        "parameter": parameter,
        "factor": factor,
        "compensator": name,
        "residual_mean": 1.0 - rows["frr"].mean(),
        "residual_worst": 1.0 - rows["frr"].min(),
        "ended_early": int((rows["status"] != "ok").sum()),
    }


def sweep() -> pd.DataFrame:
    """1 - FRR of every competitor, inside and outside the training range: the link widely, the arm where it matters."""
    cases = [("FJRStiction-v0", parameter, factor) for parameter in PARAMETERS for factor in FACTORS]
    for env_id in ("FJRRegulation-v0", "FJRSquare-v0"):
        cases += [(env_id, "friction", 1.0), (env_id, "friction", 2.0), (env_id, "motor_inertia", 1.5)]
    cases.append(("FJRStiction-v0", "motor_inertia", 1.5))
    calls = (delayed(score)(*case, name) for case in cases for name in COMPETITORS)
    return pd.DataFrame(Parallel(n_jobs=-1, inner_max_num_threads=1)(calls))


def ticks(calls: int = 20_000) -> pd.DataFrame:
    """Time of one call of `estimate` for the seven joints of one arm, as a control loop would make it."""
    rows = []
    for name in (OBSERVER, "rl-residual", "rl-adaptive"):
        compensator, seconds = fo_gym.make_compensator(name), np.empty(calls)
        env = gym.make("FJRRegulation-v0", feedback=compensator.feedback, variant="randomized")
        obs, _ = env.reset(seed=0)
        compensator.reset(env.unwrapped.joint_info, 1)
        for k in range(calls):
            signals = fo_gym.Signals.from_observation(obs[None], 7)
            start = time.perf_counter()
            estimate = compensator.estimate(signals)
            seconds[k] = time.perf_counter() - start
            obs, *_ = env.step(estimate[0])
        median, high = np.percentile(seconds, [50, 99]) * 1e6
        rows.append({"compensator": name, "calls": calls, "median_us": round(median, 1), "p99_us": round(high, 1)})
    return pd.DataFrame(rows)


if __name__ == "__main__":
    for table, measure in (("ticks", ticks), ("sweep", sweep)):
        atomic(HERE / f"{table}.csv", csv(measure()))
        print(f"wrote {HERE / table}.csv")
