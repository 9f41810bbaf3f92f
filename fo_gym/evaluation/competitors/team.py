"""Several compensators on one batch, a share of its environments for each: one simulation instead of many."""

from __future__ import annotations

import time
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import repeat
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fo_gym.compensators import Compensator, diagnostics_of, has_learned, is_privileged
from fo_gym.parameters import JointInfo, with_fields
from fo_gym.signals import SIGNALS, Signals

Array = NDArray[np.float64]
Name = TypeVar("Name", bound=Hashable)

_ARRAYS = (*SIGNALS, "time", "reference")
"""The arrays that Signals consists of, in its order."""
_PARTS = (*_ARRAYS, "available", "truth")

__all__ = ["Team", "alike"]


class Team:
    """Compensators that are `alike`, each in charge of as many environments of the batch, one after the other.

    What a member does is what it does alone: it sees its own environments and nothing else.

    Args:
        members: who they are.
        share: environments of each.

    Attributes:
        seconds: time that each call of a member took, a list for each [s].
    """

    def __init__(self, members: Sequence[Compensator], share: int = 1) -> None:
        self.members = list(members)
        self.share = share
        self.seconds: list[list[float]] = [[] for _ in members]
        self._rows = [slice(place * share, (place + 1) * share) for place in range(len(self.members))]
        ((self.feedback, self.privileged),) = {_kind(member) for member in self.members}
        self.learned = any(has_learned(member) for member in self.members)

    def rows(self, place: int) -> slice:
        """The environments of a member, by its place."""
        return self._rows[place]

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start every member on a batch of its share."""
        for place, member in enumerate(self.members):
            member.reset(_of(joints, self.rows(place)), self.share)

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), the rows of each member from itself. Raises ValueError for another shape."""
        estimate = np.empty(signals.theta.shape)
        members = enumerate(zip(self.members, self._shares(signals), self._rows, self.seconds, strict=True))
        for place, (member, seen, rows, seconds) in members:
            start = time.perf_counter()
            answer = np.asarray(member.estimate(seen))
            seconds.append(time.perf_counter() - start)
            own = estimate[rows]
            if answer.shape != own.shape:
                raise ValueError(f"member {place} returned shape {answer.shape}; its share is {own.shape}")
            own[...] = answer
        return estimate

    @property
    def diagnostics(self) -> dict[str, Array]:
        """Those of its members; NaN in the environments of who does not tell that."""
        found: dict[str, Array] = {}
        for place, member in enumerate(self.members):
            for name, told in diagnostics_of(member).items():
                whole = found.setdefault(name, np.full((len(self.members) * self.share, *np.shape(told)[1:]), np.nan))
                whole[self.rows(place)] = told
        return found

    def _shares(self, signals: Signals) -> Iterator[Signals]:
        """What each member sees. All arrays are taken apart at once: this happens at every tick."""

        def parts(array: Array) -> Array:
            return array.reshape(len(self.members), self.share, *array.shape[1:])

        truth, count = signals.truth, len(self.members)
        truths: Iterable[Mapping[str, Array] | None] = (
            repeat(None, count)
            if truth is None
            else (dict(zip(truth, each, strict=True)) for each in zip(*map(parts, truth.values()), strict=True))
        )
        arrays = [parts(getattr(signals, name)) for name in _ARRAYS]
        for seen in zip(*arrays, repeat(signals.available, count), truths, strict=True):
            yield Signals.of(dict(zip(_PARTS, seen, strict=True)))


def _of(joints: JointInfo, rows: slice) -> JointInfo:
    """The rows of everything that has a row for each environment."""
    parts: dict[str, Any] = {name: part[rows] for name, part in vars(joints).items() if isinstance(part, np.ndarray)}
    if joints.identified is not None and np.ndim(joints.identified.f_c) > 1:
        own = {name: field[rows] for name, field in vars(joints.identified).items()}
        parts["identified"] = with_fields(joints.identified, own)
    return replace(joints, **parts)


def _kind(member: Compensator) -> tuple[str, bool]:
    return member.feedback, is_privileged(member)


def alike(members: Mapping[Name, Compensator]) -> list[list[Name]]:
    """Names of the members that can share a batch: with the same feedback, and all of them privileged or none."""
    kinds = dict.fromkeys(map(_kind, members.values()))
    return [[name for name, member in members.items() if _kind(member) == each] for each in kinds]
