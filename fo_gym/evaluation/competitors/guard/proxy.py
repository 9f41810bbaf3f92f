"""What stands for a competitor in the suite's process: a `Compensator` that asks the competitor's own process."""

from __future__ import annotations

import json
import os
import socket
import sys
import time
import warnings
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.compensators import CompensatorError, checked
from fo_gym.evaluation.competitors.guard import memory
from fo_gym.evaluation.competitors.guard.channel import (
    BEGIN,
    CONFINE,
    DECLARE,
    DONE,
    LONGEST_ANSWER,
    MAKE,
    RAISED,
    RESET,
    SHAPE,
    TICK,
    Channel,
    ChannelError,
)
from fo_gym.evaluation.competitors.guard.limits import Limits
from fo_gym.evaluation.competitors.guard.process import Process
from fo_gym.evaluation.competitors.guard.readable import readable
from fo_gym.evaluation.episode.faults import EndedError, RaisedError, plain, trace_of, with_trace
from fo_gym.parameters import JointInfo
from fo_gym.signals import Signals

Array = NDArray[np.float64]

_LOOK_EVERY = 512
"""Ticks between two looks at what the process is up to."""
_MISTAKES: dict[str, type[Exception]] = {"ValueError": ValueError, "TypeError": TypeError}
"""What `make_compensator` raises for an argument that is not allowed, besides CompensatorError."""

__all__ = ["Guarded"]


def _check_plain(spec: str, gains: Mapping[str, Any]) -> None:
    """Raise ValueError for gains that cannot be handed to another process."""
    try:
        json.dumps(dict(gains))
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"compensator {spec!r}: gains are {dict(gains)}; give text, numbers, lists and tables of them: {error}"
        ) from error


def _three_numbers(values: Any) -> tuple[float, float, float]:
    low, high, own = (float("nan") if value is None else float(value) for value in values)
    return low, high, own


