"""The square on the arm: how close the observers bring the tool to the friction-free motion."""

from __future__ import annotations

import numpy as np

from fo_gym.certificate.statement import Finding
from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.runs import PAPER
from fo_gym.reproduction.sensitivity import AS_IT_IS, Runs, finding, square_arms

__all__: list[str] = []


def _lost(runs: Runs) -> dict[str, float]:
    """Root mean square distance of the tool from where it would be without friction, by name [mm]."""
    ideal = runs["ideal"].tool()
    return {name: 1e3 * float(np.sqrt(np.square(arm.tool() - ideal).sum(axis=1).mean())) for name, arm in runs.items()}


@claim(
    "square-everybody",
    source="square experiment",
    text="On the square every observer brings the tool closer to the friction-free motion.",
)
def _everybody(subject: Subject) -> Finding:
    arms = square_arms(subject)
    lost = _lost(arms[AS_IT_IS.name])
    text = f"worst observer's RMS distance from the ideal path over none's ({lost['none']:.3g} mm); "
    text += ", ".join(f"{name} {lost[name]:.3g}" for name in PAPER)

    def worst(runs: Runs) -> float:
        lost = _lost(runs)
        return max(lost[name] for name in PAPER) / lost["none"]

    return finding(arms, worst, "", -np.inf, 0.2, text)


@claim(
    "square-high-gains",
    source="square experiment",
    text="On the square higher gains are better for every observer, and the PID-type is the best of all.",
)
def _high_gains(subject: Subject) -> Finding:
    arms = square_arms(subject)

    def ratio(runs: Runs) -> float:
        lost = _lost(runs)
        if min(PAPER, key=lambda name: lost[name]) != "pid-high":
            return np.inf
        return max(lost[f"{kind}-high"] / lost[f"{kind}-low"] for kind in ("pid", "pd", "letien"))

    lost = _lost(arms[AS_IT_IS.name])
    best = min(PAPER, key=lambda name: lost[name])
    text = f"largest ratio of RMS distance, high over low gains, infinite if the best is not the PID-type; best: {best}"
    return finding(arms, ratio, "", -np.inf, 0.99, text)
