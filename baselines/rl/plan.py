"""What `fo-gym train` is asked to do; a resumed run must be asked the same."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from baselines.rl.course import course_of
from baselines.rl.design import Design
from fo_gym.files import atomic

__all__ = ["ALGOS", "Algo", "OnSteps", "Plan", "claim", "silence"]

Algo = Literal["ppo", "sac", "tqc"]
ALGOS: tuple[str, ...] = get_args(Algo)

OnSteps = Callable[[str, int], None]
"""Called with a label, and how far a training went since the last call."""


@dataclass(frozen=True)
class Plan:
    """A training run.

    Attributes:
        env_id: environment, one with a course.
        algo: one of ALGOS.
        seed: of everything; at least 0.
        design: what the policy is part of.
        robots: how many are trained on together; each of their joints is an agent.
        steps: actions of every agent in a segment, after which comes a validation and a checkpoint.
        segments: how many.
        validation_seeds: episodes of a validation.
    """

    env_id: str
    algo: str
    seed: int
    design: Design
    robots: int
    steps: int
    segments: int
    validation_seeds: int = 20

    def __post_init__(self) -> None:
        course_of(self.env_id)
        if self.algo not in ALGOS:
            raise ValueError(f"algo is {self.algo!r}; allowed are {', '.join(ALGOS)}")
        bounds = {"seed": (0, 999), "robots": (1, 999), "steps": (1, None), "segments": (1, 999)}
        for name, (low, high) in {**bounds, "validation_seeds": (1, None)}.items():
            value = getattr(self, name)
            if value < low or (high is not None and value > high):
                allowed = f"at least {low}" if high is None else f"from {low} to {high}"
                raise ValueError(f"{name} is {value}; it must be {allowed}")

    @property
    def actions(self) -> int:
        """Actions of all agents in a segment."""
        return self.robots * course_of(self.env_id).joints * self.steps

    def episode_seed(self, segment: int) -> int:
        """Seed of a segment's first robot, a training seed; no two robots, segments or runs share one."""
        return self.seed * 1_000_000 + segment * 1_000


def claim(out: Path, settings: Mapping[str, Any]) -> None:
    """Note in `out` what is trained there.

    Raises:
        ValueError: something else is.
    """
    file = out / "plan.json"
    text = json.dumps(settings, indent=2) + "\n"
    if file.is_file() and file.read_text(encoding="utf-8") != text:
        raise ValueError(f"{out} holds a training with other settings, see {file}; choose another --out, or remove it")
    atomic(file, text)


def silence(label: str, steps: int) -> None:
    """An `OnSteps` where nobody listens."""
