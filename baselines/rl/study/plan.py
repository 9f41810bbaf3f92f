"""What the study runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from baselines.rl.study.recipe import Recipe

ENVIRONMENTS = ("FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0")

__all__ = ["ENVIRONMENTS", "Run", "Study", "runs_of"]


@dataclass(frozen=True)
class Study:
    """What every run of the study shares; a study that goes on must be asked the same.

    Attributes:
        recipes: one for each algorithm.
        checkpoints: how often a run is scored, evenly over its steps, at its end last.
        episodes: validation episodes of a score.
    """

    recipes: tuple[Recipe, ...]
    checkpoints: int
    episodes: int


@dataclass(frozen=True)
class Run:
    """One training.

    Attributes:
        recipe: the algorithm.
        env_id: environment.
        action_mode: "compensation" or "torque".
        seed: number of the run, from 0.
    """

    recipe: Recipe
    env_id: str
    action_mode: str
    seed: int

    @property
    def label(self) -> str:
        """What rows and curves are called: the algorithm, and the action mode where it is not the usual one."""
        return self.recipe.algo if self.action_mode == "compensation" else f"{self.recipe.algo} ({self.action_mode})"

    @property
    def episode_seed(self) -> int:
        """Of model and first environment, a training seed; no two environments or runs of one row share one."""
        return self.seed * 1_000_000

    def file(self, out: Path) -> Path:
        """Where its rows are kept once it is done."""
        return out / "runs" / f"{self.env_id}-{self.recipe.algo}-{self.action_mode}-{self.seed}.csv"


def runs_of(recipes: Sequence[Recipe], env_ids: Sequence[str], seeds: int) -> list[Run]:
    """All runs: every algorithm on every environment, and PPO with torques, too; the first seed of all comes first."""
    return [
        Run(recipe, env_id, mode, seed)
        for seed in range(seeds)
        for env_id in env_ids
        for recipe in recipes
        for mode in (("compensation", "torque") if recipe.algo == "ppo" else ("compensation",))
    ]
