"""Compensators that answer as they are told, and recordings of them, for the tests of the recording."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fo_gym import JointInfo, Signals
from fo_gym.evaluation.episode.recording import Recording
from fo_gym.evaluation.runs.episodes import EpisodeSet

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"
DOF = {STICTION: 1, REGULATION: 7, SQUARE: 7}


class Answering:
    """A compensator whose answer to tick k is `answer(signals, k)`."""

    def __init__(self, answer: Callable[[Signals, int], Any], feedback: str = "measured") -> None:
        self.answer = answer
        self.feedback = feedback
        self.tick = -1

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        self.joints, self.num_envs = joints, num_envs

    def estimate(self, signals: Signals) -> Any:
        self.tick += 1
        return self.answer(signals, self.tick)


def silent(signals: Signals, _: int) -> np.ndarray:
    return np.zeros_like(signals.theta)


def episodes(env_id: str, seeds: tuple[int, ...] = (7,), duration: float = 0.1, **kwargs: Any) -> EpisodeSet:
    return EpisodeSet(env_id, "randomized", seeds, {"duration": duration, **kwargs})


def arrays(recording: Recording) -> dict[str, np.ndarray]:
    return {**recording.ticks, **recording.periods}


def assert_same(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> None:
    assert one.keys() == other.keys()
    for name, values in one.items():
        np.testing.assert_array_equal(values, other[name], err_msg=name, strict=True)
