"""Score a compensator: one row per episode."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import pandas as pd

from fo_gym.checks import choice, only, shown, text, whole_number
from fo_gym.compensators import Compensator, Ideal, NoCompensation, handed
from fo_gym.envs.settings import Settings
from fo_gym.evaluation.entry import competitor_of
from fo_gym.evaluation.metrics import METRICS, score
from fo_gym.evaluation.provenance import provenance
from fo_gym.evaluation.recording import Recording, References, record
from fo_gym.evaluation.seeds import VALIDATION_SEEDS, first
from fo_gym.generators import seed_number
from fo_gym.tasks.variants import VARIANTS

OK, TERMINATED, FAILED = "ok", "terminated", "failed"

__all__ = [
    "FAILED",
    "OK",
    "TERMINATED",
    "EpisodeSet",
    "check_arguments",
    "evaluate",
    "evaluation_seeds",
    "failed_rows",
    "references_of",
    "rows",
]


@dataclass(frozen=True)
class EpisodeSet:
    """Episodes that every competitor meets: the same environment, variant, seeds and arguments.

    Attributes:
        env_id: registered environment.
        variant: variant of it.
        seeds: one per episode.
        env_kwargs: further arguments of the environment.
        traced: whether the worst, the median and the best are kept tick by tick; the nominal one is, in any case.
    """

    env_id: str
    variant: str
    seeds: tuple[int, ...]
    env_kwargs: Mapping[str, Any]
    traced: bool = False

    def record(self, compensator: Compensator, name: str) -> Recording:
        """Run `compensator` on these episodes."""
        return record(compensator, name, self.env_id, self.variant, self.seeds, self.env_kwargs)


def references_of(episodes: EpisodeSet) -> tuple[Recording, Recording]:
    """The two runs that every score of these episodes is relative to: `none`, then `ideal`."""
    return episodes.record(NoCompensation(), "none"), episodes.record(Ideal(), "ideal")


def rows(
    episodes: EpisodeSet, name: str, recording: Recording, references: References, protocol: str = ""
) -> pd.DataFrame:
    """The scores of a recording, one row per episode; `origin` and `competitor_hash` are "" in it."""
    table = []
    for i, seed in enumerate(episodes.seeds):
        episode = recording.episode(i, references)
        reason = recording.terminations[i]
        error = f"{reason} at {recording.ended[i] * recording.dt:.3f} s" if reason else ""
        table.append(
            {
                "env": episodes.env_id,
                "variant": episodes.variant,
                "compensator": name,
                "seed": seed,
                "status": TERMINATED if reason else OK,
                "error": error,
                **score(episode),
                "joint_unit": episode.joint_unit,
                **provenance(protocol),
            }
        )
    return pd.DataFrame(table)


def failed_rows(episodes: EpisodeSet, name: str, error: str, protocol: str = "") -> pd.DataFrame:
    """Rows of a competitor that could not be run: no scores, and why."""
    row = {"env": episodes.env_id, "variant": episodes.variant, "compensator": name}
    scores = dict.fromkeys(METRICS, float("nan"))
    return pd.DataFrame(
        {**row, "seed": seed, "status": FAILED, "error": error, **scores, "joint_unit": "", **provenance(protocol)}
        for seed in episodes.seeds
    )


def evaluation_seeds(variant: str, seeds: int | Sequence[int]) -> tuple[int, ...]:
    """The seeds that are meant: n means the first n validation seeds; "nominal" has no randomness and runs once."""
    if isinstance(seeds, Sequence | np.ndarray) and not isinstance(seeds, str | bytes) and np.ndim(seeds) == 1:
        given = tuple(seed_number(f"seeds[{i}]", seed) for i, seed in enumerate(seeds))
        if not given or len(set(given)) < len(given):
            raise ValueError(f"seeds are {shown(seeds)}; give one or more of them, each once")
        return given
    chosen = first(VALIDATION_SEEDS, whole_number("seeds", seeds, 1, len(VALIDATION_SEEDS)))
    return chosen[:1] if variant == "nominal" else chosen


def check_arguments(env_id: Any, variant: Any, env_kwargs: Mapping[str, Any]) -> None:
    """Check what names an environment, its variant and its further arguments.

    Raises:
        ValueError: one is not allowed, or an evaluation sets it itself.
        TypeError: there is no such argument.
    """
    text("env_id", env_id)
    choice("variant", variant, VARIANTS)
    for fixed, why in (("feedback", "it is the compensator's"), ("action_mode", "estimates are scored")):
        if fixed in env_kwargs:
            raise ValueError(f"{fixed} cannot be chosen in an evaluation: {why}; leave it out")
    only("keyword argument", env_kwargs, [each.name for each in fields(Settings)])


def evaluate(
    compensator: str | type | Compensator,
    env_id: str,
    *,
    variant: str = "nominal",
    seeds: int | Sequence[int] = 20,
    **env_kwargs: Any,
) -> pd.DataFrame:
    """Score a compensator, beside the friction-free and the uncompensated run of the same episodes.

    Args:
        compensator: a registered name, "module:Class", "file.py:Class", an entry (*.toml), a class or an instance.
            What is named, and is not the project's own, runs in a process of its own; classes and instances in this.
        env_id: a registered environment, such as "FJRStiction-v0".
        variant: variant of it; "nominal" is one episode.
        seeds: how many validation seeds, or the seeds themselves.
        env_kwargs: further arguments of the environment.

    Returns:
        One row per episode: env, variant, compensator, seed, status, error, frr, the other metrics, joint_unit and
        provenance. What does not apply is NaN.

    Raises:
        CompensatorError: the compensator raised, or returned what is not a finite (num_envs, dof) array.
        ValueError, TypeError: an argument is not allowed.
    """
    check_arguments(env_id, variant, env_kwargs)
    with _playing(compensator, env_id, variant) as (name, instance, content):
        episodes = EpisodeSet(env_id, variant, evaluation_seeds(variant, seeds), env_kwargs)
        recording = episodes.record(instance, name)  # first: what cannot run says so at once
    none, ideal = references_of(episodes)
    table = rows(episodes, name, recording, References(ideal.motions, none.motions))
    return table.assign(competitor_hash=content)


@contextmanager
def _playing(
    compensator: str | type | Compensator, env_id: str, variant: str
) -> Iterator[tuple[str, Compensator, str]]:
    """Name, instance and hash of what a user may hand over: a name, a spec, an entry, a class or an instance."""
    if isinstance(compensator, str):
        competitor = competitor_of(compensator)
        with competitor.playing(env_id, variant) as instance:
            yield competitor.name, instance, competitor.hash_on(env_id, variant)
    else:
        name = compensator.__name__ if isinstance(compensator, type) else type(compensator).__name__
        yield name, handed(compensator, name), ""
