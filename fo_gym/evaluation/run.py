"""Run a protocol: every competitor on every set of episodes, in parallel, one row per episode."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from numpy.typing import NDArray

from fo_gym.compensators import BUILT_IN, Ideal, NoCompensation
from fo_gym.evaluation.evaluate import EpisodeSet, failed_rows, named_compensator, rows
from fo_gym.evaluation.protocol import Protocol
from fo_gym.evaluation.recording import Recording, References

Array = NDArray[np.float64]
OnRun = Callable[[str], None]

_TRACE_POINTS = 4000

__all__ = ["Results", "Trace", "run_protocol"]


@dataclass(frozen=True)
class Trace:
    """A nominal episode, thinned for a figure.

    Attributes:
        env: environment id.
        compensator: name.
        joint_unit: "m" or "rad".
        time: (n,), s.
        error: theta - theta_d, (n, dof), m or rad.
        tool, tool_d: tool and its reference, (n, 3), m, or None.
    """

    env: str
    compensator: str
    joint_unit: str
    time: Array
    error: Array
    tool: Array | None
    tool_d: Array | None


@dataclass(frozen=True)
class _Finished:
    """What one run sends back."""

    rows: pd.DataFrame
    timing: Mapping[str, Any] | None
    trace: Trace | None


@dataclass(frozen=True)
class Results:
    """What a protocol yields.

    Attributes:
        episodes: one row per episode, in the protocol's order.
        timing: one row per run: time per call of `estimate`, for the whole batch.
        traces: the nominal episodes.
    """

    episodes: pd.DataFrame
    timing: pd.DataFrame
    traces: list[Trace]


def _timing(episodes: EpisodeSet, name: str, recording: Recording) -> dict[str, Any]:
    """Median and 99th percentile of the time per control tick, for the whole batch."""
    median, p99 = np.percentile(recording.seconds, [50, 99]) * 1e6
    return {
        "env": episodes.env_id,
        "variant": episodes.variant,
        "compensator": name,
        "num_envs": len(episodes.seeds),
        "estimate_median_us": round(float(median), 2),
        "estimate_p99_us": round(float(p99), 2),
    }


def _trace(episodes: EpisodeSet, name: str, recording: Recording) -> Trace | None:
    if episodes.variant != "nominal":
        return None
    ticks = {key: value[:, 0] for key, value in recording.ticks.items()}
    keep = slice(None, None, max(1, len(ticks["theta"]) // _TRACE_POINTS))
    return Trace(
        env=episodes.env_id,
        compensator=name,
        joint_unit=recording.task.joint_unit,
        time=(np.arange(len(ticks["theta"]), dtype=np.float64) * recording.dt)[keep],
        error=(ticks["theta"] - ticks["theta_d"])[keep],
        tool=ticks["tool"][keep] if "tool" in ticks else None,
        tool_d=ticks["reference"][keep] if "tool" in ticks else None,
    )


def _finish(episodes: EpisodeSet, name: str, recording: Recording, references: References, stamp: str) -> _Finished:
    table = rows(episodes, name, recording, references, stamp)
    return _Finished(table, _timing(episodes, name, recording), _trace(episodes, name, recording))


def _run_references(episodes: EpisodeSet, stamp: str) -> tuple[References, list[_Finished]]:
    """`none` and `ideal` on one set of episodes: computed once, for all competitors."""
    none = episodes.record(NoCompensation(), "none")
    ideal = episodes.record(Ideal(), "ideal")
    references = References(ideal.motions, none.motions)
    return references, [
        _finish(episodes, "none", none, references, stamp),
        _finish(episodes, "ideal", ideal, references, stamp),
    ]


def _run_competitor(episodes: EpisodeSet, name: str, references: References, stamp: str) -> _Finished:
    """One competitor on one set of episodes. Whatever goes wrong in it becomes its failed rows."""
    try:
        _, compensator = named_compensator(name)
        recording = episodes.record(compensator, name)
    except (Exception, SystemExit) as error:
        return _Finished(failed_rows(episodes, name, f"{type(error).__name__}: {error}", stamp), None, None)
    return _finish(episodes, name, recording, references, stamp)


def run_protocol(protocol: Protocol, *, jobs: int = 1, on_run: OnRun | None = None) -> Results:
    """Run everything that a protocol names. The result does not depend on `jobs`.

    Args:
        protocol: what is run.
        jobs: worker processes; -1 = one per core.
        on_run: called with a label after every run, `none` and `ideal` counted as one.
    """
    sets = [
        EpisodeSet(env_id, variant, protocol.seeds_of(variant), {})
        for env_id in protocol.environments
        for variant in protocol.variants
    ]
    competitors = [name for name in protocol.compensators if name not in BUILT_IN]
    stamp = protocol.stamp
    # Threads inside a worker would fight the other workers for the cores.
    parallel = Parallel(n_jobs=jobs, return_as="generator", inner_max_num_threads=1)

    references: list[References] = []
    finished: dict[tuple[str, str, str], _Finished] = {}
    outcome = parallel(delayed(_run_references)(episodes, stamp) for episodes in sets)
    for episodes, (reference, both) in zip(sets, outcome, strict=True):
        references.append(reference)
        for name, run in zip(BUILT_IN, both, strict=True):
            finished[episodes.env_id, episodes.variant, name] = run
        if on_run is not None:
            on_run(f"{episodes.env_id} {episodes.variant}: none, ideal")

    pairs = [
        (episodes, reference, name)
        for episodes, reference in zip(sets, references, strict=True)
        for name in competitors
    ]
    runs = parallel(delayed(_run_competitor)(episodes, name, reference, stamp) for episodes, reference, name in pairs)
    for (episodes, _, name), run in zip(pairs, runs, strict=True):
        finished[episodes.env_id, episodes.variant, name] = run
        if on_run is not None:
            on_run(f"{episodes.env_id} {episodes.variant}: {name}")
    ordered = [
        finished[episodes.env_id, episodes.variant, name] for episodes in sets for name in (*BUILT_IN, *competitors)
    ]
    return Results(
        episodes=pd.concat([run.rows for run in ordered], ignore_index=True),
        timing=pd.DataFrame([run.timing for run in ordered if run.timing is not None]),
        traces=[run.trace for run in ordered if run.trace is not None],
    )
