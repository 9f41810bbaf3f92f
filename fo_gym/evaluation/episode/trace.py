"""Episodes tick by tick, thinned: what explains a score, for figures and for files.

OUT/traces/ENV/VARIANT/NAME.PLACE.npz has one episode, OUT/traces/index.csv a row for each of these files.
"""

from __future__ import annotations

import hashlib
import io
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from fo_gym.evaluation.episode.recording import Recording, References
from fo_gym.files import atomic, csv

Array = NDArray[np.float64]
Signals = Mapping[str, NDArray[np.float32]]

BUCKETS = 700
"""Parts of equal length that an episode is cut into; each leaves at most three ticks."""

DIAGNOSTIC = "diagnostic "
"""What the names of signals begin with that are a compensator's own."""

_ROW = ["env", "robot", "variant", "compensator", "seed"]
_INDEX = ["status", "frr", "joint_unit", "origin", "competitor_hash", "protocol"]

__all__ = ["BUCKETS", "DIAGNOSTIC", "Trace", "kept_ticks", "trace_of", "traces_of", "write_traces"]


@dataclass(frozen=True)
class Trace:
    """One episode, thinned.

    Attributes:
        env, robot, variant, compensator, seed: which.
        place: where its frr stands among the episodes of the run: "worst", "median" or "best"; "median" if alone.
        frr: its friction rejection ratio.
        joint_unit: "m" or "rad".
        signals: arrays of the same length by name. At each tick: time [s]; theta, theta_ideal (without friction) and
            theta_d (target), (n, dof), m or rad; on a path tool, tool_ideal and tool_d, (n, 3), m. Of the control
            period that begins there: tau_f (true friction, opposing motion), tau_f_hat (estimate) and tau_m (motor),
            (n, dof), N or N m; the last tick repeats the last period. Likewise what the compensator said, see
            `Compensator.diagnostics`, each name after DIAGNOSTIC.
    """

    env: str
    robot: str
    variant: str
    compensator: str
    seed: int
    place: str
    frr: float
    joint_unit: str
    signals: Signals


