"""The competitor's side: makes it, and answers what the suite's process asks."""

from __future__ import annotations

import mmap
import os
from contextlib import suppress
from typing import Any

import numpy as np

from fo_gym import compensators
from fo_gym.checks import real
from fo_gym.evaluation.competitors.guard.channel import BEGIN, DECLARE, DONE, RAISED, RESET, SHAPE, TICK, Channel
from fo_gym.evaluation.competitors.guard.frames import place_of, traceback_of
from fo_gym.evaluation.competitors.guard.memory import views
from fo_gym.evaluation.episode.faults import LONGEST_TEXT
from fo_gym.friction import LuGre
from fo_gym.parameters import JointInfo
from fo_gym.signals import Signals

_RESERVE = 16 << 20
"""Memory that is kept for telling that there is no more [bytes]."""

__all__ = ["serve"]


class _Server:
    """One competitor, and the arrays that it shares with the suite's process."""

    def __init__(self, channel: Channel, memory: int, compensator: Any) -> None:
        self._channel = channel
        self._memory = memory
        self._compensator = compensator
        self._answers = {RESET: self._reset, BEGIN: self._begin, TICK: self._tick, DECLARE: self._declare}

    def run(self) -> None:
        """Answer until the connection ends, which raises EOFError."""
        while True:
            letter, content = self._channel.receive()
            self._channel.send(*self._answers[letter](content))

    def _declare(self, _: Any) -> tuple[bytes, Any]:
        return DONE, compensators.declared_gains(self._compensator)

    def _reset(self, content: Any) -> tuple[bytes, Any]:
        arrays = {name: np.array(values, dtype=np.float64) for name, values in content["arrays"].items()}
        identified = LuGre(**content["identified"]) if "identified" in content else None
        joints = JointInfo(content["dof"], **arrays, control_dt=content["dt"], identified=identified)
        self._compensator.reset(joints, content["num_envs"])
        return DONE, None

    def _begin(self, content: Any) -> tuple[bytes, Any]:
        self._dof, self._available = content["dof"], frozenset(content["available"])
        shapes = (content["num_envs"], content["width"]), (content["num_envs"], content["dof"])
        self._observations, self._estimates = views(self._memory, *shapes)
        return DONE, None

    def _tick(self, _: Any) -> tuple[bytes, Any]:
        signals = Signals.from_observation(self._observations.copy(), self._dof, self._available)
        answer = real("estimate", self._compensator.estimate(signals))
        if answer.shape != self._estimates.shape:
            return SHAPE, answer.shape
        self._estimates[...] = answer
        told = compensators.diagnostics_of(self._compensator)
        return DONE, {name: np.asarray(values).tolist() for name, values in told.items()} or None


def _told(error: BaseException, spec: str) -> dict[str, str]:
    """An error in words."""
    text = ""
    with suppress(BaseException):  # the words are the competitor's own, too
        text = str(error)[:LONGEST_TEXT]
    raised, trace = error.__cause__ or error, ""
    with suppress(BaseException):
        trace = traceback_of(raised, spec)[-LONGEST_TEXT:]
    return {"kind": type(error).__name__, "text": text, "place": place_of(raised, spec), "trace": trace}


def serve(channel: Channel, memory: int) -> None:
    """Make the competitor that is asked for and answer for it; then end this process, whatever threads it still has.

    Args:
        channel: to the suite's process.
        memory: file descriptor of what is shared with it.
    """
    spec = ""
    reserve = mmap.mmap(-1, _RESERVE)
    try:
        _, job = channel.receive()
        spec = job["spec"]
        compensator = compensators.make_compensator(spec, **job["gains"])
        told = {"feedback": compensator.feedback, "learned": compensators.has_learned(compensator)}
        channel.send(DONE, {**told, "privileged": compensators.is_privileged(compensator)})
        _Server(channel, memory, compensator).run()
    except EOFError:
        os._exit(0)
    except BaseException as error:
        reserve.close()
        with suppress(BaseException):
            channel.send(RAISED, _told(error, spec))
        os._exit(1)
