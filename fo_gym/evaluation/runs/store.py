"""The store: trials on disk under the hash of everything that decides them, so that nothing is computed twice.

A file per trial, DIR/ENV/VARIANT/KEY.trial: the SHA-256 of the rest in hexadecimal, a line end, and a NumPy archive
(.npz) of plain arrays, one of which is JSON text. Nothing is unpickled. Numbers come back bit by bit.

A trial that is kept without traces is computed again where they are asked for; one with traces serves either way.

The key covers the environment and the source of what registered it, the robot with its file, the variant, the seeds and
arguments, the source of the kind of episodes, the competitor's spec, gains, source and weights, the source of the suite
that computes and of metrics of others, the versions of the packages involved, and the kind of machine. It covers
neither protocol nor names: two protocols share what they have in common. Not kept are failed trials, which are tried
again, and those of a worker on another kind of machine.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import pandas as pd

from fo_gym.envs.registry import environment_of
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.competitors.content import content_of_source, digest, suite
from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.processor import processor
from fo_gym.evaluation.runs.provenance import versions
from fo_gym.evaluation.runs.trial import Trial
from fo_gym.files import atomic

_FORMAT = 2
_JSON = "json"

__all__ = ["Store", "key_of"]


def key_of(episodes: EpisodeSet, competitor: Competitor) -> str:
    """Hash of everything that decides a trial, in hexadecimal."""
    everything = suite()
    # Whether traces are kept changes no row.
    met = {each.name: getattr(episodes, each.name) for each in fields(episodes) if each.name != "traced"}
    met["env_kwargs"] = {name: value for name, value in episodes.env_kwargs.items() if name != "robot"}
    environment = environment_of(episodes.env_id)
    return digest(
        {
            "format": _FORMAT,
            "episodes": met,
            "kind": _kind(type(episodes).__module__),
            "robot": episodes.robot.fingerprint,
            "environment": content_of_source(environment.source).files if environment.source else {},
            "spec": competitor.spec,
            "competitor": competitor.hash_on(episodes.env_id, episodes.variant),
            "packages": {**everything.versions, **competitor.content.versions, **versions()},
            "suite": everything.files,
            "metrics": {source: content_of_source(source).files for source in METRICS.sources},
            "processor": processor(),
        }
    )


@cache
def _kind(module: str) -> Mapping[str, str]:
    """The source of a kind of episodes, read once: it takes a third of a second, and what is loaded stays as it is."""
    return content_of_source(module).files


def _encode(trial: Trial) -> bytes:
    arrays: dict[str, Any] = {
        f"{place}.{name}": values for place, trace in enumerate(trial.traces) for name, values in trace.signals.items()
    }
    text = {
        "rows": trial.rows.to_dict("records"),
        "timing": trial.timing,
        "traces": [
            {each.name: getattr(trace, each.name) for each in fields(Trace)} | {"signals": list(trace.signals)}
            for trace in trial.traces
        ],
    }
    archive = io.BytesIO()
    np.savez_compressed(archive, **arrays | {_JSON: np.frombuffer(json.dumps(text).encode(), np.uint8)})
    return hashlib.sha256(archive.getvalue()).hexdigest().encode() + b"\n" + archive.getvalue()


def _decode(content: bytes) -> Trial:
    """The trial. Raises ValueError where the content is not what was written."""
    checksum, _, archive = content.partition(b"\n")
    if checksum.decode(errors="replace") != hashlib.sha256(archive).hexdigest():
        raise ValueError("its checksum does not fit")
    with np.load(io.BytesIO(archive), allow_pickle=False) as members:
        arrays: dict[str, Any] = {name: members[name] for name in members.files}
    text = json.loads(arrays.pop(_JSON).tobytes())
    traces = tuple(
        Trace(**told | {"signals": {name: arrays[f"{place}.{name}"] for name in told["signals"]}})
        for place, told in enumerate(text["traces"])
    )
    return Trial(pd.DataFrame(text["rows"]), text["timing"], traces)


class Store:
    """Trials in a folder.

    Args:
        folder: where they are; made when the first is kept.
        fresh: do not read what is there; it is replaced.
        notice: called with a line of text where a file is damaged or cannot be written, which stops nothing.
    """

    def __init__(self, folder: Path, *, fresh: bool = False, notice: Callable[[str], None]) -> None:
        self.folder = folder
        self._fresh = fresh
        self._notice = notice

    def path_of(self, episodes: EpisodeSet, competitor: Competitor) -> Path:
        """Where a trial is kept."""
        return self.folder / episodes.env_id / episodes.variant / f"{key_of(episodes, competitor)}.trial"

    def load(self, episodes: EpisodeSet, competitor: Competitor) -> Trial | None:
        """The trial as it was kept, or None where there is none that can be trusted, or none with what is asked."""
        path = self.path_of(episodes, competitor)
        if self._fresh or not path.is_file():
            return None
        try:
            trial = _decode(path.read_bytes())
            return trial if trial.traces or not episodes.traced else None
        except (OSError, ValueError, KeyError, TypeError, BadZipFile) as error:
            self._notice(f"{path} is damaged ({error}); what it held is computed again")
            return None

    def save(self, episodes: EpisodeSet, competitor: Competitor, trial: Trial) -> None:
        """Keep a trial, whole or not at all; a failed one, or one of another kind of machine, is not kept."""
        if trial.failed or (trial.rows["processor"] != processor()).any():
            return
        path = self.path_of(episodes, competitor)
        try:
            atomic(path, _encode(trial))
        except OSError as error:
            self._notice(f"{path} cannot be written ({error}); what it would hold will be computed again")
