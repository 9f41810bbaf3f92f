"""Train the adaptive compensator: on the truth, and on what it meets itself (DAgger), segment by segment."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import torch
from safetensors.numpy import load_file, save

from baselines.rl.adaptive.compensator import AdaptiveCompensator
from baselines.rl.adaptive.course import Shares
from baselines.rl.adaptive.design import AdaptiveDesign
from baselines.rl.adaptive.model import Episodes, Model, episodes_of
from baselines.rl.adaptive.report import card, write_report
from baselines.rl.adaptive.rollouts import BLOCKS, Noting, rollout
from baselines.rl.adaptive.storage import save_weights
from baselines.rl.checkpoint import reading
from baselines.rl.plan import OnSteps, claim, silence
from baselines.rl.storage import POLICY
from fo_gym import evaluate
from fo_gym.files import atomic, csv, draft_of

VALIDATION = "FJRStiction-v0"
"""What is scored after every segment, in the variant `hardware`: the single link; the scored arm is not looked at."""
SEGMENTS = 8
_RATE, _PRIOR_RATE = 1e-2, 4e-2
_JOINTS, _ENDS = 64, 8
_SMALL = 0.05
"""Of an error in units: the loss is its size, but round within this."""
_EXACT = 5.0
"""How many times an error counts where there is nothing but friction: the observer beneath errs least there."""
_THREADS = 1  # the same everywhere: sums in another order are other weights

__all__ = ["SEGMENTS", "AdaptivePlan", "train_adaptive"]


@dataclass(frozen=True)
class AdaptivePlan:
    """A training run.

    Attributes:
        seed: of everything, from 0 to 999.
        design: what the weights are part of.
        shares: of what batches are drawn from.
        segments: how many; each rolls out the compensator as it is, then learns from all rollouts so far.
        batches: of episodes in a segment, each of another robot.
        steps: of gradient descent in a segment.
        validation_seeds: episodes of a validation.
    """

    seed: int = 0
    design: AdaptiveDesign = field(default_factory=AdaptiveDesign)
    shares: Shares = field(default_factory=Shares)
    segments: int = SEGMENTS
    batches: int = 24
    steps: int = 300
    validation_seeds: int = 20

    def __post_init__(self) -> None:
        bounds = {"seed": (0, 999), "segments": (1, 99), "batches": (1, 99), "steps": (1, 9999)}
        for name, (low, high) in {**bounds, "validation_seeds": (1, 999)}.items():
            if not low <= (value := getattr(self, name)) <= high:
                raise ValueError(f"{name} is {value}; it must be from {low} to {high}")

    def episode_seed(self, segment: int, batch: int) -> int:
        """Seed of a batch's first episode, a training seed; no two episodes share one."""
        return self.seed * 1_000_000 + segment * 10_000 + batch * 100


