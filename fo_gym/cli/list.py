"""`fo-gym list`: what there is."""

from __future__ import annotations

from fo_gym.console import say

__all__ = ["run_list"]


def run_list() -> None:
    """Show the environments, variants, compensators, metrics, entries and protocols there are.

    Example: fo-gym list
    """
    from fo_gym import ENVIRONMENTS, list_compensators
    from fo_gym.evaluation.competitors.entry import shipped_entries
    from fo_gym.evaluation.metrics import METRICS
    from fo_gym.evaluation.runs.protocol import shipped_protocols
    from fo_gym.tasks.variants import VARIANTS

    names = {"environment": ENVIRONMENTS, "variant": VARIANTS, "compensator": list_compensators()}
    metrics = [
        f"{name} ({metric.unit_text}, {metric.better} is better): {metric.description}"
        for name, metric in METRICS.items()
    ]
    files = {"entry": shipped_entries(), "protocol": shipped_protocols()}
    lines = names | {"metric": metrics}
    lines |= {kind: [f"{name}: {path}" for name, path in found.items()] for kind, found in files.items()}
    for kind, texts in lines.items():
        for text in texts:
            say(f"{kind:<12} {text}")
