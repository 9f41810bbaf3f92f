"""The learned compensators: what a policy sees and does, its weights, and its training.

Scoring needs NumPy and safetensors only; training (`environment`, `training`) needs the extra "rl".
"""

from baselines.rl.compensator import LearnedCompensator, rl_direct, rl_residual
from baselines.rl.design import Design

__all__ = ["Design", "LearnedCompensator", "rl_direct", "rl_residual"]