class Guarded:
    """A compensator in a process of its own, which sees observations and gives estimates.

    Args:
        spec: as `make_compensator` takes it.
        gains: keyword arguments: text, numbers, truth values, and lists and tables of them.
        limits: what it may use.

    Attributes:
        feedback, learned: what the competitor said of itself when it was made.
        diagnostics: what it said after its last estimate; empty where it said nothing.

    Raises:
        ValueError, TypeError, CompensatorError: as `make_compensator` does, and CompensatorError beyond a limit.
    """

    def __init__(self, spec: str, gains: Mapping[str, Any], limits: Limits) -> None:
        self._spec = spec
        self._limits = limits
        self._spent = 0.0
        self._ticks = 0
        self.diagnostics: dict[str, Array] = {}
        _check_plain(spec, gains)
        self._process = Process(limits)
        self._channel = Channel(self._process.connection, LONGEST_ANSWER, self._process.wait)
        paths = {"readable": readable(spec, gains), "scratch": self._process.scratch}
        try:
            _, missing = self._ask(CONFINE, {**paths, "limits": asdict(limits), "parent": os.getpid()}, "making")
            _, told = self._ask(MAKE, {"spec": spec, "gains": dict(gains)}, "making")
        except RaisedError as error:
            mistake = _MISTAKES.get(error.kind, CompensatorError)(str(error))
            raise with_trace(mistake, trace_of(error)) from None
        except EndedError as error:
            raise CompensatorError(f"compensator {spec!r}: making it: {error}") from None
        words = told if isinstance(told, dict) else {}
        self.feedback: str = words.get("feedback", "")
        self.learned: bool = words.get("learned", False)
        if words.get("privileged", False):
            self.close()
            raise ValueError(
                f"compensator {spec!r} is privileged, but the truth stays in the suite's own process; hand its class "
                "or an instance to fo_gym.evaluate, or leave privileged out"
            )
        if missing:
            warnings.warn(f"this system guards against competitors without: {', '.join(missing)}", stacklevel=2)
        try:
            checked(self, spec)
        except TypeError:
            self.close()
            raise

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """See `Compensator`. Raises RaisedError for what it raised, EndedError beyond a limit."""
        arrays = {name: getattr(joints, name).tolist() for name in ("motor_inertia", "stiffness", "torque_limit")}
        content = {"dof": joints.dof, "arrays": arrays, "dt": joints.control_dt, "num_envs": num_envs}
        if joints.identified is not None:
            friction = vars(joints.identified)
            content["identified"] = {name: np.asarray(value).tolist() for name, value in friction.items()}
        self._in_time(RESET, content)
        self._begun = False

    def estimate(self, signals: Signals) -> Array:
        """See `Compensator`; an array of its own every time. Raises RaisedError and EndedError as `reset` does."""
        observations = signals.observation()
        num_envs, dof = signals.theta.shape
        if not self._begun:
            sizes = {"num_envs": num_envs, "dof": dof, "width": observations.shape[1]}
            os.ftruncate(self._process.memory, observations.nbytes + signals.theta.nbytes)
            self._in_time(BEGIN, {**sizes, "available": sorted(signals.available)})
            self._begun = True
        os.pwrite(self._process.memory, observations.data, 0)
        letter, content = self._in_time(TICK)
        if letter == SHAPE:
            return self._of_shape(content)
        estimates = memory.take(self._process.memory, (num_envs, dof), observations.nbytes)
        if estimates is None:
            raise self._fault("it made the shared memory shorter")
        self.diagnostics = {} if content is None else self._arrays(content)
        return estimates

    def declared(self) -> dict[str, tuple[float, float, float]]:
        """Its `search_space`: {gain: (low, high, its own value)}; NaN where it has no attribute of that name.

        Raises:
            CompensatorError: it raised, or what it declares is something else.
        """
        try:
            _, content = self._in_time(DECLARE)
            return {plain(name): _three_numbers(values) for name, values in content.items()}
        except (RaisedError, EndedError, AttributeError, TypeError, ValueError) as error:
            raise CompensatorError(f"compensator {self._spec!r}: search_space: {error}") from None

    def close(self) -> None:
        """End its process, and pass on what it printed."""
        for line in self._process.end().splitlines():
            print(f"{self._spec} | {line}", file=sys.stderr)

    def _arrays(self, content: Any) -> dict[str, Array]:
        """Numbers by name, as it sent them."""
        try:
            return {plain(name): np.asarray(values, dtype=np.float64) for name, values in content.items()}
        except (AttributeError, TypeError, ValueError) as error:
            raise self._fault(f"its diagnostics are no numbers by name: {error}") from None

    def _of_shape(self, shape: Any) -> Array:
        """An array of the shape that it says its answer has: a wrong one, which the caller refuses."""
        try:
            return np.broadcast_to(np.zeros(()), tuple(shape))
        except (TypeError, ValueError) as error:
            raise self._fault(f"it sent a shape that is none: {error}") from None

    def _in_time(self, letter: bytes, content: Any = None) -> tuple[bytes, Any]:
        """Ask within the limits of a tick and of the run."""
        left = self._limits.run - self._spent
        start = time.monotonic()
        bound = ("tick", 0.0) if self._limits.tick < left else ("run", self._spent)
        answer = self._ask(letter, content, *bound)
        self._spent += time.monotonic() - start
        return answer

    def _ask(self, letter: bytes, content: Any, limit: str, spent: float = 0.0) -> tuple[bytes, Any]:
        """Send a request and return its answer, whatever it may be.

        Args:
            letter: the request.
            content: what JSON knows.
            limit: name of the limit on the time that it may take.
            spent: how much of it is gone [s].

        Raises:
            RaisedError: the competitor did.
            EndedError: its process ended, was too slow, or did not keep to the protocol.
        """
        if self._process.ended:
            raise EndedError("its process has ended")
        seconds = getattr(self._limits, limit)
        self._ticks += 1
        try:
            if self._ticks % _LOOK_EVERY == 0:
                self._process.look()
            if self._process.has_spoken():
                if not self._process.connection.recv(1, socket.MSG_PEEK):  # it ended since the last answer
                    raise EOFError
                raise ChannelError("it answered before it was asked")
            self._process.expect_within(seconds - spent)
            self._channel.send(letter, content)
            answer, content = self._channel.receive()
        except (TimeoutError, BlockingIOError):
            raise self._fault(f"it took longer than {seconds:g} s (Limits.{limit})") from None
        except (EOFError, ConnectionError):
            raise self._fault(self._process.epitaph()) from None
        except (ChannelError, EndedError) as error:
            raise self._fault(str(error)) from None
        if answer == RAISED:
            self.close()
            raise self._raised(content)
        if answer not in (DONE, SHAPE):
            raise self._fault(f"it answered with the letter {answer!r}")
        return answer, content

    def _fault(self, message: str) -> EndedError:
        """End the process; why, to be raised."""
        self.close()
        return EndedError(message)

    def _raised(self, content: Any) -> Exception:
        """What the competitor raised, in its own words."""
        words = content if isinstance(content, dict) else {}
        kind, text, place, trace = (plain(words.get(part, "")) for part in ("kind", "text", "place", "trace"))
        if kind == MemoryError.__name__:
            text += f"it may use {self._limits.memory} bytes (Limits.memory)"
        return with_trace(RaisedError(kind, f"{text} ({place})" if place else text), trace)
