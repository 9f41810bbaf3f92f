"""How much the benchmark of speed measures."""

from __future__ import annotations

from dataclasses import dataclass

from joblib import cpu_count

__all__ = ["FULL", "QUICK", "Size"]


@dataclass(frozen=True)
class Size:
    """How much is measured.

    Attributes:
        num_envs: environments of the batch that bars are about.
        other_envs: of batches that are measured besides.
        num_threads: of the threads' row.
        many: environments whose throughput is measured; as many processes in those peers that need them.
        batches: environments over which growth is measured.
        batches_from: that from which on its power is told.
        joints: of chains, over which growth is measured.
        joints_from: those from which on a power is told.
        threads: over which growth is measured.
        lengths: of episodes [s], over which growth is measured.
        cases: motions on which errors are compared, of each robot.
        periods: of each of these motions, at most.
        memory_envs: environments whose memory is measured, beyond the first.
        job_envs: environments of a whole job, at most.
        variants: of its episodes.
        competitors: of it, at most.
        repeats: rounds, in each of which everybody has a slice.
        slice_seconds: length of a slice [s].
    """

    num_envs: int = 256
    other_envs: tuple[int, ...] = (1, 16, 1024)
    num_threads: int = 2
    many: int = 64
    batches: tuple[int, ...] = (1, 4, 16, 64, 256, 1024)
    batches_from: int = 64
    joints: tuple[int, ...] = (1, 2, 4, 7, 10, 14)
    joints_from: tuple[int, ...] = (1, 7)
    threads: tuple[int, ...] = (1, 2)
    lengths: tuple[float, ...] = (1.0, 2.0, 4.0, 8.0)
    cases: int = 4
    periods: int = 2000
    memory_envs: int = 1000
    job_envs: int = 100
    variants: tuple[str, ...] = ("nominal", "randomized", "hardware")
    competitors: int = 100
    repeats: int = 15
    slice_seconds: float = 0.1


def _threads() -> tuple[int, ...]:
    """1, 2, 4, ... up to the cores of this machine; 1 and 2 at least."""
    return tuple(2**power for power in range(max(2, int(cpu_count()).bit_length())))


FULL = Size(threads=_threads())
"""What the bars are about."""

QUICK = Size(
    num_envs=16,
    other_envs=(2,),
    many=2,
    batches=(1, 4, 16),
    batches_from=1,
    joints=(1, 2),
    joints_from=(1,),
    lengths=(0.1, 0.2),
    cases=1,
    periods=60,
    memory_envs=50,
    job_envs=1,
    variants=("nominal",),
    competitors=1,
    repeats=3,
    slice_seconds=0.01,
)
"""Enough to see that everything runs."""
