"""Draw the figures of docs/learning.md from the tables beside this file: `python docs/learning/draw.py`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from beliefs import beliefs  # beside this file
from matplotlib.figure import Figure

import fo_gym
from baselines.rl.compensator import SHIPPED
from baselines.rl.course import COURSES
from baselines.rl.report import curve_figure
from fo_gym.compensators import Ideal
from fo_gym.evaluation.results.style import BLUE, GREEN, ORANGE, PURPLE
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.files import draft_of

HERE = Path(__file__).parent
COLOURS = {"pid-high": BLUE, "pid, L = 200": GREEN, "rl-residual": ORANGE, "rl-direct": PURPLE}
POLICIES = ("rl-direct", "rl-residual")
TRACED = ("pid-high", "rl-residual", "rl-direct")
EPISODE = 1_000_000_003
"""A validation seed: the episode that is drawn."""

TICKS = (0.25, 0.5, 1.0, 2.0, 4.0)
NAMES = {
    "friction": "friction f_c, f_s",
    "stribeck": "Stribeck velocity v_s",
    "bristle": "bristle stiffness sigma_0",
    "viscous": "viscous friction sigma_2",
    "motor_inertia": "motor inertia B",
    "stiffness": "joint stiffness K_j",
}


def curves() -> Figure:
    """Learning curves of every training of a policy that was kept."""
    named = {f"{name}, seed 0": pd.read_csv(SHIPPED / name / "curve.csv") for name in POLICIES}
    for file in sorted(HERE.glob("curve-*.csv")):
        named[file.stem.removeprefix("curve-").replace("_seed_", ", seed ")] = pd.read_csv(file)
    return curve_figure(named)


def traces() -> Figure:
    """Distance from the friction-free motion in one randomized episode: the link, and joint 2 of the arm."""
    figure = Figure(figsize=(7.2, 5.0), layout="constrained")
    axes = figure.subplots(2, 1, sharex=True)
    panels = (("FJRStiction-v0", 0, 1e3, "mm"), ("FJRRegulation-v0", 1, 1e3, "mrad"))
    for axis, (env_id, joint, factor, unit) in zip(axes, panels, strict=True):
        episodes = EpisodeSet(env_id, "randomized", (EPISODE,), {})
        ideal = episodes.record(Ideal(), "ideal").motions.theta[:, 0, joint]
        for name in TRACED:
            theta = episodes.record(fo_gym.make_compensator(name), name).motions.theta[:, 0, joint]
            axis.plot(1e-3 * np.arange(len(theta)), factor * (theta - ideal), color=COLOURS[name], lw=0.9, label=name)
        axis.set_title(f"{env_id}, randomized, joint {joint + 1}", fontsize="medium")
        axis.set_ylabel(f"theta - theta_ideal [{unit}]")
        axis.grid(alpha=0.3)
    axes[1].set_xlabel("time [s]")
    axes[0].legend(loc="upper right")
    return figure


def sweeps() -> Figure:
    """1 - FRR against the parameters of the joint; shaded: every draw was within the training range."""
    table = pd.read_csv(HERE / "sweep.csv")
    table = table[table["env"] == "FJRStiction-v0"]
    trained, scored = COURSES["FJRStiction-v0"].randomization, fo_gym.Randomization()
    figure = Figure(figsize=(9.0, 5.4), layout="constrained")
    for axis, (parameter, label) in zip(figure.subplots(2, 3, sharey=True).flat, NAMES.items(), strict=True):
        low, high = (getattr(trained, parameter)[k] / getattr(scored, parameter)[k] for k in (0, 1))
        axis.axvspan(low, high, color="0.9")
        for name, rows in table[table["parameter"] == parameter].sort_values("factor").groupby("compensator"):
            axis.loglog(rows["factor"], rows["residual_mean"], "o-", ms=3, color=COLOURS[str(name)], label=str(name))
        axis.set_xlim(table["factor"].min() / 1.1, table["factor"].max() * 1.1)
        axis.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
        axis.set_xticks([], minor=True)
        axis.set_xlabel(f"factor on {label}")
        axis.grid(alpha=0.3, which="both")
    for axis in figure.axes[::3]:
        axis.set_ylabel("1 - FRR, mean")
    figure.axes[0].legend(fontsize="small")
    return figure


def told() -> Figure:
    """What the adaptive compensator says of zero and inertia (solid), and what is true (dashed), in one episode."""
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.subplots(2, 2, sharex="col")
    panels = (("FJRStiction-v0", (0,)), ("FJRSquare-v0", (0, 1, 3, 5)))
    for column, (env_id, joints) in zip(axes.T, panels, strict=True):
        known = beliefs(fo_gym.make_compensator("rl-adaptive"), env_id, (EPISODE,), 8.0)  # type: ignore[arg-type]
        for axis, (name, factor) in zip(column, (("zero", 1.0), ("inertia", 100.0)), strict=True):
            believed, true = factor * known.believed[name][:, 0], factor * known.true[name][0]
            for k, joint in enumerate(joints):
                axis.plot(known.dt * np.arange(len(believed)), believed[:, joint], color=f"C{k}", lw=1.0)
                axis.axhline(true[joint], color=f"C{k}", ls="--", lw=0.9, label=f"joint {joint + 1}")
            axis.grid(alpha=0.3)
        column[0].set_title(f"{env_id}, hardware", fontsize="medium")
        column[0].set_ylabel(f"zero [{known.unit}]")
        column[1].set_ylabel("error of B [%]")
        column[1].set_xlabel("time [s]")
    axes[0, 1].legend(fontsize="small", ncols=2)
    return figure


if __name__ == "__main__":
    for function in (curves, traces, sweeps, told):
        with draft_of(HERE / f"{function.__name__}.png") as draft:
            function().savefig(draft, dpi=110, metadata={"Software": None})
        print(f"wrote {HERE / function.__name__}.png")
