"""What a training leaves for people: model card, learning curve, and a file that `fo-gym evaluate` takes."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from baselines.rl.course import course_of
from baselines.rl.environment import REWARD
from baselines.rl.plan import Plan
from baselines.rl.storage import POLICY
from fo_gym.files import atomic, draft_of

_PACKAGES = ("fo-gym", "gymnasium", "mujoco", "numba", "numpy", "stable_baselines3", "torch")
_COMPENSATOR = '''"""The compensator that was trained here: fo-gym evaluate {file}:Trained --env {env_id}."""

from pathlib import Path

from baselines.rl import LearnedCompensator
from baselines.rl.storage import load_policy


class Trained(LearnedCompensator):
    """The policy of this folder."""

    def __init__(self):
        super().__init__(*load_policy(Path(__file__).with_name("{policy}")))
'''

__all__ = ["card", "curve_figure", "write_report"]


def card(plan: Plan, row: Mapping[str, Any]) -> dict[str, Any]:
    """The model card of the weights that a segment gave: plan, draws, reward, scores, versions."""
    return {
        "plan": asdict(plan),
        "course": asdict(course_of(plan.env_id)),
        "reward": REWARD,
        "segment": int(row["segment"]),
        "validation": {name: _six_digits(value) for name, value in row.items() if name != "segment"},
        "versions": {name: version(name) for name in _PACKAGES},
    }


def _six_digits(value: float) -> float | None:
    """As in the tables; None for what does not apply, since JSON has no NaN."""
    return None if math.isnan(value) else float(f"{value:.6g}")


def curve_figure(curves: Mapping[str, pd.DataFrame]) -> Figure:
    """Learning curves: 1 - FRR on the validation seeds against actions taken, mean and worst episode."""
    figure = Figure(figsize=(6.0, 3.6), layout="constrained")
    axis = figure.subplots()
    for place, (name, curve) in enumerate(curves.items()):
        millions = curve["actions"] / 1e6
        axis.semilogy(millions, 1.0 - curve["frr_mean"], "o-", color=f"C{place}", label=name)
        axis.semilogy(millions, 1.0 - curve["frr_worst"], "o:", color=f"C{place}", markersize=3)
    axis.set_xlabel("actions taken in training [millions]")
    axis.set_ylabel("1 - FRR, validation episodes")
    axis.set_title("full lines: mean; dotted: worst episode", fontsize="medium")
    axis.grid(alpha=0.3, which="both")
    axis.legend()
    return figure


def write_report(plan: Plan, out: Path) -> list[Path]:
    """Write card.md, curve.png and compensator.py beside curve.csv and the policy in `out`; returns the files."""
    content = json.loads((out / POLICY).with_suffix(".json").read_text(encoding="utf-8"))
    written = {
        "card.md": _page(content),
        "compensator.py": _COMPENSATOR.format(file=out / "compensator.py", env_id=plan.env_id, policy=POLICY),
    }
    for name, text in written.items():
        atomic(out / name, text)
    with draft_of(out / "curve.png") as draft:
        label = f"{plan.algo}, {'residual' if plan.design.residual else 'direct'}, seed {plan.seed}"
        curve_figure({label: pd.read_csv(out / "curve.csv")}).savefig(draft, dpi=110, metadata={"Software": None})
    return [out / name for name in (POLICY, "curve.csv", "curve.png", *written)]


def _shown(value: float | None) -> str:
    return "does not apply" if value is None else f"{value:.2g}"


def _page(card: Mapping[str, Any]) -> str:
    """The card as a page."""
    plan, scores = card["plan"], card["validation"]
    role = "added to the PID-type observer" if plan["design"]["residual"] else "without an observer"
    lines = [
        "# Model card",
        "",
        f"A policy for one joint, {role}, trained with {plan['algo'].upper()} on `{plan['env_id']}` (seed "
        f"{plan['seed']}). It acts every {1e3 * plan['design']['period']:g} ms on measured signals; weights: "
        f"`{POLICY}`, sha256 `{card['sha256']}`.",
        "",
        f"* Best of {plan['segments']} segments: number {card['segment']}, after {scores['actions']:.0f} actions. Best "
        f"means the largest mean FRR on {plan['validation_seeds']} validation seeds of the same environment.",
        f"* There: mean FRR {scores['frr_mean']:.4f}, worst {scores['frr_worst']:.4f}, median steady-state error "
        f"{_shown(scores['steady_state_error_ju'])}, median limit cycle "
        f"{_shown(scores['limit_cycle_peak_to_peak_ju'])} (joint units).",
        f"* Reward: {card['reward']}.",
        "* Versions: " + ", ".join(f"{name} {number}" for name, number in card["versions"].items()) + ".",
        "",
        "## Training draws",
        "",
        f"Episodes of {card['course']['duration']:g} s, training seeds only.",
        "",
        "| drawn | range |",
        "| --- | --- |",
        *(
            f"| {name} | {'+-' + format(value, 'g') if isinstance(value, float) else f'{value[0]:g} to {value[1]:g}'} |"
            for name, value in card["course"]["randomization"].items()
        ),
        "",
        "Factors on the environment's nominal values, but for `start` [m | rad] and `push_time` [s]; see "
        "`fo_gym.Randomization`.",
        "",
    ]
    return "\n".join(lines)
