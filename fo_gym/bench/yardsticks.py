"""Times beside what a reader knows: a step of Gymnasium's Pusher-v5, and an observer's tick beside our own step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial
from typing import Any, cast

import gymnasium as gym

from fo_gym.bench.bars import COMPENSATOR, PUSHER, REGULATION, STEP, YARDSTICK
from fo_gym.bench.measure import Subject
from fo_gym.bench.measurement import Comparison, Measurement
from fo_gym.bench.size import Size
from fo_gym.bench.subjects import batch, one
from fo_gym.compensators import make_compensator
from fo_gym.signals import Signals
from fo_gym.simulation.simulation import Simulation

OBSERVER = "pid-high"
"""The paper's PID-type observer."""

_FRAME_SKIP = 5
"""Physics steps in a step of Pusher-v5."""

__all__ = ["OBSERVER", "one_beside_pusher", "tick_beside_step", "yardsticks"]


@contextmanager
def one_beside_pusher(env_id: str) -> Iterator[list[Subject]]:
    """A control period of one of our environments, and a step of Gymnasium's Pusher-v5.

    Raises:
        ModuleNotFoundError: what Gymnasium's MuJoCo environments need is not installed.
    """
    # It has no end of its own, and none while the clock runs.
    with closing(gym.make("Pusher-v5", frame_skip=_FRAME_SKIP, max_episode_steps=10**9)) as pusher:
        action = 0.25 * cast(Any, pusher.action_space).high
        with one(env_id) as (held, _):
            yield [held, Subject(call=partial(pusher.step, action), prepare=partial(pusher.reset, seed=0))]


def _tick(simulation: Simulation) -> Subject:
    """One estimate of the observer for all environments, from signals of a moment of their motion."""
    observer = make_compensator(OBSERVER)
    signals = Signals.from_observation(simulation.observation(), simulation.dof, simulation.available)
    prepare = partial(observer.reset, simulation.joint_info, simulation.num_envs)
    return Subject(call=partial(observer.estimate, signals), prepare=prepare)


@contextmanager
def tick_beside_step(env_id: str, num_envs: int) -> Iterator[list[Subject]]:
    """An estimate of the observer for `num_envs` environments, and a control period of theirs."""
    with batch(env_id, num_envs) as (held, simulation):
        yield [_tick(simulation), held]


def yardsticks(env_ids: Sequence[str], size: Size) -> list[Measurement]:
    """The observer's tick on every environment, and Pusher beside the arm."""
    made = [
        Comparison(env_id, COMPENSATOR, count, (STEP,), partial(tick_beside_step, env_id, count), notes=(OBSERVER,))
        for env_id in env_ids
        for count in (1, size.num_envs)
    ]
    if REGULATION in env_ids:
        note = f"a physics step of it, of {_FRAME_SKIP} in its step"
        pusher = partial(one_beside_pusher, REGULATION)
        made.append(Comparison(REGULATION, YARDSTICK, 1, (PUSHER,), pusher, peer_counts=_FRAME_SKIP, notes=(note,)))
    return [each.measurement(size) for each in made]