class _Run:
    """A training in its folder: model, optimizer, rollouts and tables, so far."""

    def __init__(self, plan: AdaptivePlan, out: Path, on_steps: OnSteps) -> None:
        self.plan, self.out, self.announce = plan, out, on_steps
        self.model = Model(plan.seed)
        prior = [self.model.mean, self.model.precision]
        others = [value for name, value in self.model.named_parameters() if name not in ("mean", "precision")]
        groups = [{"params": others, "lr": _RATE}, {"params": prior, "lr": _PRIOR_RATE}]
        self.optimizer = torch.optim.Adam(groups)
        self.done = 0
        self._load()
        self.curve, self.timing = self._table("curve"), self._table("timing")
        self.rows: list[tuple[torch.Tensor, ...]] = []

    def _load(self) -> None:
        file = self.out / "checkpoint.pt"
        if not file.is_file():
            return
        with reading(file):
            state = torch.load(file, weights_only=True)
            self.model.load_state_dict(state["model"])
            self.optimizer.load_state_dict(state["optimizer"])
            self.done = int(state["segments"])

    def _table(self, name: str) -> list[dict[str, Any]]:
        file = self.out / f"{name}.csv"
        return pd.read_csv(file).head(self.done).to_dict("records") if self.done else []  # type: ignore[return-value]

    def keep(self, segments: int) -> None:
        """Write tables and checkpoint."""
        for name, rows in (("curve", self.curve), ("timing", self.timing)):
            atomic(self.out / f"{name}.csv", csv(pd.DataFrame(rows)))
        state = {"model": self.model.state_dict(), "optimizer": self.optimizer.state_dict(), "segments": segments}
        with draft_of(self.out / "checkpoint.pt") as draft:
            torch.save(state, draft)

    def compensator(self) -> AdaptiveCompensator:
        """With the weights as they are."""
        return AdaptiveCompensator(self.plan.design, self.model.weights())

    def roll_out(self, segment: int) -> None:
        """A segment's episodes: out of the folder, or new ones by the compensator as it is; at first it learns not."""
        weights = None if segment == 0 else self.model.weights()
        for batch in range(self.plan.batches):
            file = self.out / "rollouts" / f"{segment}-{batch}.safetensors"
            if not file.is_file():
                seeds = (self.plan.seed, segment, batch)
                noting, first = Noting(self.plan.design, weights), self.plan.episode_seed(segment, batch)
                made = rollout(noting, seeds, first, self.plan.shares)
                atomic(file, save({name: np.ascontiguousarray(part) for name, part in made.items()}))
            made = load_file(file)
            episodes = episodes_of(made["blocks"], made["scales"], self.plan.design.period)
            self.rows.append((*episodes, torch.from_numpy(made["truth"])))
            self.announce(f"segment {segment + 1} of {self.plan.segments}: episodes", self.plan.steps)

    def learn(self, segment: int) -> float:
        """From all rollouts so far; returns the mean loss."""
        *episodes, truth = (torch.cat(parts) for parts in zip(*self.rows, strict=True))
        generator = np.random.default_rng((self.plan.seed, segment))
        total, losses = self.plan.segments * self.plan.steps, []
        for step in range(self.plan.steps):
            share = max(0.02, 1.0 - (segment * self.plan.steps + step) / total)
            for group, rate in zip(self.optimizer.param_groups, (_RATE, _PRIOR_RATE), strict=True):
                group["lr"] = rate * share
            chosen = torch.from_numpy(generator.integers(0, len(truth), _JOINTS))
            ends = [int(end) for end in np.sort(generator.choice(np.arange(20, BLOCKS), _ENDS, replace=False))]
            columns, turned, inputs, side = (part[chosen] for part in episodes)
            losses.append(self._step((columns, turned, inputs, side), truth[chosen], ends))
            self.announce(f"segment {segment + 1} of {self.plan.segments}: learning", self.plan.batches)
        return float(np.mean(losses))

    def _step(self, episodes: Episodes, truth: torch.Tensor, ends: Sequence[int]) -> float:
        """One step downhill; returns the loss."""
        error = self.model(episodes, ends) - truth[:, None]
        counts = torch.where((truth == 0.0).all(1), _EXACT, 1.0)[:, None, None]
        loss = (counts * torch.sqrt(_SMALL**2 + error**2)).mean((0, 1)).sum()
        self.optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), 1.0)
        self.optimizer.step()
        return float(loss.item())


def train_adaptive(plan: AdaptivePlan, out: Path, *, on_steps: OnSteps | None = None) -> Path:
    """Train, or go on training, in the folder `out`; returns the file of the weights.

    They are those of the last segment: steps become smaller, down to a fiftieth, and the validation scores of segments
    differ by far less than those of its episodes. Until then the file holds those of the last segment so far.

    Args:
        plan: what is asked for.
        out: folder; holds policy.safetensors with its card, curve.csv, timing.csv, curve.png, compensator.py,
            checkpoint.pt and rollouts/.
        on_steps: called with a label and how far it went since the last call, of segments * batches * steps * 2.

    Raises:
        ValueError: `out` holds another training.
    """
    settings = {"adaptive": asdict(plan)}
    claim(out, settings)
    torch.set_num_threads(_THREADS)
    run = _Run(plan, out, on_steps or silence)
    for segment in range(run.done):
        run.roll_out(segment)
        run.announce(f"{run.done} of {plan.segments} segments are done", plan.batches * plan.steps)
    for segment in range(run.done, plan.segments):
        start = time.perf_counter()
        run.roll_out(segment)
        rolled = time.perf_counter()
        loss = run.learn(segment)
        learned = time.perf_counter()
        rows = evaluate(run.compensator(), VALIDATION, variant="hardware", seeds=plan.validation_seeds)
        scores = {"loss": loss, "frr_mean": rows["frr"].mean(), "frr_worst": rows["frr"].min()}
        row = {"segment": segment + 1, **{name: float(f"{score:.6g}") for name, score in scores.items()}}
        run.curve.append(row)
        run.timing.append({"segment": segment + 1, "seconds": learned - start, "environment_seconds": rolled - start})
        save_weights(out / POLICY, plan.design, run.model.weights(), card(settings, row))
        run.keep(segment + 1)
        run.announce(f"segment {segment + 1} of {plan.segments}: validation FRR {row['frr_mean']:.4f}", 0)
    write_report(out)
    return out / POLICY
