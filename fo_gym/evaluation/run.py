"""Run a protocol: every competitor on every set of episodes, in parallel, one row per episode."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from joblib.externals.loky.process_executor import TerminatedWorkerError
from numpy.typing import NDArray

from fo_gym.compensators import BUILT_IN, Ideal, NoCompensation
from fo_gym.evaluation.evaluate import EpisodeSet, failed_rows, named_compensator, rows
from fo_gym.evaluation.protocol import Protocol
from fo_gym.evaluation.recording import Recording, References
from fo_gym.evaluation.trace import Trace, trace_of

Array = NDArray[np.float64]
OnRun = Callable[[str], None]
_Pair = tuple[EpisodeSet, str, References]

__all__ = ["Results", "run_protocol"]


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


def _finish(episodes: EpisodeSet, name: str, recording: Recording, references: References, stamp: str) -> _Finished:
    table = rows(episodes, name, recording, references, stamp)
    trace = trace_of(episodes.env_id, name, recording) if episodes.variant == "nominal" else None
    return _Finished(table, _timing(episodes, name, recording), trace)


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
        return _failed(episodes, name, f"{type(error).__name__}: {error}", stamp)
    return _finish(episodes, name, recording, references, stamp)


def _failed(episodes: EpisodeSet, name: str, error: str, stamp: str) -> _Finished:
    return _Finished(failed_rows(episodes, name, error, stamp), None, None)


def _parallel(jobs: int) -> Parallel:
    # Threads inside a worker would fight the other workers for the cores.
    return Parallel(n_jobs=jobs, return_as="generator", inner_max_num_threads=1)


def _run_competitors(pairs: list[_Pair], stamp: str, jobs: int) -> Iterator[_Finished]:
    """Every pair, in order. A competitor that ends its whole worker process fails alone: the rest is run one by one."""
    done = 0
    try:
        for run in _parallel(jobs)(delayed(_run_competitor)(*pair, stamp) for pair in pairs):
            yield run
            done += 1
    except TerminatedWorkerError:
        for episodes, name, references in pairs[done:]:
            try:
                yield from _parallel(2)([delayed(_run_competitor)(episodes, name, references, stamp)])
            except TerminatedWorkerError:
                yield _failed(episodes, name, "it ended the process that it ran in", stamp)


def run_protocol(protocol: Protocol, *, jobs: int = 1, on_run: OnRun | None = None) -> Results:
    """Run everything that a protocol names. The result does not depend on `jobs`.

    Args:
        protocol: what is run.
        jobs: worker processes; -1 = one per core. With 1 everything runs in this process.
        on_run: called with a label after every run, `none` and `ideal` counted as one.
    """
    announce = on_run or _silence
    sets = [
        EpisodeSet(env_id, variant, protocol.seeds_of(variant), {})
        for env_id in protocol.environments
        for variant in protocol.variants
    ]
    competitors = [name for name in protocol.compensators if name not in BUILT_IN]
    finished: list[list[_Finished]] = []
    pairs: list[_Pair] = []
    outcome = _parallel(jobs)(delayed(_run_references)(episodes, protocol.stamp) for episodes in sets)
    for episodes, (references, both) in zip(sets, outcome, strict=True):
        finished.append(both)
        pairs += [(episodes, name, references) for name in competitors]
        announce(f"{episodes.env_id} {episodes.variant}: none, ideal")
    for place, run in enumerate(_run_competitors(pairs, protocol.stamp, jobs)):
        episodes, name, _ = pairs[place]
        finished[place // len(competitors)].append(run)
        announce(f"{episodes.env_id} {episodes.variant}: {name}")
    ordered = [run for runs in finished for run in runs]
    return Results(
        episodes=pd.concat([run.rows for run in ordered], ignore_index=True),
        timing=pd.DataFrame([run.timing for run in ordered if run.timing is not None]),
        traces=[run.trace for run in ordered if run.trace is not None],
    )


def _silence(label: str) -> None:
    """Nobody listens."""
