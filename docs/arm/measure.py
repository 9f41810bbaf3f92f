"""Measure what docs/arm.md says, into the tables beside this file: `python docs/arm/measure.py`.

Some ten minutes on a core; `python docs/tables.py` then puts them into the page.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

import fo_gym
from fo_gym.certificate.subject import Subject
from fo_gym.compensators import NoCompensation
from fo_gym.evaluation.runs.seeds import VALIDATION_SEEDS, first
from fo_gym.files import atomic, csv
from fo_gym.friction import FRICTIONLESS
from fo_gym.reproduction.arms import Arm, run_arms
from fo_gym.reproduction.runs import PAPER
from fo_gym.reproduction.sensitivity import Runs, held_arms, square_arms
from fo_gym.simulation.settings import Settings
from fo_gym.tasks.regulation import regulation
from fo_gym.tasks.square import square

HERE = Path(__file__).parent
STEPS = (2e-4, 1e-4, 5e-5)
EPISODES = 20
JOINT = 1
HUNTS = 1.0
"""Peak to peak from which on a joint hunts [mrad]."""


def span(errors: np.ndarray) -> float:
    """Peak to peak."""
    return float(np.ptp(errors, axis=0).max())


def rejected(runs: Runs) -> dict[str, float]:
    """FRR on the square, by the tool's path."""
    ideal = runs["ideal"].tool()
    lost = {name: float(np.sqrt(np.square(arm.tool() - ideal).sum(axis=1).mean())) for name, arm in runs.items()}
    return {name: round(1.0 - lost[name] / lost["none"], 3) for name in PAPER}


def regulated(arm: Arm) -> dict[str, float]:
    """What joint 2 does, in numbers [mrad]."""
    moves = {f"moves {a}-{b} s": span(arm.errors(a, b, JOINT)) for a, b in ((8, 13), (20, 40), (40, 60))}
    rests = {f"error at {b} s": float(arm.errors(b - 1, b, JOINT).mean()) for b in (13, 20, 60)}
    return {name: float(f"{value:.3g}") for name, value in (moves | rests).items()}


def verdicts() -> pd.DataFrame:
    """The nominal experiments at three micro-steps."""
    rows = []
    members = {name: fo_gym.make_compensator(name) for name in PAPER}
    everybody = {"none": NoCompensation(), **members}
    for step in STEPS:
        held = run_arms(members, regulation, Settings(physics_dt=step, duration=60.0))
        drawn = run_arms(everybody, square, Settings(physics_dt=step))
        ideal = run_arms({"ideal": NoCompensation()}, square, Settings(physics_dt=step, friction=FRICTIONLESS))
        shares = rejected({name: arms[0] for name, arms in (drawn | ideal).items()})
        rows += [
            {"compensator": name, "physics_dt": step, **regulated(held[name][0]), "FRR on the square": shares[name]}
            for name in PAPER
        ]
    return pd.DataFrame(rows).sort_values("compensator", key=lambda names: names.map(PAPER.index), kind="stable")


def randomized() -> pd.DataFrame:
    """In how many randomized episodes joint 2, and any joint, hunts over 40-60 s, beside the arm without friction."""
    seeds = first(VALIDATION_SEEDS, EPISODES)
    settings = Settings(variant="randomized", duration=60.0)
    members = {name: fo_gym.make_compensator(name) for name in PAPER}
    arms = run_arms(members, regulation, settings, seeds=seeds)
    free = Settings(variant="randomized", duration=60.0, friction=FRICTIONLESS)
    ideal = run_arms({"ideal": NoCompensation()}, regulation, free, seeds=seeds)["ideal"]
    rows = []
    for name in PAPER:
        late = [(arm.error - alone.error)[arm.time >= 40.0] for arm, alone in zip(arms[name], ideal, strict=True)]
        moves = 1e3 * np.array([np.ptp(errors, axis=0) for errors in late])
        rows.append(
            {
                "compensator": name,
                "episodes": EPISODES,
                "joint 2 hunts": int((moves[:, JOINT] > HUNTS).sum()),
                "any joint hunts": int((moves > HUNTS).any(axis=1).sum()),
                "median of joint 2": float(f"{np.median(moves[:, JOINT]):.3g}"),
                "largest of joint 2": float(f"{moves[:, JOINT].max():.3g}"),
            }
        )
    return pd.DataFrame(rows)


def sensitivity() -> pd.DataFrame:
    """What joint 2 and the square do when a number is another."""
    subject = Subject()
    held, drawn = held_arms(subject), square_arms(subject)
    rows = []
    for variation, runs in held.items():
        shares = rejected(drawn[variation])
        rows += [
            {"variation": variation, "compensator": name, **regulated(runs[name]), "FRR on the square": shares[name]}
            for name in PAPER
        ]
    return pd.DataFrame(rows)


if __name__ == "__main__":
    for name, measure in (("verdicts", verdicts), ("randomized", randomized), ("sensitivity", sensitivity)):
        atomic(HERE / f"{name}.csv", csv(measure()))
        print(f"wrote {HERE / name}.csv")
