"""Measure what each effect of the hardware costs: everything as it is, then with one effect switched off at a time.

    python docs/hardware/measure.py [SEEDS [ENVIRONMENT ...]]

SEEDS validation seeds (8) of each environment in the variant `hardware`. Printed is a table for each environment, a row
for each case: mean friction rejection ratios. The last case is the raw tier. Everybody's scale is `none` and `ideal` of
the same case.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
import pandas as pd

from fo_gym.evaluation.competitors.entry import competitor_of
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.evaluate import evaluation_seeds
from fo_gym.evaluation.runs.trial import reference_trials, trials_together
from fo_gym.hardware import Hardware

ENVIRONMENTS = ("FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0")
COMPENSATORS = ("pid-high", "pid-tuned", "pd-high", "letien-high")


def cases(hardware: Hardware) -> dict[str, Hardware]:
    """What is measured: the hardware, and the same without one effect, by what to call it."""
    encoder, torque = hardware.sensors.encoder, hardware.sensors.torque
    assert encoder is not None
    assert torque is not None

    def sensors(**parts: Any) -> Hardware:
        return replace(hardware, sensors=replace(hardware.sensors, **parts))

    without = {
        "the torque sensor's zero": sensors(torque=replace(torque, offset=0.0, drift=0.0, nulled=0.0)),
        "the torque sensor's noise": sensors(torque=replace(torque, noise=0.0)),
        "the velocity's filter": sensors(encoder=replace(encoder, cutoff=np.inf)),
        "the encoder's steps": sensors(encoder=replace(encoder, resolution=0.0)),
    }
    whole = ("ripple", "temperature", "load", "model_error", "delay", "link_friction")
    for name in whole:
        parts: dict[str, Any] = {name: None}
        without[name.replace("_", " ")] = replace(hardware, **parts)
    return {"as it is": hardware, **{f"without {name}": each for name, each in without.items()}, "raw": hardware.raw}


def row_of(env_id: str, hardware: Hardware, seeds: int) -> Mapping[str, float]:
    """Mean FRR of the bound and of every compensator, by name."""
    kwargs = {"hardware": hardware, "physics_dt": "auto"}
    episodes = EpisodeSet(env_id, "hardware", evaluation_seeds("hardware", seeds), kwargs)
    references, trials = reference_trials(episodes)
    trials += trials_together(episodes, [competitor_of(name) for name in COMPENSATORS], references)
    return {trial.rows["compensator"].iloc[0]: trial.rows["frr"].mean() for trial in trials[2:]}


def main(seeds: int, environments: tuple[str, ...]) -> None:
    """Print the tables."""
    for env_id in environments:
        own = gym.make(env_id, variant="hardware").unwrapped.simulation.robot.hardware  # type: ignore[attr-defined]
        rows = {}
        for name, hardware in cases(own).items():
            rows[name] = row_of(env_id, hardware, seeds)
            print(f"measured {env_id}, {name}: {rows[name]}", file=sys.stderr)
        print(f"\n{env_id}, {seeds} seeds\n\n{pd.DataFrame.from_dict(rows, orient='index').round(3).to_string()}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 8, tuple(sys.argv[2:]) or ENVIRONMENTS)
