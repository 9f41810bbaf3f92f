"""How an effect begins, and whether its hooks give what they are asked for, found out before it meets an episode."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fo_gym.checks import instance, real, real_arrays
from fo_gym.hardware.draw import HardwareDraw
from fo_gym.hardware.effect import Effect, Episodes, FrictionChange, Readings
from fo_gym.hardware.noise import Noise

__all__ = ["begun", "check_hooks"]


def begun(effect: Effect, episodes: Episodes, draws: Sequence[HardwareDraw]) -> Episodes:
    """The same episodes at their start, with what an effect drew for them and what it remembers then.

    Raises:
        ValueError: `begin` gave something else than arrays with a row for each episode.
    """
    name = effect.name
    first = draws[0].drawn[name]
    drawn = {key: np.array([np.atleast_1d(draw.drawn[name][key]) for draw in draws]) for key in first}
    seeds = [draw.noise_seeds[name] for draw in draws] if effect.noisy else []
    noise = Noise(map(np.random.default_rng, seeds), len(episodes.torque_limit))
    new = replace(episodes, drawn=drawn, memory={}, noise=noise)
    for key, value in effect.begin(new).items():
        array = new.memory[key] = np.array(real(f"{name}.begin, {key}", value))
        if array.shape[:1] != (len(draws),):
            raise ValueError(f"{name}.begin, {key} is of shape {array.shape}; it must have {len(draws)} rows")
    return new


def check_hooks(effect: Effect, episodes: Episodes) -> None:
    """Call every hook of a control period.

    Args:
        effect: what is tried.
        episodes: at rest, with what `begin` gave; what is remembered of them changes.

    Raises:
        ValueError: a hook gives arrays of another shape, or something else; the message names it.
    """
    before = dict(episodes.memory)
    readings = effect.measure(episodes.truth.readings, episodes)
    instance(f"{effect.name}.measure", readings, Readings)
    for name, value in readings._asdict().items():
        _check(f"{effect.name}.measure, {name}", value, episodes, exactly=True)
    _check(f"{effect.name}.command", effect.command(episodes.truth.tau_j, episodes), episodes, exactly=True)
    _check(f"{effect.name}.motor_torque", effect.motor_torque(episodes), episodes)
    _check(f"{effect.name}.link_damping", effect.link_damping(episodes), episodes)
    change = effect.friction(episodes)
    instance(f"{effect.name}.friction", change, FrictionChange)
    for name, value in change._asdict().items():
        _check(f"{effect.name}.friction, {name}", value, episodes)
    real_arrays(f"{effect.name}, memory", episodes.memory, before)


def _check(name: str, value: Any, episodes: Episodes, *, exactly: bool = False) -> None:
    """Raise ValueError where it is no array (n, dof), nor what can stand for one."""
    shape, wanted = real(name, value).shape, episodes.truth.theta.shape
    try:
        fits = shape == wanted or (not exactly and np.broadcast_shapes(shape, wanted) == wanted)
    except ValueError:
        fits = False
    if not fits:
        raise ValueError(f"{name} is of shape {shape}; it must be of shape {wanted}")
