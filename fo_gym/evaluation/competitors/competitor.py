"""Who is scored: a compensator with its gains, under the name that the tables give it."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from fo_gym.compensators import Compensator, make_compensator
from fo_gym.evaluation.competitors.content import Content, content_of, digest
from fo_gym.evaluation.competitors.guard.limits import Limits
from fo_gym.evaluation.competitors.guard.proxy import Guarded
from fo_gym.specs import is_ours, spec_of

BASELINE, SUBMISSION, YOURS, REFERENCE = "baseline", "submission", "yours", "reference"
"""Where a competitor comes from: the protocol, the folder of submissions, the user of `fo-gym evaluate` or `sweep`, or
the suite itself (the references that it makes, and whoever is privileged)."""

Gains = Mapping[str, Any]
"""Keyword arguments of a compensator."""

MAX_SETS = 10_000
"""Sets of gains in a sweep at most: each is a competitor of its own, with rows of its own."""

_HASH_LENGTH = 16

__all__ = ["BASELINE", "MAX_SETS", "REFERENCE", "SUBMISSION", "YOURS", "Competitor", "Gains"]


@dataclass(frozen=True)
class Competitor:
    """A compensator with its gains, under the name that the tables give it.

    Attributes:
        name: what the tables call it.
        spec: a registered name, "module:Class" or "file.py:Class".
        origin: "baseline", "submission", "yours" or "reference".
        gains: keyword arguments of the compensator.
        sets: gains that replace them, by environment and variant.
        authors: who made it.
        link: where it is described, or "".
        limits: what it may use where it runs in a process of its own.
    """

    name: str
    spec: str
    origin: str = BASELINE
    gains: Gains = field(default_factory=dict)
    sets: Mapping[tuple[str, str], Gains] = field(default_factory=dict)
    authors: tuple[str, ...] = ()
    link: str = ""
    limits: Limits = Limits()  # noqa: RUF009 (it is frozen)

    def gains_on(self, env_id: str, variant: str) -> Gains:
        """The gains on an environment and variant."""
        return self.sets.get((env_id, variant), self.gains)

    @property
    def guarded(self) -> bool:
        """Whether it runs in a process of its own: submissions do, and whatever is not the project's own code."""
        return self.origin == SUBMISSION or not is_ours(self.spec)

    def with_gains(self, gains: Gains) -> Competitor:
        """The same with some gains replaced, everywhere: a competitor of the user's, which its name tells."""
        sets = {where: {**own, **gains} for where, own in self.sets.items()}
        words = (f"{key}={str(value).removesuffix('.0')}" for key, value in gains.items())
        name = " ".join([self.name, *words])
        return replace(self, name=name, origin=YOURS, gains={**self.gains, **gains}, sets=sets)

    def make(self, env_id: str, variant: str) -> Compensator:
        """The compensator with its gains there, or what stands for it here. Raises as `make_compensator` does."""
        gains = self.gains_on(env_id, variant)
        return Guarded(self.spec, gains, self.limits) if self.guarded else make_compensator(self.spec, **gains)

    @contextmanager
    def playing(self, env_id: str, variant: str) -> Iterator[Compensator]:
        """What `make` gives, for a `with` statement, after which the process that it may have is no more."""
        compensator = self.make(env_id, variant)
        try:
            yield compensator
        finally:
            if isinstance(compensator, Guarded):
                compensator.close()

    @cached_property
    def content(self) -> Content:
        """Its source and data, as they were when this was first asked."""
        return content_of(self.spec)

    def hash_on(self, env_id: str, variant: str) -> str:
        """Hash of its source, data and gains there; "" for the references, and for what cannot be found."""
        if not self.content.files:
            return ""
        gains = {key: _file_hash(value) for key, value in self.gains_on(env_id, variant).items()}
        named = spec_of(self.spec)
        spec = named.with_file(Path(Path(named.where).name)) if named.kind == "file" else self.spec
        return digest({"spec": spec, "gains": gains, "files": self.content.files})[:_HASH_LENGTH]


def _file_hash(value: Any) -> Any:
    """A gain as it counts: where it names a file, that file's content, wherever it lies."""
    named = isinstance(value, str) and os.path.isfile(value)
    return hashlib.sha256(Path(value).read_bytes()).hexdigest() if named else value
