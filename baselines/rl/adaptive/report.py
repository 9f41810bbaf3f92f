"""What a training of the adaptive compensator leaves for people: card, curve, and a file that can be scored."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from baselines.rl.adaptive.course import described
from baselines.rl.storage import POLICY
from fo_gym.files import atomic, draft_of

_PACKAGES = ("fo-gym", "gymnasium", "mujoco", "numba", "numpy", "torch")
_COMPENSATOR = '''"""The compensator that was trained here: fo-gym evaluate {file}:Trained --env FJRSquare-v0."""

from pathlib import Path

from baselines.rl.adaptive import AdaptiveCompensator
from baselines.rl.adaptive.storage import load_weights


class Trained(AdaptiveCompensator):
    """The weights of this folder."""

    def __init__(self):
        super().__init__(*load_weights(Path(__file__).with_name("{policy}")))
'''

__all__ = ["card", "write_report"]


def card(plan: Mapping[str, Any], row: Mapping[str, Any]) -> dict[str, Any]:
    """The model card of the weights that a segment gave: plan, draws, scores, versions."""
    return {
        "plan": plan,
        "course": described(),
        "segment": int(row["segment"]),
        "validation": {name: value for name, value in row.items() if name != "segment"},
        "versions": {name: version(name) for name in _PACKAGES},
    }


def write_report(out: Path) -> None:
    """Write card.md, curve.png and compensator.py beside curve.csv and the weights in `out`."""
    content = json.loads((out / POLICY).with_suffix(".json").read_text(encoding="utf-8"))
    atomic(out / "card.md", _page(content))
    atomic(out / "compensator.py", _COMPENSATOR.format(file=out / "compensator.py", policy=POLICY))
    curve = pd.read_csv(out / "curve.csv")
    figure = Figure(figsize=(6.0, 3.6), layout="constrained")
    axis = figure.subplots()
    axis.semilogy(curve["segment"], 1.0 - curve["frr_mean"], "o-", label="mean")
    axis.semilogy(curve["segment"], 1.0 - curve["frr_worst"], "o:", label="worst episode")
    axis.set_xlabel("segments")
    axis.set_ylabel("1 - FRR, validation episodes of the single link")
    axis.grid(alpha=0.3, which="both")
    axis.legend()
    with draft_of(out / "curve.png") as draft:
        figure.savefig(draft, dpi=110, metadata={"Software": None})


def _page(card: Mapping[str, Any]) -> str:
    """The card as a page."""
    plan, scores, course = card["plan"]["adaptive"], card["validation"], card["course"]
    lines = [
        "# Model card",
        "",
        "Weights of the adaptive compensator: one set for any joint and robot. They say how much a block of readings "
        "is worth, how much all of them are trusted, and what was to be expected of friction. Trained on the truth "
        f"about what is not friction, on episodes of its own (DAgger), seed {plan['seed']}; weights: `{POLICY}`, "
        f"sha256 `{card['sha256']}`.",
        "",
        f"* After segment {card['segment']} of {plan['segments']}: mean FRR {scores['frr_mean']:.4f}, worst "
        f"{scores['frr_worst']:.4f}, on {plan['validation_seeds']} validation seeds of the single link in the variant "
        "`hardware`.",
        "* Versions: " + ", ".join(f"{name} {number}" for name, number in card["versions"].items()) + ".",
        "",
        "## Training draws",
        "",
        "The single link and random chains of 2 to 5 hinges; steps, paths of joints and of tools; four friction laws.",
        "",
        "| drawn | range |",
        "| --- | --- |",
        *(
            f"| {name} | {low:g} to {high:g} |"
            for part in ("draws", "effects")
            for name, (low, high) in course[part].items()
        ),
        "",
        "Factors, but for `push_time` [s]: those of an episode, see `fo_gym.Randomization`, then those on the effects "
        "of the robot's hardware.",
        "",
    ]
    return "\n".join(lines)
