"""A compensator with a memory: it learns, while a joint moves, what is not friction."""

from baselines.rl.adaptive.compensator import AdaptiveCompensator, rl_adaptive
from baselines.rl.adaptive.design import AdaptiveDesign

__all__ = ["AdaptiveCompensator", "AdaptiveDesign", "rl_adaptive"]