def kept_ticks(signals: Iterable[Array]) -> NDArray[np.int64]:
    """The ticks that a trace keeps, the same for all signals, so that their differences stay exact.

    The first of each of `BUCKETS` parts, the last of all, and of each part the two where the signals are furthest above
    and below a straight line through those, as shares of their ranges: before and after a jump within a part, as of
    stick and slip, so that none is lost or smeared.

    Args:
        signals: (ticks, size) each.
    """
    values = np.concatenate(list(signals), axis=1)
    ticks = np.arange(len(values))
    stride = -(-len(ticks) // BUCKETS)
    regular = np.append(ticks[:-1:stride], ticks[-1])
    away = np.zeros((2, -(-len(ticks) // stride) * stride))  # above, below
    with np.errstate(all="ignore"):  # an episode may end at numbers that are not finite
        for column in values.T:
            reach = np.ptp(column)
            if reach > 0.0:
                above = (column - np.interp(ticks, regular, column[regular])) / reach
                away[:, : len(ticks)] = np.fmax(away[:, : len(ticks)], [above, -above])
    furthest = np.argmax(away.reshape(2, -1, stride), axis=2) + np.arange(0, away.shape[1], stride)
    return np.union1d(regular, furthest)


def traces_of(name: str, scores: pd.DataFrame, recording: Recording, references: References) -> tuple[Trace, ...]:
    """The worst, the median and the best episode of a recording by frr, those without a number left out.

    Args:
        name: of the competitor.
        scores: the rows of the recording, one per episode.
        recording: what happened.
        references: of the same episodes.

    Returns:
        Of three or more episodes three, of fewer as many as there are. Of equal ones the first counts as the worst.
    """
    places = _places(scores["frr"].to_numpy())
    return tuple(trace_of(name, place, scores.iloc[i], recording, references, i) for place, i in places.items())


def trace_of(name: str, place: str, row: pd.Series[Any], recording: Recording, references: References, i: int) -> Trace:
    """The trace of episode i of a recording.

    Args:
        name: of the competitor.
        place: of its frr among those of the run.
        row: of this episode.
        recording: what happened.
        references: of the same episodes.
        i: which.
    """
    return Trace(
        env=str(row["env"]),
        robot=str(row["robot"]),
        variant=str(row["variant"]),
        compensator=name,
        seed=int(row["seed"]),
        place=place,
        frr=float(row["frr"]),
        joint_unit=recording.robot.joint_unit,
        signals=_thinned(recording, references, i),
    )


def _places(frr: Array) -> dict[str, int]:
    """Which episodes are kept, by their place; of two there is no median, and one alone is nothing else."""
    scored = np.flatnonzero(~np.isnan(frr))
    order = [int(i) for i in scored[np.argsort(frr[scored], kind="stable")]]
    ends = {"worst": order[:1], "median": order[(len(order) - 1) // 2 :][:1], "best": order[-1:]}
    wanted = {1: ["median"], 2: ["worst", "best"]}.get(len(order), list(ends))
    return {place: i for place in wanted for i in ends[place]}


def _thinned(recording: Recording, references: References, i: int) -> Signals:
    ticks = {name: recording.ticks[name][:, i] for name in ("theta", "theta_d")}
    ticks["theta_ideal"] = references.ideal.theta[:, i]
    if references.ideal.tool is not None:
        ticks["tool"] = recording.ticks["tool"][:, i]
        ticks["tool_d"] = recording.ticks["reference"][:, i]
        ticks["tool_ideal"] = references.ideal.tool[:, i]
    told = {f"{DIAGNOSTIC}{name}": values[:, i] for name, values in recording.diagnostics.items()}
    for name in ("tau_f", "tau_f_hat", "tau_m"):
        told[name] = recording.periods[name][:, i]
    for name, periods in told.items():
        if not np.isnan(periods).all():  # of a team, another member's
            ticks[name] = np.append(periods, periods[-1:], axis=0)
    keep = kept_ticks((*ticks.values(), ticks["theta"] - ticks["theta_ideal"]))
    with np.errstate(over="ignore"):
        return {
            "time": (keep * recording.dt).astype(np.float32),
            **{name: values[keep].astype(np.float32) for name, values in ticks.items()},
        }


def write_traces(traces: Sequence[Trace], episodes: pd.DataFrame, folder: Path) -> Path:
    """Write a file per trace and the index of them into `folder`.

    Args:
        traces: what is written.
        episodes: the rows that they belong to.
        folder: files that are there already and are not named by the new index are those of earlier runs.

    Returns:
        The index.
    """
    keys = episodes[_ROW].itertuples(index=False, name=None)
    rows = dict(zip(keys, episodes[_INDEX].to_dict("records"), strict=True))
    index = []
    for trace in traces:
        key = (trace.env, trace.robot, trace.variant, trace.compensator, trace.seed)
        file = f"{trace.env}/{_stem(trace.robot)}/{trace.variant}/{_stem(trace.compensator)}.{trace.place}.npz"
        content = io.BytesIO()
        np.savez_compressed(content, **trace.signals)  # type: ignore[arg-type]
        atomic(folder / file, content.getvalue())
        told = dict(zip(_ROW, key, strict=True)) | {"place": trace.place}
        index.append(told | rows[key] | {"ticks": len(trace.signals["time"]), "file": file})
    path = folder / "index.csv"
    atomic(path, csv(pd.DataFrame(index, columns=[*_ROW, "place", *_INDEX, "ticks", "file"])))
    return path


def _stem(name: str) -> str:
    """The name for a file: as it is, or, where it is no plain word, something like it with a hash of it."""
    plain = re.sub(r"[^A-Za-z0-9_+-]+", "-", name).strip("-")[:60]
    return (
        plain if plain == name else f"{plain}-{hashlib.sha256(name.encode('utf-8', 'surrogatepass')).hexdigest()[:8]}"
    )
