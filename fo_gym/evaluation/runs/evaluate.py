"""Score a compensator: one row per episode."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields
from typing import Any

import numpy as np
import pandas as pd

from fo_gym.checks import choice, only, shown, text, whole_number
from fo_gym.compensators import Compensator, handed
from fo_gym.evaluation.competitors.entry import competitor_of
from fo_gym.evaluation.episode.recording import Recording, References
from fo_gym.evaluation.episode.trace import Trace, trace_of
from fo_gym.evaluation.runs.bound import bound_of
from fo_gym.evaluation.runs.episodes import EpisodeSet, references_of, rows
from fo_gym.evaluation.runs.seeds import VALIDATION_SEEDS, seeds_for, usual_count
from fo_gym.generators import seed_number
from fo_gym.simulation.settings import Settings
from fo_gym.tasks.variants import VARIANTS

__all__ = ["check_arguments", "evaluate", "evaluation_seeds", "trace"]


def evaluation_seeds(variant: str, seeds: int | Sequence[int] | None) -> tuple[int, ...]:
    """The seeds that are meant: n means `seeds_for` the variant, of the validation seeds; None, `usual_count`."""
    if seeds is None:
        return seeds_for(variant, VALIDATION_SEEDS, usual_count([variant]))
    if isinstance(seeds, Sequence | np.ndarray) and not isinstance(seeds, str | bytes) and np.ndim(seeds) == 1:
        given = tuple(seed_number(f"seeds[{i}]", seed) for i, seed in enumerate(seeds))
        if not given or len(set(given)) < len(given):
            raise ValueError(f"seeds are {shown(seeds)}; give one or more of them, each once")
        return given
    return seeds_for(variant, VALIDATION_SEEDS, whole_number("seeds", seeds, 1, len(VALIDATION_SEEDS)))


def check_arguments(env_id: Any, variant: Any, env_kwargs: Mapping[str, Any]) -> None:
    """Check what names an environment, its variant and its further arguments.

    Raises:
        ValueError: one is not allowed, or an evaluation sets it itself.
        TypeError: there is no such argument.
    """
    text("env_id", env_id)
    choice("variant", variant, VARIANTS)
    set_here = {
        "feedback": "it is the compensator's",
        "action_mode": "estimates are scored",
        "disturbed": "the reference ideal is what runs undisturbed",
    }
    for fixed, why in set_here.items():
        if fixed in env_kwargs:
            raise ValueError(f"{fixed} cannot be chosen in an evaluation: {why}; leave it out")
    only("keyword argument", env_kwargs, [each.name for each in fields(Settings)])


def evaluate(
    compensator: str | type | Compensator,
    env_id: str,
    *,
    variant: str = "nominal",
    seeds: int | Sequence[int] | None = None,
    **env_kwargs: Any,
) -> pd.DataFrame:
    """Score a compensator, beside the friction-free and the uncompensated run of the same episodes.

    Args:
        compensator: a registered name, "module:Class", "file.py:Class", an entry (*.toml), a class or an instance.
            What is named, and is not the project's own, runs in a process of its own; classes and instances in this.
        env_id: a registered environment, such as "FJRStiction-v0".
        variant: variant of it.
        seeds: how many validation seeds, or the seeds themselves; None means 20, and 1 of "nominal", whose episodes
            beyond the first start a micrometre or a microradian beside it.
        env_kwargs: further arguments of the environment.

    Returns:
        One row per episode: env, variant, compensator, seed, status, error, frr, the other metrics, joint_unit and
        provenance. What does not apply is NaN.

    Raises:
        CompensatorError: the compensator raised, or returned what is not a finite (num_envs, dof) array.
        ValueError, TypeError: an argument is not allowed.
        FileNotFoundError: there is no such robot file.
    """
    return _scored(compensator, env_id, variant, seeds, env_kwargs)[0]


def trace(
    compensator: str | type | Compensator,
    env_id: str,
    *,
    variant: str = "nominal",
    seed: int = 0,
    **env_kwargs: Any,
) -> Trace:
    """One episode of a compensator tick by tick, thinned, for `fo_gym.plot.episode`.

    Args:
        compensator: as for `evaluate`.
        env_id: a registered environment, such as "FJRStiction-v0".
        variant: variant of it.
        seed: of the episode.
        env_kwargs: further arguments of the environment.

    Returns:
        Arrays by name in `signals`: time, theta, theta_ideal, theta_d, tau_f, tau_f_hat, tau_m, and on a tool path
        tool, tool_ideal and tool_d; `frr`, and what the episode is of.

    Raises:
        CompensatorError, ValueError, TypeError, FileNotFoundError: as `evaluate` does.
    """
    table, recording, references = _scored(compensator, env_id, variant, [seed], env_kwargs)
    return trace_of(str(table["compensator"][0]), "median", table.iloc[0], recording, references, 0)


def _scored(
    compensator: str | type | Compensator,
    env_id: str,
    variant: str,
    seeds: int | Sequence[int] | None,
    env_kwargs: Mapping[str, Any],
) -> tuple[pd.DataFrame, Recording, References]:
    """The rows of a compensator, what happened, and what it is relative to."""
    check_arguments(env_id, variant, env_kwargs)
    episodes = EpisodeSet(env_id, variant, evaluation_seeds(variant, seeds), env_kwargs)
    with _playing(compensator, episodes.env_id, variant) as (name, instance, content):
        recording = episodes.record(instance, name)  # first: what cannot run says so at once
    none, ideal = references_of(episodes)
    references = References(ideal.motions, none.motions)
    if compensator == "bound":
        recording = bound_of(episodes, references)
    table = rows(episodes, name, recording, references, instance)
    return table.assign(competitor_hash=content), recording, references


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
