"""What a competitor in a process of its own may use."""

from __future__ import annotations

from dataclasses import dataclass, fields

__all__ = ["Limits"]


@dataclass(frozen=True)
class Limits:
    """Bounds of one process, which runs one competitor on one set of episodes.

    Attributes:
        making: time to start, to import the competitor and to make it [s].
        tick: time for one `reset`, or one `estimate` of the whole batch [s].
        run: time for all of them together [s].
        memory: address space [bytes].
        threads: number of threads; other processes are not allowed at all.
        scratch: what it may write, all files of its scratch folder together, and all that it prints [bytes].
    """

    making: float = 120.0
    tick: float = 10.0
    run: float = 1800.0
    memory: int = 8 << 30
    threads: int = 64
    scratch: int = 256 << 20

    def __post_init__(self) -> None:
        for field in fields(self):
            if not getattr(self, field.name) > 0:
                raise ValueError(f"Limits.{field.name} is {getattr(self, field.name)}; it must be above 0")
